#include "probe_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <rubble/mesh.h>
#include "cook/cook.h"

namespace rubble::scenes {
namespace {

double smallestHalfEdge(const Shape& shape) {
  if (shape.type == ShapeType::Box)
    return std::min({shape.halfExtents.x, shape.halfExtents.y, shape.halfExtents.z});
  return shape.geometry ? .3 * cook(shape).radius : shape.radius;
}

}  // namespace

std::vector<Watched> watch(const Scene& scene, const std::vector<int>& sceneIndices) {
  std::vector<Watched> bodies;
  bodies.reserve(sceneIndices.size());
  for (const int index : sceneIndices) {
    const BodyDef& body = scene.bodies[std::size_t(index)];
    bodies.push_back({index, {}, body.position, smallestHalfEdge(body.shape)});
  }
  return bodies;
}

void begin(std::vector<Watched>& bodies, const World& world) {
  for (Watched& body : bodies) {
    body.id = world.bodyAt(body.sceneIndex);
    body.start = world.state(body.id).position;
  }
}

double reach(const Shape& shape, const Quat& orientation, const Vec3& up) {
  const Vec3 local = abs(rotateInverse(orientation, up));
  switch (shape.type) {
    case ShapeType::Box:
      return dot(local, shape.halfExtents);
    case ShapeType::Capsule:
      return shape.radius + shape.halfLength * local.z;
    case ShapeType::Sphere:
      return shape.radius;
    case ShapeType::Cylinder:
      return shape.halfLength * local.z + shape.radius * std::sqrt(std::max(0., 1 - local.z * local.z));
    case ShapeType::Plane:
      return 0;
    default:
      break;
  }
  double most = 0;
  for (const Vec3& point : shapeMesh(shape, 24).points)
    most = std::max(most, dot(point, rotateInverse(orientation, up)));
  return most;
}

double groundHeight(const Scene& scene) {
  const Vec3 up = normalize(-scene.gravity);
  for (const BodyDef& body : scene.bodies)
    if (body.name == "ground") return dot(body.position, up) + reach(body.shape, body.orientation, up);
  return -std::numeric_limits<double>::infinity();
}

void MomentProbe::afterStep(const World& world, const StepReport&) {
  if (done_ || !reached(world, at_)) return;
  measure(world, metrics_);
  done_ = true;
}

void MomentProbe::finish(const World& world, Metrics& metrics) {
  if (!done_ && !waits_) {
    metrics_.clear();
    measure(world, metrics_);
  }
  metrics.insert(metrics_.begin(), metrics_.end());
  conclude(metrics);
}

}  // namespace rubble::scenes
