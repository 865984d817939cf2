/// Scripted events of a scene.
#include <algorithm>

#include "world/world_impl.h"

namespace rubble {

namespace {

void removeBodies(World& world, const std::string& pattern) {
  if (pattern.empty() || pattern.back() != '*') return world.removeBody(world.findBody(pattern));
  const std::string prefix = pattern.substr(0, pattern.size() - 1);
  bool any = false;
  for (const BodyId id : world.bodies()) {
    if (world.definition(id).name.rfind(prefix, 0) != 0) continue;
    world.removeBody(id);
    any = true;
  }
  if (!any) throw Error("event.remove", "a body with a name that begins with \"" + prefix + "\"", "none");
}

void apply(World& world, const Event& event) {
  for (const std::string& name : event.removeJoints) world.removeJoint(world.findJoint(name));
  for (const std::string& pattern : event.remove) removeBodies(world, pattern);
  for (const BodyDef& body : event.add) world.addBody(body);
  for (const Event::Push& push : event.setVelocity) {
    const BodyId id = world.findBody(push.body);
    BodyState state = world.state(id);
    state.velocity = push.velocity;
    state.angularVelocity = push.angularVelocity;
    world.setState(id, state);
  }
  for (const Event::Turn& turn : event.setJoint) {
    const JointId id = world.findJoint(turn.joint);
    if (turn.targetPosition) world.setTargetPosition(id, turn.axis, *turn.targetPosition);
    if (turn.targetSpeed) world.setTargetSpeed(id, turn.axis, *turn.targetSpeed);
    if (turn.motorForce) world.setMotorForce(id, turn.axis, *turn.motorForce);
    if (turn.length) world.setLength(id, *turn.length);
    if (turn.dragTo) world.setDragTarget(id, *turn.dragTo);
  }
}

}  // namespace

void World::Impl::setScript(std::vector<Event> events) {
  std::ranges::stable_sort(events, {}, &Event::step);
  registry.script = std::make_shared<const std::vector<Event>>(std::move(events));
  registry.nextEvent = 0;
}

void World::runEvents() {
  while (impl_->stepsToEvent() <= 0) {
    const std::shared_ptr<const std::vector<Event>> script = impl_->registry.script;
    // an event that fails is not tried again
    apply(*this, (*script)[static_cast<std::size_t>(impl_->registry.nextEvent++)]);
  }
}

}  // namespace rubble
