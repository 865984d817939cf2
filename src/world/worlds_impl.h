#pragma once
/// Batches of worlds, and the threads that step them.
#include <deque>
#include <limits>

#include <rubble/worlds.h>

#include "platform/threads.h"
#include "world/batch.h"
#include "world/world_impl.h"

namespace rubble {

/// Worlds of one engine. On a CPU they step in the caches of one core; a device steps all of them at once.
inline int worldsPerEngine(const std::string& backend) {
  constexpr int kOnCpu = 32;
  return runsOnDevice(backend) ? std::numeric_limits<int>::max() : kOnCpu;
}

/// The number of worlds from `first` on that `count` asks for; -1: all of them. Throws Error beyond the last.
inline int worldsFrom(int first, int count, int all) {
  if (first < 0 || first > all) throw Error("first", "0 to " + std::to_string(all), std::to_string(first));
  if (count == -1) return all - first;
  if (count < 0 || count > all - first)
    throw Error("count", "0 to " + std::to_string(all - first) + " worlds", std::to_string(count));
  return count;
}

struct Worlds::Impl {
  explicit Impl(const WorldOptions& given)
      : options(given), perBatch(worldsPerEngine(given.backend)), threads(given.threads, given.tasks) {
    options.threads = 1, options.tasks = {};
  }

  WorldOptions options;
  int perBatch;  ///< most worlds of a batch
  Threads threads;
  std::vector<std::shared_ptr<Batch>> batches;
  std::deque<World> worlds;  ///< references stay valid
  std::shared_ptr<CookedShapes> cooked = std::make_shared<CookedShapes>();
  std::shared_ptr<const int> family = std::make_shared<const int>();
  IdleCalls idle;
  std::uint64_t seed = 0;           ///< of worlds that are added
  std::vector<RandomState> random;  ///< of each world
  HostRayHits rayHits;
  // of all batches
  std::vector<std::byte> arrays[static_cast<int>(StateArray::Torque) + 1],
      axes[static_cast<int>(JointArray::AppliedForce) + 1],
      sensors[static_cast<int>(SensorArray::JointTorque) + 1],
      vertices[static_cast<int>(VertexArray::Velocity) + 1], pairForces;

  int count() const { return static_cast<int>(worlds.size()); }
  void requireWorld(int world) const {
    if (world < 0 || world >= count())
      throw Error("world", "a number below " + std::to_string(count()), std::to_string(world));
  }
  /// Throws Error unless all of them are there and differ.
  void requireDistinct(std::span<const int> some) const;
  /// Of a world that has drawn nothing.
  static RandomState firstRandomState(std::uint64_t seed, int world);
  Batch& batchOf(int world) { return *batches[static_cast<std::size_t>(world / perBatch)]; }
  static World::Impl& of(const World& world) { return *world.impl_; }
  World::Impl& at(int world) { return *worlds[static_cast<std::size_t>(world)].impl_; }
  /// f(k) for each of the batches, in parallel.
  template <class F> void forEachBatch(F&& f) {
    threads.run([&] { forEachTask(batches.size(), f); });
  }
  /// Sends edits of the worlds of a batch to its engine, and what the rows of its joint arrays are.
  void sendJointRows(std::size_t batch) {
    flush(batch);
    const int first = static_cast<int>(batch) * perBatch;
    for (int w = first; w < first + batches[batch]->count(); ++w) at(w).sendJointRows();
    batches[batch]->sendJointRows();
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
  /// What the last step of a batch has left to report.
  struct Taken {
    WorldsReport report;
    bool breaks = false;  ///< worlds have joints that broke and that no report has listed
  };
  /// Steps of the worlds of a batch that are active; no world: all are.
  Taken step(std::size_t batch, int steps, std::span<const char> active);
  /// Takes back the last worlds.
  void dropWorlds(int count) noexcept {
    const auto dropEmpty = [&] {
      while (!batches.empty() && batches.back()->count() == 0) batches.pop_back();
    };
    for (dropEmpty(); this->count() > count; dropEmpty()) batches.back()->dropWorld(), worlds.pop_back();
    random.erase(random.begin() + std::min<std::ptrdiff_t>(count, std::ssize(random)), random.end());
  }
  /// Adds a world without anything in it.
  World::Impl& addWorld();
  /// Gives a report the joints of the worlds that took part which no report has listed.
  void listBreaks(WorldsReport& report, std::span<const char> active);
  /// As Worlds::reset.
  void reset(std::span<const int> list, std::span<const Snapshot> snapshots);
  /// The arrays of all batches as one: gathered in `to` where there are several.
  ArrayView gather(auto which, std::vector<std::byte>& to);
  ArrayView contactForces(std::span<const std::array<int, 2>> rows);
  std::vector<RayHit> castRays(std::span<const WorldRay> rays);
  /// Writes to the rows of each batch. `begin`: [batches + 1] first row of each.
  void scatter(auto which, const std::vector<int>& begin, const ArrayView& rows, const ArrayView& values);
};

}  // namespace rubble
