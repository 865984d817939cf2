/// Scripted events of a scene.
#include <algorithm>

#include "world/world_impl.h"

namespace rubble {

namespace {

void removeBodies(World& world, const std::string& pattern) {
  if (pattern.empty() || pattern.back() != '*') return world.removeBody(world.findBody(pattern));
  const std::string prefix = pattern.substr(0, pattern.size() - 1);
  std::vector<BodyId> ids = world.bodies();
  std::erase_if(ids, [&](BodyId id) { return world.definition(id).name.rfind(prefix, 0) != 0; });
  if (ids.empty())
    throw Error("event.remove", "a body with a name that begins with \"" + prefix + "\"", "none");
  world.removeBodies(ids);
}

/// Calls f(element) for those of a list that `done` does not count, and counts them.
template <class List, class F> void forEachLeft(const List& list, int& done, int& passed, F&& f) {
  for (const auto& element : list) {
    if (passed++ < done) continue;
    f(element);
    ++done;
  }
}

/// Applies what is left of an event. `done`: its parts that were applied.
void apply(World& world, const Event& event, int& done) {
  int passed = 0;
  forEachLeft(event.removeJoints, done, passed,
              [&](const std::string& name) { world.removeJoint(world.findJoint(name)); });
  forEachLeft(event.remove, done, passed, [&](const std::string& pattern) { removeBodies(world, pattern); });
  forEachLeft(event.add, done, passed, [&](const BodyDef& body) { world.addBody(body); });
  forEachLeft(event.setVelocity, done, passed, [&](const Event::Push& push) {
    const BodyId id = world.findBody(push.body);
    BodyState state = world.state(id);
    state.velocity = push.velocity;
    state.angularVelocity = push.angularVelocity;
    world.setState(id, state);
  });
  forEachLeft(event.setJoint, done, passed, [&](const Event::Turn& turn) {
    const JointId id = world.findJoint(turn.joint);
    if (turn.targetPosition) world.setTargetPosition(id, turn.axis, *turn.targetPosition);
    if (turn.targetSpeed) world.setTargetSpeed(id, turn.axis, *turn.targetSpeed);
    if (turn.motorForce) world.setMotorForce(id, turn.axis, *turn.motorForce);
    if (turn.length) world.setLength(id, *turn.length);
    if (turn.dragTo) world.setDragTarget(id, *turn.dragTo);
  });
}

}  // namespace

void World::Impl::setScript(std::vector<Event> events) {
  std::ranges::stable_sort(events, {}, &Event::step);
  registry.script = std::make_shared<const std::vector<Event>>(std::move(events));
  registry.nextEvent = registry.partsOfEvent = 0;
}

void World::runEvents() {
  Registry& r = impl_->registry;
  const auto finish = [&] { ++r.nextEvent, r.partsOfEvent = 0; };
  while (impl_->stepsToEvent() <= 0) {
    const std::shared_ptr<const std::vector<Event>> script = r.script;
    try {
      withMemory("runEvents",
                 [&] { apply(*this, (*script)[static_cast<std::size_t>(r.nextEvent)], r.partsOfEvent); });
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const OutOfMemory&) {
      throw;
    } catch (...) {
      // any other event that fails is not tried again
      finish();
      throw;
    }
    finish();
  }
}

}  // namespace rubble
