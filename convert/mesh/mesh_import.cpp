#include "convert/mesh/mesh_import.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

#include <rubble/error.h>

#include "convert/mesh/corners.h"

namespace rubble::convert {
namespace {

/// A run of 5 s.
constexpr int kSteps = 300;
/// Step of the strike at a broken solid.
constexpr int kStrikeStep = 60;
/// The ball that strikes: its radius as a share of the longest side of the solid, and its density over that
/// of it.
constexpr double kBallSize = 0.12, kBallDensity = 3;
/// Iterations for solids of many joints.
constexpr int kFractureIterations = 10;

struct Extent {
  Vec3 low, high;
  Vec3 size() const { return high - low; }
  double longest() const { return std::max({size().x, size().y, size().z}); }
};
Extent extentOf(const TriangleMesh& mesh) {
  Extent out{mesh.vertices[0], mesh.vertices[0]};
  for (const Vec3& x : mesh.vertices)
    for (int i = 0; i < 3; ++i)
      out.low[i] = std::min(out.low[i], x[i]), out.high[i] = std::max(out.high[i], x[i]);
  return out;
}

template <class... T> std::string textOf(const char* format, T... values) {
  char text[160];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/// The surface with its middle above the origin and its lowest point on z = 0.
TriangleMesh standing(TriangleMesh mesh) {
  const Extent extent = extentOf(mesh);
  const Vec3 middle = (extent.low + extent.high) * 0.5;
  for (Vec3& x : mesh.vertices) x -= {middle.x, middle.y, extent.low.z};
  return mesh;
}

std::string nameOf(const std::string& file) { return std::filesystem::path(file).stem().string(); }

MeshScene emptyScene(const std::string& file, const MeshOptions& options, const TriangleMesh& mesh) {
  if (!(options.density > 0))
    throw Error("--density", "a density above 0 [kg/m3]", std::to_string(options.density));
  MeshScene out;
  out.file.scene.name = nameOf(file);
  out.file.scene.description = "imported from " + std::filesystem::path(file).filename().string();
  out.file.steps = kSteps;
  if (options.ground) {
    BodyDef ground;
    ground.name = "ground", ground.shape = Shape::plane(), ground.motion = Motion::Static;
    out.file.scene.bodies.push_back(ground);
  }
  const Vec3 size = extentOf(mesh).size();
  out.facts.push_back(
      textOf("%zu triangles, %.4g x %.4g x %.4g m", mesh.triangles.size(), size.x, size.y, size.z));
  return out;
}

Shape hullShape(const std::vector<Vec3>& points, const std::string& file, int& reduced) {
  bool fewer = false;
  Shape shape = Shape::hull(cornersOf(points, fewer, file));
  reduced += fewer;
  return shape;
}

/// Lowest point of hulls [m]; 0 for other shapes, which are as low as the mesh.
double lowestOf(const Shape& shape) {
  double low = std::numeric_limits<double>::infinity();
  if (shape.type == ShapeType::Hull)
    for (const Vec3& x : shape.geometry->points) low = std::min(low, x.z);
  if (shape.type == ShapeType::Compound)
    for (const ShapePartDef& part : shape.geometry->parts) low = std::min(low, lowestOf(part.shape));
  return std::isfinite(low) ? low : 0;
}

void addBody(MeshScene& out, const std::string& file, const MeshOptions& options, const TriangleMesh& mesh) {
  BodyDef body;
  body.name = nameOf(file);
  body.density = options.density;
  int reduced = 0;
  std::string what;
  if (options.as == MeshAs::Hull) {
    body.shape = hullShape(mesh.vertices, file, reduced);
    what = textOf("convex hull of %zu corners", body.shape.geometry->points.size());
  } else if (options.as == MeshAs::Parts) {
    std::vector<ShapePartDef> parts;
    double volume = 0;
    for (const ConvexPart& part : convexParts(mesh, options.concavity, options.parts, file)) {
      parts.push_back({hullShape(part.points, file, reduced), {}, {}});
      volume += part.volume;
    }
    what = textOf("compound of %zu convex parts, %.2g %% more volume than the mesh", parts.size(),
                  100 * (volume / volumeOf(mesh) - 1));
    body.shape = parts.size() == 1 ? parts[0].shape : Shape::compound(std::move(parts));
  } else if (options.as == MeshAs::Distance) {
    body.shape = distanceFieldOf(mesh, options.cells, file);
    const auto& counts = body.shape.geometry->counts;
    what = textOf("distance field of %d x %d x %d samples", counts[0], counts[1], counts[2]);
  } else {
    body.motion = Motion::Static;
    body.shape = Shape::mesh(mesh.vertices, mesh.triangles);
    what = "static mesh";
  }
  // A hull with fewer corners may not reach as low as the mesh.
  body.position.z = -lowestOf(body.shape);
  if (body.motion == Motion::Dynamic)
    what += textOf(", %.4g kg", massProperties(body.shape, body.density).mass);
  out.facts.push_back("body '" + body.name + "': " + what);
  if (reduced > 0)
    out.facts.push_back(textOf("%d hull%s had more than %zu corners and lost some", reduced,
                               reduced == 1 ? "" : "s", kMostCorners));
  out.file.scene.bodies.push_back(std::move(body));
}

void addDeformable(MeshScene& out, const std::string& file, const MeshOptions& options,
                   const TriangleMesh& mesh) {
  if (options.as == MeshAs::Cloth) {
    ClothDef cloth = clothFromMesh(mesh);
    cloth.name = nameOf(file);
    out.facts.push_back(textOf("cloth of %zu vertices", cloth.vertices.size()));
    // Free of the ground by its thickness.
    for (Vec3& x : cloth.vertices) x.z += cloth.thickness;
    out.file.scene.deformables.push_back(std::move(cloth));
    return;
  }
  TetSolidDef solid = tetSolidFromSurface(mesh, extentOf(mesh).longest() / options.cells);
  solid.name = nameOf(file);
  solid.density = options.density;
  out.facts.push_back(textOf("solid of %zu tetrahedra", solid.tetrahedra.size()));
  out.file.scene.deformables.push_back(std::move(solid));
}

/// A fixed joint at a contact of two pieces.
JointDef glue(const Scene& scene, const Fracture::Contact& contact, int firstPiece, double strength) {
  JointDef joint = jointAt(scene, JointType::Fixed, firstPiece + contact.a, firstPiece + contact.b,
                           contact.center, frameAlong(contact.normal));
  joint.breakForce = strength * contact.area;
  // A square of edge a breaks in bending at a moment of strength a^3 / 6.
  joint.breakTorque = strength * std::pow(contact.area, 1.5) / 6;
  return joint;
}

void addStrike(MeshScene& out, const Extent& extent, double density, double speed) {
  Event event;
  event.step = kStrikeStep;
  BodyDef ball;
  ball.name = "ball";
  ball.shape = Shape::sphere(kBallSize * extent.longest());
  ball.density = kBallDensity * density;
  const double gap = ball.shape.radius + 0.05 * extent.longest();
  ball.position = {0, extent.low.y - gap, std::max(ball.shape.radius, 0.6 * extent.high.z)};
  ball.velocity = {0, speed, 0};
  event.add.push_back(ball);
  out.file.scene.events.push_back(std::move(event));
  out.file.smashStep = kStrikeStep;
}

}  // namespace

const std::vector<std::string>& meshKinds() {
  static const std::vector<std::string> kinds{"hull", "parts", "distance", "mesh", "solid", "cloth"};
  return kinds;
}

MeshScene importMesh(const std::string& file, const MeshOptions& options) {
  const TriangleMesh mesh = standing(readSurface(file, options.scale, options.up));
  MeshScene out = emptyScene(file, options, mesh);
  if (options.as == MeshAs::Solid || options.as == MeshAs::Cloth)
    addDeformable(out, file, options, mesh);
  else
    addBody(out, file, options, mesh);
  validate(out.file.scene);
  return out;
}

MeshScene importFracture(const std::string& file, const MeshOptions& options, const FractureOptions& how) {
  if (!(how.strength > 0)) throw Error("--strength", "a strength above 0 [Pa]", std::to_string(how.strength));
  const TriangleMesh mesh = standing(readSurface(file, options.scale, options.up));
  MeshScene out = emptyScene(file, options, mesh);
  Fracture broken = fracture(mesh, how.pieces, how.seed, file);
  Scene& scene = out.file.scene;
  const int first = static_cast<int>(scene.bodies.size());
  int reduced = 0;
  double volume = 0;
  for (std::size_t i = 0; i < broken.pieces.size(); ++i) {
    BodyDef piece;
    piece.name = "piece" + std::to_string(i);
    piece.density = options.density;
    // About its middle, so that pieces far from the origin keep their digits.
    std::vector<Vec3>& points = broken.pieces[i].points;
    for (const Vec3& x : points) piece.position += x / static_cast<double>(points.size());
    for (Vec3& x : points) x -= piece.position;
    piece.shape = hullShape(points, file, reduced);
    volume += broken.pieces[i].volume;
    scene.bodies.push_back(std::move(piece));
  }
  for (std::size_t k = 0; k < broken.contacts.size(); ++k) {
    scene.joints.push_back(glue(scene, broken.contacts[k], first, how.strength));
    scene.joints.back().name = "joint" + std::to_string(k);
  }
  if (how.strike > 0) addStrike(out, extentOf(mesh), options.density, how.strike);
  out.file.iterations = kFractureIterations;
  out.facts.push_back(textOf("%zu convex pieces, %.2f %% of the volume", broken.pieces.size(),
                             100 * volume / volumeOf(mesh)));
  out.facts.push_back(textOf("%zu joints that break at %.3g Pa", broken.contacts.size(), how.strength));
  constexpr double kWorthSaying = 1e-6;
  if (broken.lost > kWorthSaying * volume)
    out.facts.push_back(
        textOf("slivers of %.2g %% of the volume are left out", 100 * broken.lost / volumeOf(mesh)));
  validate(scene);
  return out;
}

}  // namespace rubble::convert
