/// Mesh files of all formats, from memory. The first byte chooses the format.
#include <algorithm>
#include <cmath>

#include <rubble/rubble.h>

#include "io/mesh_file.h"
#include "tests/fuzz/target.h"

namespace rubble::fuzz {
namespace {

constexpr const char* kNames[] = {"mesh.obj", "mesh.stl", "mesh.ply", "mesh.msh"};
/// Larger meshes are read, and no more.
constexpr std::size_t kMostVertices = 40, kMostElements = 80;

template <class F> void orError(F&& f) {
  try {
    f();
  } catch (const Error&) {
  }
}

template <std::size_t N>
void expectIndices(const std::vector<std::array<int, N>>& elements, std::size_t vertices) {
  for (const auto& element : elements)
    for (const int v : element)
      expect(v >= 0 && static_cast<std::size_t>(v) < vertices, "a mesh names a vertex that it has not got");
}

double extentOf(const std::vector<Vec3>& points) {
  double extent = 0;
  for (const Vec3& p : points)
    for (int k = 0; k < 3; ++k) extent = std::max(extent, std::fabs(p[k] - points.front()[k]));
  return extent;
}

/// Adds a ball and all that can be made of the mesh to one world, and takes a step.
void useInWorld(const io::MeshFile& mesh) {
  const double extent = extentOf(mesh.vertices);
  BodyDef ball;
  ball.shape = Shape::sphere(std::clamp(.1 * extent, 1e-3, 1e3));
  ball.position = mesh.vertices.front();
  WorldOptions options;
  options.threads = 1;
  options.timings = false;
  World world({}, options);
  world.addBody(ball);
  const auto addShape = [&](Motion motion, const auto& make) {
    orError([&] {
      BodyDef body;
      body.motion = motion;
      body.shape = make();
      world.addBody(body);
    });
  };
  const auto addObject = [&](const auto& make) { orError([&] { world.addDeformable(make()); }); };
  addShape(Motion::Static, [&] { return Shape::mesh(mesh.vertices, mesh.triangles); });
  addShape(Motion::Dynamic, [&] { return Shape::hull(mesh.vertices); });
  addObject([&] { return tetSolidFromMesh(io::tetrahedraOf(mesh)); });
  addObject([&] { return clothFromMesh({mesh.vertices, mesh.triangles}); });
  addObject([&] {
    const std::vector<Vec3> line = io::lineOf(mesh, "line");
    return cableAlong(line, .1 * extentOf(line));
  });
  world.step();
}

void fill(const io::MeshFile& mesh) {
  const TriangleMesh surface{mesh.vertices, mesh.triangles};
  const TetSolidDef solid = tetSolidFromSurface(surface, .3 * extentOf(mesh.vertices));
  validate(Deformable(solid), "solid");
  expectIndices(solid.tetrahedra, solid.vertices.size());
}

}  // namespace

void testInput(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  const char* const name = kNames[bytes.front() % std::size(kNames)];
  const std::string content(bytes.begin() + 1, bytes.end());
  orError([&] {
    const io::MeshFile mesh = io::parseMesh(name, content);
    expectIndices(mesh.triangles, mesh.vertices.size());
    expectIndices(mesh.tetrahedra, mesh.vertices.size());
    if (mesh.vertices.empty() || mesh.vertices.size() > kMostVertices) return;
    if (mesh.triangles.size() + mesh.tetrahedra.size() > kMostElements) return;
    orError([&] { useInWorld(mesh); });
    fill(mesh);
  });
}

}  // namespace rubble::fuzz
