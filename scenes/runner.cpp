#include <algorithm>
#include <cmath>

#include "cook/checks.h"
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

}  // namespace

WorldOptions Runner::optionsOf(const Job& job, WorldOptions options) {
  options.params.sleeping |= job.sleeping;
  options.events |= job.events;
  return options;
}

Runner::Runner(Job job, const WorldOptions& options)
    : job_(inStepsOf(options.params.dt, std::move(job))),
      world_(job_.scene, optionsOf(job_, options)),
      actuators_(job_.actuators, world_) {}

StepReport Runner::step() {
  if (!started_) {
    started_ = true;
    for (auto& probe : job_.probes) probe->start(world_);
  }
  world_.runEvents();
  if (job_.drive) job_.drive(world_);
  actuators_.apply(world_);
  StepReport report = world_.step();
  for (auto& probe : job_.probes) probe->afterStep(world_, report);
  return report;
}

void Runner::resume(const Snapshot& checkpoint, std::span<const double> activations) {
  for (auto& probe : job_.probes) probe->start(world_);
  started_ = true;
  const Params own = world_.params();
  world_.restore(checkpoint);
  std::ranges::copy(activations, actuators_.activations().begin());
  const Params& its = world_.params();
  for (const ParamField& field : paramFields())
    if (const double a = field.get(own), b = field.get(its); a != b)
      throw Error(std::string("params.") + field.name, "that of the checkpoint, " + checks::text(b),
                  checks::text(a));
  if (own != its) throw Error("params", "the preset and policies of the checkpoint", "others");
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
