/// Joints in the API.
#include <numbers>

#include "cook/checks.h"
#include "world/world_impl.h"

namespace rubble {

JointId World::addJoint(const JointDef& joint, BodyId a, BodyId b, BodyId frameBodyA, BodyId frameBodyB) {
  const JointId id = withMemory("addJoint", [&] {
    validate(joint, "joint");
    return impl_->addJoint(joint, a, b, frameBodyA, frameBodyB);
  });
  impl_->pass(inputs::AddJoint{joint, a, b, frameBodyA, frameBodyB});
  return id;
}
void World::removeJoint(JointId id) {
  withMemory("removeJoint", [&] { impl_->removeJoint(id); });
  impl_->pass(inputs::RemoveJoint{id});
}
bool World::alive(JointId id) const { return impl_->registry.joints.alive(id); }
std::vector<JointId> World::joints() const {
  return withMemory("joints", [&] { return impl_->registry.joints.ids(); });
}
JointId World::findJoint(const std::string& name) const {
  const auto it = impl_->registry.jointNames.find(name);
  if (it == impl_->registry.jointNames.end()) throw Error("joint", "the name of a joint", "\"" + name + "\"");
  return it->second;
}
JointState World::state(JointId id) const {
  return withMemory("state", [&] {
    impl_->requireAlive(id);
    const JointRecord& joint = impl_->registry.joints[id];
    JointState state = impl_->engine->read().jointState(static_cast<int>(joint.engine.type),
                                                        joint.engineSlot);
    state.axes.resize(static_cast<std::size_t>(axisCount(joint.def.type)));
    if (joint.engine.turned != 0) {
      const std::vector<JointAxisState> own = state.axes;
      for (std::size_t i = 0; i < own.size(); ++i)
        state.axes[i / 3 * 3 + (i + static_cast<std::size_t>(joint.engine.turned)) % 3] = own[i];
    }
    return state;
  });
}

const JointDef& World::definition(JointId id) const {
  impl_->requireAlive(id);
  return impl_->registry.joints[id].def;
}
std::array<BodyId, 2> World::bodiesOf(JointId id) const {
  impl_->requireAlive(id);
  return {impl_->registry.joints[id].a, impl_->registry.joints[id].b};
}
std::array<BodyId, 2> World::frameBodiesOf(JointId id) const {
  impl_->requireAlive(id);
  return {impl_->registry.joints[id].frameBodyA, impl_->registry.joints[id].frameBodyB};
}
void World::setDefinition(JointId id, const JointDef& joint) {
  withMemory("setDefinition", [&] { impl_->redefine(id, joint); });
}
void World::setTargetPosition(JointId id, int axis, double position) {
  withMemory("setTargetPosition", [&] {
    impl_->requireAlive(id);
    if (definition(id).type == JointType::Spring)
      throw Error("joint", "setLength for a spring", "setTargetPosition");
    impl_->editAxis(id, axis, [&](JointAxis& a) { a.targetPosition = position; });
  });
}
void World::setTargetSpeed(JointId id, int axis, double speed) {
  withMemory("setTargetSpeed",
             [&] { impl_->editAxis(id, axis, [&](JointAxis& a) { a.targetSpeed = speed; }); });
}
void World::setMotorForce(JointId id, int axis, double force) {
  withMemory("setMotorForce",
             [&] { impl_->editAxis(id, axis, [&](JointAxis& a) { a.motorForce = force; }); });
}
void World::setLimits(JointId id, int axis, double min, double max) {
  withMemory("setLimits", [&] {
    impl_->requireAlive(id);
    const JointType type = definition(id).type;
    if (hasLength(type) && type != JointType::Spring)
      throw Error("joint", std::string("setLength for a ") + keyword(type), "setLimits");
    impl_->editAxis(id, axis, [&](JointAxis& a) { a.min = min, a.max = max; });
  });
}
void World::setLength(JointId id, double length) {
  withMemory("setLength", [&] {
    impl_->requireAlive(id);
    JointDef def = definition(id);
    if (!hasLength(def.type)) throw Error("joint", "a distance, rope, spring or pulley", keyword(def.type));
    def.length = length;
    impl_->redefine(id, def);
  });
}
void World::setDriveOrientation(JointId id, const Quat& orientation) {
  withMemory("setDriveOrientation", [&] {
    impl_->requireAlive(id);
    JointDef def = definition(id);
    if (def.type != JointType::SwingTwist) throw Error("joint", "a swing-twist joint", keyword(def.type));
    def.driveOrientation = orientation;
    impl_->redefine(id, def);
  });
}

JointId World::addDragJoint(BodyId id, const Vec3& point, double maxForce, double frequency) {
  impl_->requireAlive(id);
  checks::positive(frequency, "frequency");
  checks::finite(point, "point");
  checks::positiveOrInfinite(maxForce, "maxForce");
  const BodyState body = state(id);
  JointDef def;
  def.type = JointType::Drag;
  def.anchorA = rotateInverse(body.orientation, point - body.position);
  def.anchorB = point;
  const double rate = 2 * std::numbers::pi * frequency;
  def.stiffness = impl_->registry.bodies[id].mass.mass * rate * rate;
  def.dampingRatio = 1;
  def.maxForce = maxForce;
  return addJoint(def, id, {});
}
void World::setDragTarget(JointId id, const Vec3& target) {
  withMemory("setDragTarget", [&] {
    impl_->requireAlive(id);
    JointDef def = definition(id);
    if (def.type != JointType::Drag) throw Error("joint", "a drag joint", keyword(def.type));
    def.anchorB = target;
    impl_->redefine(id, def);
  });
}

}  // namespace rubble
