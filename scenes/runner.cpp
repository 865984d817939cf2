#include <algorithm>
#include <cmath>

#include "registry.h"

namespace rubble::scenes {
namespace {

/// A job whose step counts are in steps of `dt`, at the same times.
Job inStepsOf(double dt, Job job) {
  if (!(dt > 0) || dt == job.dt) return job;
  const double factor = job.dt / dt;
  const auto scaled = [factor](int step) { return int(std::lround(step * factor)); };
  job.steps = std::max(1, scaled(job.steps));
  if (job.smashStep >= 0) job.smashStep = scaled(job.smashStep);
  for (Event& event : job.scene.events) event.step = scaled(event.step);
  job.dt = dt;
  return job;
}

Job inOrder(Job job) {
  std::stable_sort(job.scene.events.begin(), job.scene.events.end(),
                   [](const Event& a, const Event& b) { return a.step < b.step; });
  return job;
}

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

WorldOptions Runner::optionsOf(const Job& job, WorldOptions options) {
  options.params.sleeping |= job.sleeping;
  options.events |= job.events;
  return options;
}

Runner::Runner(Job job, const WorldOptions& options)
    : job_(inOrder(inStepsOf(options.params.dt, std::move(job)))),
      world_(job_.scene, optionsOf(job_, options)) {}

StepReport Runner::step() {
  if (!started_) {
    started_ = true;
    for (auto& probe : job_.probes) probe->start(world_);
  }
  const std::vector<Event>& events = job_.scene.events;
  for (; nextEvent_ < events.size() && events[nextEvent_].step <= world_.stepCount(); ++nextEvent_)
    apply(world_, events[nextEvent_]);
  if (job_.drive) job_.drive(world_);
  StepReport report = world_.step();
  for (auto& probe : job_.probes) probe->afterStep(world_, report);
  return report;
}

void Runner::resume(const Snapshot& checkpoint) {
  for (auto& probe : job_.probes) probe->start(world_);
  started_ = true;
  world_.restore(checkpoint);
  rewound();
}

void Runner::rewound() {
  const std::vector<Event>& events = job_.scene.events;
  nextEvent_ = 0;
  while (nextEvent_ < events.size() && events[nextEvent_].step < world_.stepCount()) ++nextEvent_;
}

RunResult Runner::run(int steps, const Observer& observer) {
  RunResult result;
  result.reports.reserve(std::size_t(std::max(0, steps)));
  for (int i = 0; i < steps; ++i) {
    result.reports.push_back(step());
    if (observer && !observer(world_, result.reports.back(), i, steps)) break;
  }
  for (auto& probe : job_.probes) probe->finish(world_, result.metrics);
  result.verdict = judge(job_.claims, result.metrics);
  result.quality = world_.quality();
  return result;
}

}  // namespace rubble::scenes
