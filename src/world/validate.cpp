#include <rubble/error.h>
#include <rubble/scene.h>

#include "cook/checks.h"
#include "world/world_impl.h"

namespace rubble {

namespace {

using namespace checks;

void validateShape(const Shape& s, Motion motion, const Path& path) {
  validate(s, path);
  if (s.type == ShapeType::Plane && motion != Motion::Static)
    throw Error(path, "a static body for a plane", "a moving one");
  if ((s.type == ShapeType::Mesh || s.type == ShapeType::HeightField) && motion == Motion::Dynamic)
    throw Error(path, "a static or kinematic body for a surface without thickness", "a dynamic one");
}

void validateJoint(const Scene& scene, const JointDef& joint, const Path& path) {
  const int count = static_cast<int>(scene.bodies.size());
  const auto inRange = [&](int body, const char* name) {
    if (body != kWorld && (body < 0 || body >= count))
      throw Error(path + name, "a body index below " + std::to_string(count) + " or the world",
                  std::to_string(body));
  };
  inRange(joint.bodyA, ".bodyA");
  inRange(joint.bodyB, ".bodyB");
  if (joint.bodyA == joint.bodyB) throw Error(path, "two different bodies", "the same one twice");
  const auto dynamic = [&](int body) {
    return body != kWorld && scene.bodies[static_cast<std::size_t>(body)].motion == Motion::Dynamic;
  };
  inRange(joint.frameBodyA, ".frameBodyA");
  inRange(joint.frameBodyB, ".frameBodyB");
  checkFrameBody(joint.type, joint.bodyA, joint.frameBodyA, path + ".frameBodyA");
  checkFrameBody(joint.type, joint.bodyB, joint.frameBodyB, path + ".frameBodyB");
  if (!dynamic(joint.bodyA) && !dynamic(joint.bodyB)) throw Error(path, "at least one dynamic body", "none");
  validate(joint, path);
}

}  // namespace

void validate(const BodyDef& body, const Path& path) {
  enumeration(body.motion, Motion::Dynamic, path + ".motion");
  validateShape(body.shape, body.motion, path + ".shape");
  material(body.material, path + ".material");
  if (body.motion == Motion::Dynamic) {
    if (body.mass)
      positive(*body.mass, path + ".mass");
    else
      positive(body.density, path + ".density");
    if (body.inertia) moments(*body.inertia, path + ".inertia");
  }
  finite(body.position, path + ".position");
  unit(body.orientation, path + ".orientation");
  finite(body.velocity, path + ".velocity");
  finite(body.angularVelocity, path + ".angularVelocity");
  notNegative(body.linearDamping, path + ".linearDamping");
  notNegative(body.angularDamping, path + ".angularDamping");
  finite(body.gravityScale, path + ".gravityScale");
}

void validate(const MaterialPair& pair, const Path& path) {
  for (const auto& [name, field] : {std::pair(&pair.a, ".a"), std::pair(&pair.b, ".b")})
    if (name->empty()) throw Error(path + field, "the name of a material", "none");
  const auto check = [&](const std::optional<double>& value, const char* field) {
    if (value) notNegative(*value, path + field);
  };
  check(pair.staticFriction, ".staticFriction"), check(pair.dynamicFriction, ".dynamicFriction");
  check(pair.restitution, ".restitution");
  check(pair.rollingFriction, ".rollingFriction"), check(pair.torsionalFriction, ".torsionalFriction");
  if (pair.restitution.value_or(0) > 1)
    throw Error(path + ".restitution", "at most 1", std::to_string(*pair.restitution));
  if (pair.staticFriction && pair.dynamicFriction && *pair.dynamicFriction > *pair.staticFriction)
    throw Error(path + ".dynamicFriction", "at most the static friction",
                std::to_string(*pair.dynamicFriction));
}

bool ofSameMaterials(const MaterialPair& p, const MaterialPair& q) {
  return (p.a == q.a && p.b == q.b) || (p.a == q.b && p.b == q.a);
}

void validate(const BodyState& state, const Path& path) {
  finite(state.position, path + ".position");
  unit(state.orientation, path + ".orientation");
  finite(state.velocity, path + ".velocity");
  finite(state.angularVelocity, path + ".angularVelocity");
}

void validate(const Scene& scene) {
  finite(scene.gravity, "gravity");
  for (std::size_t i = 0; i < scene.materialPairs.size(); ++i) {
    const MaterialPair& pair = scene.materialPairs[i];
    const Path list("materialPairs"), path = list[i];
    validate(pair, path);
    for (std::size_t k = 0; k < i; ++k)
      if (ofSameMaterials(pair, scene.materialPairs[k]))
        throw Error(path, "two names that have no other rule", "\"" + pair.a + "\" and \"" + pair.b + "\"");
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) validate(scene.bodies[i], Path("bodies")[i]);
  for (std::size_t i = 0; i < scene.joints.size(); ++i)
    validateJoint(scene, scene.joints[i], Path("joints")[i]);
  for (std::size_t i = 0; i < scene.deformables.size(); ++i)
    validate(scene.deformables[i], Path("deformables")[i]);
  for (std::size_t i = 0; i < scene.attachments.size(); ++i) {
    const AttachmentDef& a = scene.attachments[i];
    const Path list("attachments"), path = list[i];
    const auto check = [&](int index, std::size_t count, int least, const char* name) {
      if (index < least || (index >= 0 && static_cast<std::size_t>(index) >= count))
        throw Error(path + name, "an index below " + std::to_string(count), std::to_string(index));
    };
    check(a.object, scene.deformables.size(), 0, ".object");
    check(a.otherObject, scene.deformables.size(), -1, ".otherObject");
    check(a.body, scene.bodies.size(), kWorld, ".body");
  }
  for (std::size_t i = 0; i < scene.exclusions.size(); ++i) {
    const auto [a, b] = scene.exclusions[i];
    const Path list("exclusions"), path = list[i];
    const int count = static_cast<int>(scene.bodies.size());
    for (const int body : {a, b})
      if (body < 0 || body >= count)
        throw Error(path, "body indices below " + std::to_string(count), std::to_string(body));
    if (a == b) throw Error(path, "two different bodies", "the same one twice");
  }
  for (std::size_t i = 0; i < scene.events.size(); ++i) {
    const Path list("events"), path = list[i];
    if (scene.events[i].step < 0)
      throw Error(path + ".step", "a step of at least 0", std::to_string(scene.events[i].step));
    for (std::size_t k = 0; k < scene.events[i].add.size(); ++k)
      validate(scene.events[i].add[k], (path + ".add")[k]);
  }
}

}  // namespace rubble
