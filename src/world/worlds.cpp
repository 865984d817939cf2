#include <rubble/worlds.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <deque>
#include <limits>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "world/batch.h"
#include "world/world_impl.h"

namespace rubble {

namespace {

/// Worlds of one engine. On a CPU they step in the caches of one core; a device steps all of them at once.
int worldsPerEngine(const std::string& backend) {
  constexpr int kOnCpu = 32;
  return backend == "cuda" || backend == "lockstep-cuda" ? std::numeric_limits<int>::max() : kOnCpu;
}

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
  for (const StageTime& stage : from.stages) {
    const auto found = std::ranges::find(to.stages, stage.name, &StageTime::name);
    if (found == to.stages.end())
      to.stages.push_back(stage);
    else
      found->ms += stage.ms;
  }
}

}  // namespace

struct Worlds::Impl {
  explicit Impl(const WorldOptions& given)
      : options(given),
        perBatch(worldsPerEngine(given.backend)),
        arena(given.threads > 0 ? given.threads : tbb::task_arena::automatic) {
    options.threads = 1;
  }

  WorldOptions options;
  int perBatch;  ///< most worlds of a batch
  tbb::task_arena arena;
  std::vector<std::shared_ptr<Batch>> batches;
  std::deque<World> worlds;  ///< references stay valid
  std::shared_ptr<std::vector<CookedEntry>> cooked = std::make_shared<std::vector<CookedEntry>>();
  std::shared_ptr<const int> family = std::make_shared<const int>();
  std::vector<std::byte> arrays[static_cast<int>(StateArray::Torque) + 1];  ///< of all batches

  int count() const { return static_cast<int>(worlds.size()); }
  void requireWorld(int world) const {
    if (world < 0 || world >= count())
      throw Error("world", "a number below " + std::to_string(count()), std::to_string(world));
  }
  Batch& batchOf(int world) { return *batches[static_cast<std::size_t>(world / perBatch)]; }
  World::Impl& at(int world) { return *worlds[static_cast<std::size_t>(world)].impl_; }
  /// f(k) for each of the batches, in parallel.
  template <class F> void forEachBatch(F&& f) {
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, batches.size(), f, tbb::simple_partitioner{}); });
  }
  /// Sends edits of the worlds of a batch to its engine.
  void flush(std::size_t batch) {
    const int first = static_cast<int>(batch) * perBatch;
    for (int w = first; w < first + batches[batch]->count(); ++w) at(w).flush();
    batches[batch]->flush();
  }
  std::shared_ptr<Batch> batchForNext() {
    if (count() % perBatch == 0)
      batches.push_back(std::make_shared<Batch>(makeEngine(options), options.params, family));
    return batches.back();
  }
  /// Steps of the worlds of a batch that are active; no world: all are.
  WorldsReport step(std::size_t batch, int steps, std::span<const char> active) {
    const int first = static_cast<int>(batch) * perBatch, size = batches[batch]->count();
    std::vector<char> paused;
    if (!active.empty())
      for (int w = first; w < first + size; ++w) paused.push_back(active[static_cast<std::size_t>(w)] == 0);
    const auto isPaused = [](char each) { return each != 0; };
    WorldsReport report;
    if (!paused.empty() && std::ranges::all_of(paused, isPaused)) return report;
    if (std::ranges::none_of(paused, isPaused)) paused.clear();
    for (int k = 0; k < steps; ++k) {
      flush(batch);
      report = {};
      batches[batch]->worlds().stepWorlds(report, paused);
      for (int w = first; w < first + size; ++w) {
        if (!paused.empty() && paused[static_cast<std::size_t>(w - first)]) continue;
        StepReport own;
        own.brokenJoints = report.brokenJoints;
        at(w).finishStep(own);
        report.broken.insert(report.broken.end(), own.broken.begin(), own.broken.end());
        report.brokenIn.resize(report.broken.size(), w);
      }
    }
    return report;
  }
};

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
    world->wantsEvents = impl_->options.events;
    world->cooked = impl_->cooked, world->inBatch = true;
    World::Impl& built = *world;
    impl_->worlds.push_back(World(std::move(world)));
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
  std::vector<WorldsReport> reports(impl_->batches.size());
  impl_->forEachBatch([&](std::size_t k) { reports[k] = impl_->step(k, steps, active); });
  WorldsReport report;
  for (const WorldsReport& each : reports) accumulate(report, each);
  report.totalMs = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  return report;
} catch (const std::bad_alloc&) {
  throw Error("step", "memory for the tables that it needs", "none left");
}

void Worlds::reset(std::span<const int> worlds, std::span<const Snapshot> snapshots) {
  if (snapshots.size() != 1 && snapshots.size() != worlds.size())
    throw Error("snapshots", "one, or as many as worlds, " + std::to_string(worlds.size()),
                std::to_string(snapshots.size()));
  std::vector<int> sorted(worlds.begin(), worlds.end());
  std::ranges::sort(sorted);
  if (std::ranges::adjacent_find(sorted) != sorted.end())
    throw Error("worlds", "each world once", "one of them twice");
  struct Changes {
    std::vector<int> worlds;  ///< in their batch
    std::vector<const WorldSnapshot*> states;
  };
  std::vector<Changes> changes(impl_->batches.size());
  const auto snapshotOf = [&](std::size_t k) -> const Snapshot& {
    return snapshots[snapshots.size() == 1 ? 0 : k];
  };
  for (std::size_t k = 0; k < worlds.size(); ++k) {
    impl_->requireWorld(worlds[k]);
    const Snapshot& snapshot = snapshotOf(k);
    if (!snapshot.data) throw Error("snapshots", "those made by World::snapshot", "an empty one");
    Changes& own = changes[static_cast<std::size_t>(worlds[k] / impl_->perBatch)];
    own.worlds.push_back(worlds[k] % impl_->perBatch);
    own.states.push_back(&impl_->batchOf(worlds[k]).own(*snapshot.data->engine));
  }
  for (std::size_t k = 0; k < worlds.size(); ++k) {
    Registry registry = snapshotOf(k).data->registry;
    impl_->at(worlds[k]).restoreRecords(std::move(registry), snapshotOf(k).data->params);
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

int Worlds::firstRow(int world) const {
  impl_->requireWorld(world);
  int rows = 0;
  for (int k = 0; k < world / impl_->perBatch; ++k)
    rows += impl_->batches[static_cast<std::size_t>(k)]->rows();
  const std::vector<int>& own = impl_->batchOf(world).rowsOf(world % impl_->perBatch);
  return own.empty() ? rows : rows + own.front();
}

ArrayView Worlds::array(StateArray which) const {
  std::vector<ArrayView> views(impl_->batches.size());
  impl_->forEachBatch([&](std::size_t k) {
    impl_->flush(k);
    views[k] = impl_->batches[k]->engine().array(which);
  });
  if (!views.empty() && views.front().device) return views.front();
  ArrayView all;
  std::vector<std::byte>& bytes = impl_->arrays[static_cast<int>(which)];
  bytes.clear();
  for (const ArrayView& view : views) {
    const auto* from = static_cast<const std::byte*>(view.data);
    bytes.insert(bytes.end(), from, from + view.shape[0] * view.strides[0]);
    const std::int64_t rows = all.shape[0] + view.shape[0];
    all = view;
    all.shape[0] = rows;
  }
  all.data = bytes.data();
  return all;
}

std::vector<int> Worlds::rowsOf(int world) const {
  const int first = firstRow(world);
  std::vector<int> rows = impl_->batchOf(world).rowsOf(world % impl_->perBatch);
  const int shift = rows.empty() ? 0 : first - rows.front();
  for (int& row : rows) row += shift;
  return rows;
}

void Worlds::scatter(StateArray which, const ArrayView& rows, const ArrayView& values) {
  checkScatter(which, rows, values);
  if (rows.shape[0] == 0 || impl_->batches.empty()) return;
  if (values.device && !impl_->batches[0]->engine().poseCopies())
    throw Error("values", "host memory", "memory of a device");
  if (impl_->batches.size() == 1) {
    impl_->flush(0);
    return impl_->batches[0]->engine().scatter(which, rows, values);
  }
  std::vector<int> begin{0};  // first row of each batch
  for (const std::shared_ptr<Batch>& batch : impl_->batches) begin.push_back(begin.back() + batch->rows());
  struct Part {
    std::vector<int> rows;
    std::vector<std::int64_t> from;  ///< rows of `values`
  };
  std::vector<Part> parts(impl_->batches.size());
  for (std::int64_t k = 0; k < rows.shape[0]; ++k) {
    int row;
    std::memcpy(&row, static_cast<const std::byte*>(rows.data) + k * rows.strides[0], sizeof row);
    if (row < 0 || row >= begin.back()) continue;
    const auto batch = static_cast<std::size_t>(std::ranges::upper_bound(begin, row) - begin.begin() - 1);
    parts[batch].rows.push_back(row - begin[batch]), parts[batch].from.push_back(k);
  }
  impl_->forEachBatch([&](std::size_t k) {
    if (parts[k].rows.empty()) return;
    impl_->flush(k);
    const auto n = static_cast<std::int64_t>(parts[k].rows.size());
    const auto row = static_cast<std::size_t>(values.strides[1] * values.shape[1]);
    std::vector<std::byte> own(static_cast<std::size_t>(n) * row);
    for (std::int64_t i = 0; i < n; ++i)
      std::memcpy(own.data() + static_cast<std::size_t>(i) * row,
                  static_cast<const std::byte*>(values.data) +
                      parts[k].from[static_cast<std::size_t>(i)] * values.strides[0],
                  row);
    ArrayView ownRows = rows, ownValues = values;
    ownRows.data = parts[k].rows.data(), ownRows.strides[0] = sizeof(int);
    ownValues.data = own.data(), ownValues.strides[0] = static_cast<std::int64_t>(row);
    ownRows.shape[0] = ownValues.shape[0] = n;
    impl_->batches[k]->engine().scatter(which, ownRows, ownValues);
  });
}

std::size_t Worlds::memoryBytes() const {
  std::size_t sum = 0;
  for (const std::shared_ptr<Batch>& batch : impl_->batches) sum += batch->engine().memoryBytes();
  return sum;
}

}  // namespace rubble
