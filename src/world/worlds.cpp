#include <rubble/worlds.h>

#include <algorithm>
#include <chrono>

#include "world/worlds_impl.h"

namespace rubble {

namespace {

/// Adds the numbers of another report.
void accumulate(WorldsReport& to, const WorldsReport& from) {
  for (const auto member :
       {&StepReport::bodies, &StepReport::pairs, &StepReport::manifolds, &StepReport::contacts,
        &StepReport::vertices, &StepReport::vertexContacts, &StepReport::deflectedVertices,
        &StepReport::heldVertices, &StepReport::recycled, &StepReport::clashes, &StepReport::brokenJoints,
        &StepReport::sleepingBodies, &StepReport::stoppedBodies, &StepReport::quarantined,
        &StepReport::failedSolves, &StepReport::boundedSteps, &StepReport::spinLimited,
        &StepReport::unsettledImpacts})
    to.*member += from.*member;
  for (const auto member : {&StepReport::surfaceRounds, &StepReport::colors, &StepReport::colorRounds})
    to.*member = std::max(to.*member, from.*member);
  to.surfaceTests += from.surfaceTests;
  to.unfinishedMotion = std::max(to.unfinishedMotion, from.unfinishedMotion);
  to.broken.insert(to.broken.end(), from.broken.begin(), from.broken.end());
  if (to.difference.empty()) to.difference = from.difference;
  to.brokenIn.insert(to.brokenIn.end(), from.brokenIn.begin(), from.brokenIn.end());
  for (const Growth& growth : from.grown) {
    const auto found = std::ranges::find(to.grown, growth.what, &Growth::what);
    if (found == to.grown.end())
      to.grown.push_back(growth);
    else
      found->needed = std::max(found->needed, growth.needed);
  }
  for (std::size_t k = 0; k < from.stages.size(); ++k) {
    // mostly batches have the same stages in the same order
    const StageTime& stage = from.stages[k];
    const auto begin = to.stages.begin();
    const auto same = k < to.stages.size() ? begin + static_cast<std::ptrdiff_t>(k) : begin;
    const auto found = same != to.stages.end() && same->name == stage.name
                           ? same
                           : std::ranges::find(to.stages, stage.name, &StageTime::name);
    if (found == to.stages.end())
      to.stages.push_back(stage);
    else
      found->ms += stage.ms;
  }
}

}  // namespace

void Worlds::Impl::requireDistinct(std::span<const int> some) const {
  std::vector<int> sorted(some.begin(), some.end());
  std::ranges::sort(sorted);
  for (const int world : sorted) requireWorld(world);
  if (std::ranges::adjacent_find(sorted) != sorted.end())
    throw Error("worlds", "each world once", "one of them twice");
}

WorldsReport Worlds::Impl::step(std::size_t batch, int steps, std::span<const char> active) {
  const int first = static_cast<int>(batch) * perBatch, size = batches[batch]->count();
  std::vector<char> paused;
  if (!active.empty())
    for (int w = first; w < first + size; ++w) paused.push_back(active[static_cast<std::size_t>(w)] == 0);
  const auto isPaused = [](char each) { return each != 0; };
  WorldsReport report;
  if (!paused.empty() && std::ranges::all_of(paused, isPaused)) return report;
  if (std::ranges::none_of(paused, isPaused)) paused.clear();
  for (int w = first; w < first + size; ++w) at(w).flush();
  for (int k = 0; k < steps; ++k) {
    report = {};
    batches[batch]->flush();  // what joints that broke have changed
    batches[batch]->worlds().stepWorlds(report, paused);
    for (int w = first; w < first + size; ++w) {
      if (!paused.empty() && paused[static_cast<std::size_t>(w - first)]) continue;
      at(w).finishStep(report, report.broken, report.broken.size());
      report.brokenIn.resize(report.broken.size(), w);
    }
  }
  return report;
}

Worlds::Worlds(const WorldOptions& options) {
  validate(options);
  impl_ = std::make_unique<Impl>(options);
  Batch(makeEngine(impl_->options), options.params, impl_->family);  // throws if the options cannot be
}
Worlds::~Worlds() = default;
Worlds::Worlds(Worlds&&) noexcept = default;
Worlds& Worlds::operator=(Worlds&&) noexcept = default;

int Worlds::add(const Scene& scene) { return addCopies(scene, 1); }

int Worlds::addCopies(const Scene& scene, int count) {
  validate(scene);
  const int first = this->count();
  for (int k = 0; k < count; ++k) {
    auto world = std::make_unique<World::Impl>();
    const std::shared_ptr<Batch> batch = impl_->batchForNext();
    world->params = impl_->options.params;
    world->engine = std::make_unique<WorldSlice>(batch, batch->addWorld());
    world->doublePrecision = impl_->options.backend == "reference";
    world->wantsEvents = impl_->options.events, world->tasks = impl_->threads.tasks();
    world->cooked = impl_->cooked, world->inBatch = true;
    World::Impl& built = *world;
    impl_->worlds.push_back(World(std::move(world)));
    impl_->random.push_back(Impl::firstRandomState(impl_->seed, first + k));
    built.build(scene);
  }
  return first;
}

int Worlds::count() const { return impl_->count(); }

World& Worlds::operator[](int world) {
  impl_->requireWorld(world);
  return impl_->worlds[static_cast<std::size_t>(world)];
}
const World& Worlds::operator[](int world) const {
  impl_->requireWorld(world);
  return impl_->worlds[static_cast<std::size_t>(world)];
}

WorldsReport Worlds::step(int steps) { return step(steps, {}); }

WorldsReport Worlds::step(int steps, std::span<const char> active) try {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  if (!active.empty() && static_cast<int>(active.size()) != count())
    throw Error("active", "one element per world, " + std::to_string(count()), std::to_string(active.size()));
  WorldsReport report;
  int left = steps;
  do {
    // up to the next scripted event of a world
    int stride = left;
    for (int w = 0; w < count(); ++w) {
      if (!active.empty() && !active[static_cast<std::size_t>(w)]) continue;
      const World::Impl& own = impl_->at(w);
      if (own.stepsToEvent() <= 0) (*this)[w].runEvents();
      stride = static_cast<int>(std::min<std::int64_t>(stride, own.stepsToEvent()));
    }
    std::vector<WorldsReport> reports(impl_->batches.size());
    impl_->forEachBatch([&](std::size_t k) { reports[k] = impl_->step(k, stride, active); });
    report = {};
    for (const WorldsReport& each : reports) accumulate(report, each);
    left -= stride;
  } while (left > 0);
  report.totalMs = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  if (const LogSink& log = impl_->options.log) {
    for (int w = 0; w < count(); ++w) impl_->idle.add(impl_->at(w).idle);
    logStep(report, "a step of " + std::to_string(count()) + " worlds", log);
    impl_->idle.write(log);
  }
  return report;
} catch (const std::bad_alloc&) {
  throw Error("step", "memory for the tables that it needs", "none left");
}

void Worlds::reset(std::span<const int> worlds, std::span<const Snapshot> snapshots) {
  if (snapshots.size() != 1 && snapshots.size() != worlds.size())
    throw Error("snapshots", "one, or as many as worlds, " + std::to_string(worlds.size()),
                std::to_string(snapshots.size()));
  impl_->requireDistinct(worlds);
  struct Changes {
    std::vector<int> worlds;  ///< in their batch
    std::vector<const WorldSnapshot*> states;
  };
  std::vector<Changes> changes(impl_->batches.size());
  const auto snapshotOf = [&](std::size_t k) -> const Snapshot& {
    return snapshots[snapshots.size() == 1 ? 0 : k];
  };
  for (std::size_t k = 0; k < worlds.size(); ++k) {
    const Snapshot& snapshot = snapshotOf(k);
    if (!snapshot.data) throw Error("snapshots", "those made by World::snapshot", "an empty one");
    Changes& own = changes[static_cast<std::size_t>(worlds[k] / impl_->perBatch)];
    own.worlds.push_back(worlds[k] % impl_->perBatch);
    own.states.push_back(&impl_->batchOf(worlds[k]).own(*snapshot.data->engine));
  }
  for (std::size_t k = 0; k < worlds.size(); ++k) {
    Registry registry = snapshotOf(k).data->registry;
    impl_->at(worlds[k]).restoreRecords(std::move(registry), snapshotOf(k).data->params);
    RandomState& random = impl_->random[static_cast<std::size_t>(worlds[k])];
    ++random.episode, random.drawn = 0;
  }
  impl_->forEachBatch([&](std::size_t k) {
    if (!changes[k].worlds.empty()) impl_->batches[k]->restore(changes[k].worlds, changes[k].states);
  });
}

const Params& Worlds::params() const { return impl_->options.params; }

void Worlds::setParams(const Params& params) {
  validate(params);
  for (const std::shared_ptr<Batch>& batch : impl_->batches) batch->setParams(params);
  impl_->options.params = params;
  for (int w = 0; w < count(); ++w) impl_->at(w).params = params;
}

std::size_t Worlds::memoryBytes() const {
  std::size_t sum = 0;
  for (const std::shared_ptr<Batch>& batch : impl_->batches) sum += batch->engine().memoryBytes();
  return sum;
}

}  // namespace rubble
