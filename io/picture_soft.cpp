/// Deformable objects as they are drawn: the triangles of sheets and solids, tubes about rods and springs, a
/// ball for each particle.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "forces/soft_model.h"
#include "io/picture_values.h"

namespace rubble::io {
namespace {

constexpr int kTubeSides = 8;
/// Springs without a radius are drawn this thick, over their length [1].
constexpr double kThinTube = .03;

double valueOf(const DrawnSoft& object, std::size_t vertex) {
  return object.values.empty() ? 0 : static_cast<double>(object.values[vertex]);
}

/// Keys of deformable objects do not meet those of bodies; they keep their colors.
std::uint32_t keyOf(const DrawnSoft& object, std::size_t vertex) {
  return kSoftKeys |
         (((object.number << kSoftKeyBits) + static_cast<std::uint32_t>(vertex)) & (kSoftKeys - 1));
}

/// `values` are those of the points.
void addMesh(const DrawnSoft& object, std::vector<Vec3> points,
             const std::vector<std::array<int, 3>>& triangles, bool twoSided, std::vector<float> values,
             std::vector<PictureBody>& out) {
  // vertices that are not finite have no place in a picture
  const auto finite = [&](const std::array<int, 3>& t) {
    return std::all_of(t.begin(), t.end(), [&](int v) {
      const Vec3& x = points[static_cast<std::size_t>(v)];
      return std::isfinite(x.x + x.y + x.z);
    });
  };
  std::vector<std::array<int, 3>> drawn;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(drawn), finite);
  if (drawn.empty()) return;
  Vec3 middle;
  for (const auto& t : drawn)
    for (const int v : t)
      middle += points[static_cast<std::size_t>(v)] / (3. * static_cast<double>(drawn.size()));
  for (Vec3& x : points) x = std::isfinite(x.x + x.y + x.z) ? x - middle : Vec3{};
  double speed = 0;
  for (const Vec3& v : object.velocities) speed += length(v) / static_cast<double>(object.velocities.size());
  PictureBody body{Shape::mesh(std::move(points), std::move(drawn), twoSided),
                   middle,
                   {},
                   speed,
                   keyOf(object, 0),
                   Motion::Dynamic};
  body.deforms = true;
  for (std::size_t i = 0; i < object.values.size(); ++i)
    body.value = i == 0 ? valueOf(object, 0) : std::max(body.value, valueOf(object, i));
  body.vertexValues = std::move(values);
  out.push_back(std::move(body));
}

void add(const DrawnSoft& object, std::vector<PictureBody>& balls, std::vector<PictureBody>& meshes) {
  if (object.spheres) {
    for (std::size_t i = 0; i < object.vertices.size(); ++i) {
      balls.push_back({Shape::sphere(object.radius),
                       object.vertices[i],
                       {},
                       length(object.velocities[i]),
                       keyOf(object, i),
                       Motion::Dynamic});
      balls.back().value = valueOf(object, i);
    }
    return;
  }
  if (!object.triangles.empty()) {
    addMesh(object, object.vertices, object.triangles, !object.solid, object.values, meshes);
    return;
  }
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  std::vector<float> values;
  for (const auto& s : object.segments) {
    const Vec3 &a = object.vertices[static_cast<std::size_t>(s[0])],
               &b = object.vertices[static_cast<std::size_t>(s[1])];
    addTube(a, b, object.radius > 0 ? object.radius : kThinTube * length(b - a), points, triangles);
    if (object.values.empty()) continue;
    for (const int end : s)
      values.insert(values.end(), kTubeSides, object.values[static_cast<std::size_t>(end)]);
  }
  addMesh(object, std::move(points), triangles, false, std::move(values), meshes);
}

}  // namespace

void addTube(const Vec3& a, const Vec3& b, double radius, std::vector<Vec3>& points,
             std::vector<std::array<int, 3>>& triangles) {
  const Vec3 along = normalize(b - a, {0, 0, 1});
  const Vec3 u = normalize(cross(along, std::fabs(along.z) < .9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0})),
             v = cross(along, u);
  const int first = static_cast<int>(points.size());
  for (const Vec3& end : {a, b})
    for (int k = 0; k < kTubeSides; ++k) {
      const double angle = 2 * std::numbers::pi * k / kTubeSides;
      points.push_back(end + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
  for (int k = 0; k < kTubeSides; ++k) {
    const int i = first + k, j = first + (k + 1) % kTubeSides;
    triangles.push_back({i, j, j + kTubeSides}), triangles.push_back({i, j + kTubeSides, i + kTubeSides});
  }
  for (int k = 1; k + 1 < kTubeSides; ++k) {
    triangles.push_back({first, first + k + 1, first + k});
    triangles.push_back({first + kTubeSides, first + kTubeSides + k, first + kTubeSides + k + 1});
  }
}

void addDeformables(std::span<const DrawnSoft> objects, std::vector<PictureBody>& bodies) {
  std::vector<PictureBody> meshes;
  for (const DrawnSoft& object : objects) add(object, bodies, meshes);
  bodies.insert(bodies.end(), std::make_move_iterator(meshes.begin()), std::make_move_iterator(meshes.end()));
}

void addDeformables(const World& world, std::vector<PictureBody>& bodies, ColorBy colorBy) {
  std::vector<DrawnSoft> objects;
  const std::vector<std::vector<float>> values = vertexValues(world, colorBy);
  for (const DeformableId id : world.deformables()) {
    World::Surface s = world.surface(id);
    objects.push_back({static_cast<std::uint32_t>(id.index), std::move(s.vertices), world.velocities(id),
                       std::move(s.triangles), std::move(s.segments), s.radius, s.spheres,
                       std::holds_alternative<TetSolidDef>(world.definition(id)), values[objects.size()]});
  }
  addDeformables(objects, bodies);
}

void addDeformables(const Scene& scene, std::vector<PictureBody>& bodies) {
  std::vector<DrawnSoft> objects;
  for (std::size_t i = 0; i < scene.deformables.size(); ++i) {
    const Deformable& def = scene.deformables[i];
    const auto model = cookDeformable(def, "deformables[" + std::to_string(i) + "]");
    DrawnSoft object{static_cast<std::uint32_t>(i),
                     {},
                     {},
                     model->surface,
                     {},
                     model->vertices[0].radius,
                     std::holds_alternative<ParticlesDef>(def),
                     std::holds_alternative<TetSolidDef>(def)};
    for (const SoftModel::Vertex& v : model->vertices)
      object.vertices.push_back(v.position), object.velocities.push_back(v.velocity);
    for (const SpringModel& s : model->list<SpringModel>()) object.segments.push_back(s.v);
    objects.push_back(std::move(object));
  }
  addDeformables(objects, bodies);
}

}  // namespace rubble::io
