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
  if (to.difference.empty()) to.difference = from.difference;
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

Worlds::Impl::Taken Worlds::Impl::step(std::size_t batch, int steps, std::span<const char> active) {
  const int first = static_cast<int>(batch) * perBatch, size = batches[batch]->count();
  std::vector<char> paused;
  if (!active.empty())
    for (int w = first; w < first + size; ++w) paused.push_back(active[static_cast<std::size_t>(w)] == 0);
  const auto isPaused = [](char each) { return each != 0; };
  Taken taken;
  if (!paused.empty() && std::ranges::all_of(paused, isPaused)) return taken;
  if (std::ranges::none_of(paused, isPaused)) paused.clear();
  const auto isActive = [&](int w) { return paused.empty() || !paused[static_cast<std::size_t>(w - first)]; };
  // each visit of thousands of worlds misses the caches
  const auto forEachActive = [&](auto&& f) {
    for (int w = first; w < first + size; ++w)
      if (isActive(w)) f(at(w));
  };
  for (int w = first; w < first + size; ++w) {
    at(w).flush();
    if (isActive(w)) at(w).findUnlistedBreaks();
  }
  int done = 0, counted = 0;
  const auto count = [&](const StepReport& last) {
    forEachActive([&](World::Impl& world) {
      world.countSteps(done - counted, last, done > 1);
      taken.breaks |= !world.broken.empty();
    });
    counted = done;
  };
  const Undo countRest([&] {
    if (counted < done) count({});
  });
  while (done < steps) {
    WorldsReport& report = taken.report = {};
    batches[batch]->flush();  // what joints that broke have changed
    const auto finish = [&](bool isLast) {
      ++done;
      const bool tells = options.events || report.brokenJoints > 0 || !report.difference.empty();
      // all have taken the step before any of them reports it
      if (tells || isLast) count(report);
      if (!tells) return;
      forEachActive([&](World::Impl& world) {
        world.finishStep(report);
        taken.breaks |= !world.broken.empty();
      });
    };
    try {
      batches[batch]->worlds().stepWorlds(report, paused);
    } catch (const LostPausedContacts&) {
      finish(true);
      throw;
    }
    finish(done + 1 == steps);
  }
  return taken;
}

Worlds::Worlds(const WorldOptions& options) try {
  validate(options);
  impl_ = std::make_unique<Impl>(options);
  Batch(makeEngine(impl_->options), options.params, impl_->family);  // throws if the options cannot be
} catch (const std::bad_alloc&) {
  throw OutOfMemory("Worlds");
}
Worlds::~Worlds() = default;
Worlds::Worlds(Worlds&&) noexcept = default;
Worlds& Worlds::operator=(Worlds&&) noexcept = default;

int Worlds::add(const Scene& scene) { return addCopies(scene, 1); }

int Worlds::addCopies(const Scene& scene, int count) {
  return withMemory("addCopies", [&] {
    validate(scene);
    const int first = this->count();
    Undo drop([&] { impl_->dropWorlds(first); });
    for (int k = 0; k < count; ++k) impl_->addWorld().build(scene);
    drop.keep();
    return first;
  });
}

World::Impl& Worlds::Impl::addWorld() {
  auto world = std::make_unique<World::Impl>();
  const std::shared_ptr<Batch> batch = batchForNext();
  world->params = options.params;
  world->doublePrecision = options.backend == "reference";
  world->wantsEvents = options.events, world->tasks = threads.tasks();
  world->cooked = cooked, world->inBatch = true;
  auto slice = std::make_unique<WorldSlice>(batch, batch->count());
  World::Impl& out = *world;
  reserveMore(random, 1);
  worlds.push_back(World(std::move(world)));
  Undo drop([&] { worlds.pop_back(); });
  batch->addWorld();
  out.engine = std::move(slice);
  random.push_back(firstRandomState(seed, count() - 1));
  drop.keep();
  return out;
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

WorldsReport Worlds::step(int steps, std::span<const char> active) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  if (!active.empty() && static_cast<int>(active.size()) != count())
    throw Error("active", "one element per world, " + std::to_string(count()), std::to_string(active.size()));
  return withMemory("step", [&] {
    WorldsReport report;
    bool breaks = false;
    int left = steps;
    do {
      // up to the next scripted event of a world
      int stride = left;
      for (int w = 0; w < count(); ++w) {
        if (!active.empty() && !active[static_cast<std::size_t>(w)]) continue;
        World::Impl& own = impl_->at(w);
        if (left < steps) own.broken.clear();
        if (own.stepsToEvent() <= 0) (*this)[w].runEvents();
        stride = static_cast<int>(std::min<std::int64_t>(stride, own.stepsToEvent()));
      }
      std::vector<Impl::Taken> taken(impl_->batches.size());
      impl_->forEachBatch([&](std::size_t k) { taken[k] = impl_->step(k, stride, active); });
      report = {}, breaks = false;
      for (const Impl::Taken& each : taken) accumulate(report, each.report), breaks |= each.breaks;
      left -= stride;
    } while (left > 0);
    if (breaks) impl_->listBreaks(report, active);
    report.totalMs = std::chrono::duration<double, std::milli>(Clock::now() - begin).count() /
                     std::max(steps, 1);
    if (const LogSink& log = impl_->options.log) {
      for (int w = 0; w < count(); ++w) impl_->idle.add(impl_->at(w).idle);
      logStep(report, "a step of " + std::to_string(count()) + " worlds", log);
      impl_->idle.write(log);
    }
    for (int w = 0; breaks && w < count(); ++w)
      if (active.empty() || active[static_cast<std::size_t>(w)]) impl_->at(w).broken.clear();
    return report;
  });
}

void Worlds::Impl::listBreaks(WorldsReport& report, std::span<const char> active) {
  std::size_t all = 0;
  for (int w = 0; w < count(); ++w) all += at(w).broken.size();
  report.broken.reserve(all), report.brokenIn.reserve(all);
  for (int w = 0; w < count(); ++w) {
    if (!active.empty() && !active[static_cast<std::size_t>(w)]) continue;
    const std::vector<JointId>& own = at(w).broken;
    report.broken.insert(report.broken.end(), own.begin(), own.end());
    report.brokenIn.resize(report.broken.size(), w);
  }
}

void Worlds::reset(std::span<const int> worlds, std::span<const Snapshot> snapshots) {
  if (snapshots.size() != 1 && snapshots.size() != worlds.size())
    throw Error("snapshots", "one, or as many as worlds, " + std::to_string(worlds.size()),
                std::to_string(snapshots.size()));
  withMemory("reset", [&] { impl_->reset(worlds, snapshots); });
}

void Worlds::Impl::reset(std::span<const int> list, std::span<const Snapshot> snapshots) {
  requireDistinct(list);
  struct Changes {
    std::vector<int> worlds;  ///< in their batch
    std::vector<const WorldSnapshot*> states;
  };
  std::vector<Changes> changes(batches.size());
  std::vector<Registry> registries;
  const auto snapshotOf = [&](std::size_t k) -> const Snapshot& {
    return snapshots[snapshots.size() == 1 ? 0 : k];
  };
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Snapshot& snapshot = snapshotOf(k);
    if (!snapshot.data) throw Error("snapshots", "those made by World::snapshot", "an empty one");
    Changes& own = changes[static_cast<std::size_t>(list[k] / perBatch)];
    own.worlds.push_back(list[k] % perBatch);
    own.states.push_back(&batchOf(list[k]).own(*snapshot.data->engine));
    registries.push_back(snapshot.data->registry);
  }
  // all of them, before any world changes
  std::vector<std::unique_ptr<Batch::Restoring>> ready(batches.size());
  forEachBatch([&](std::size_t k) {
    if (!changes[k].worlds.empty())
      ready[k] = batches[k]->prepareToRestore(changes[k].worlds, changes[k].states);
  });
  forEachBatch([&](std::size_t k) {
    if (ready[k]) ready[k]->commit();
  });
  for (std::size_t k = 0; k < list.size(); ++k) {
    at(list[k]).restoreRecords(std::move(registries[k]), snapshotOf(k).data->params);
    RandomState& drawn = random[static_cast<std::size_t>(list[k])];
    ++drawn.episode, drawn.drawn = 0;
  }
}

const Params& Worlds::params() const { return impl_->options.params; }

void Worlds::setParams(const Params& params) {
  validate(params);
  for (const std::shared_ptr<Batch>& batch : impl_->batches)
    withMemory("setParams", [&] { batch->setParams(params); });
  impl_->options.params = params;
  for (int w = 0; w < count(); ++w) impl_->at(w).params = params;
}

std::size_t Worlds::memoryBytes() const {
  std::size_t sum = 0;
  for (const std::shared_ptr<Batch>& batch : impl_->batches) sum += batch->engine().memoryBytes();
  return sum;
}

}  // namespace rubble
