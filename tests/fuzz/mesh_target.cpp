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
constexpr std::size_t kMostVertices = 100, kMostElements = 200;

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

void step(const Scene& scene) {
  WorldOptions options;
  options.threads = 1;
  World world(scene, options);
  world.step();
}

void useAsShapes(const io::MeshFile& mesh) {
  const double extent = extentOf(mesh.vertices);
  BodyDef ball;
  ball.shape = Shape::sphere(std::clamp(.1 * extent, 1e-3, 1e3));
  ball.position = mesh.vertices.front();
  orError([&] {
    Scene scene;
    scene.bodies = {ball, {}};
    scene.bodies[1].motion = Motion::Static;
    scene.bodies[1].shape = Shape::mesh(mesh.vertices, mesh.triangles);
    step(scene);
  });
  orError([&] {
    Scene scene;
    scene.bodies = {ball, {}};
    scene.bodies[1].shape = Shape::hull(mesh.vertices);
    step(scene);
  });
}

void useAsObjects(const io::MeshFile& mesh) {
  orError([&] {
    Scene scene;
    scene.deformables = {tetSolidFromMesh(io::tetrahedraOf(mesh))};
    step(scene);
  });
  orError([&] {
    Scene scene;
    scene.deformables = {clothFromMesh({mesh.vertices, mesh.triangles})};
    step(scene);
  });
  orError([&] {
    const std::vector<Vec3> line = io::lineOf(mesh, "line");
    Scene scene;
    scene.deformables = {cableAlong(line, .1 * extentOf(line))};
    step(scene);
  });
  orError([&] {
    const TriangleMesh surface{mesh.vertices, mesh.triangles};
    const TetSolidDef solid = tetSolidFromSurface(surface, .3 * extentOf(mesh.vertices));
    validate(Deformable(solid), "solid");
    expectIndices(solid.tetrahedra, solid.vertices.size());
  });
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
    useAsShapes(mesh);
    useAsObjects(mesh);
  });
}

}  // namespace rubble::fuzz
