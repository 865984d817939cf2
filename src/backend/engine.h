#pragma once
/// Interface between a World and a backend, independent of the solver precision.
#include <functional>
#include <new>
#include <string>

#include <rubble/ranks.h>

#include "collision/ray_arrays.h"
#include "tables/edits.h"
#include "tables/reader.h"

namespace rubble {

/// State of an engine. Engines of other types accept it as bytes.
class EngineSnapshot {
 public:
  virtual ~EngineSnapshot() = default;
  virtual std::vector<std::byte> bytes() const = 0;
};

/// State of an engine on the host.
class SavedState final : public EngineSnapshot {
 public:
  explicit SavedState(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}
  std::vector<std::byte> bytes() const override { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

/// Asynchronous copies of poses from a device to the host; see World::beginPoses.
class PoseCopies {
 public:
  virtual ~PoseCopies() = default;
  /// Copies into buffer 0 or 1, which no reader uses.
  virtual void begin(int buffer) = 0;
  virtual bool ready(int buffer) const = 0;
  virtual void wait(int buffer) = 0;
  virtual ArrayView position(int buffer) const = 0;
  virtual ArrayView orientation(int buffer) const = 0;
};

class DeviceArrays;

/// What a caller is going to read: nothing but the state of one body, vertices, or anything.
enum class Fetch { Body, Vertices, All };

/// The step is complete. There was no memory to keep the contacts of paused worlds, which the next step finds
/// again.
class LostPausedContacts final : public std::bad_alloc {};

/// An engine of many worlds in one set of tables. Vertices, joints and elements are addressed as in the
/// tables.
class BatchEngine {
 public:
  virtual ~BatchEngine() = default;
  /// Gives the worlds their elements. Must follow edits that add any. `spare`: bodies of no world.
  virtual void setLayout(std::span<const WorldLayout> worlds, std::span<const int> spare) = 0;
  virtual const WorldSettings& settingsOf(int world) const = 0;
  virtual void setSettings(int world, const WorldSettings& settings) = 0;
  /// A step of the worlds that are not paused (1). No world: none is. May throw LostPausedContacts.
  virtual void stepWorlds(StepReport& report, std::span<const char> paused) = 0;
  /// Reads one world in its own numbers.
  virtual const TableReader& readWorld(int world) = 0;
  /// The state of a world, without its settings.
  virtual std::vector<std::byte> takeWorld(int world) = 0;
  /// Replaces the states of these worlds, in ascending order. They have the elements that the states have.
  virtual void putWorlds(std::span<const int> worlds, std::span<const std::span<const std::byte>> states) = 0;
  /// Makes everything that putWorlds() needs memory for. The result puts the states, before any other call.
  /// On a host it throws nothing. The states must outlive it.
  virtual std::function<void()> prepareToPut(std::span<const int> worlds,
                                             std::span<const std::span<const std::byte>> states) {
    return [this, to = std::vector(worlds.begin(), worlds.end()),
            from = std::vector(states.begin(), states.end())] { putWorlds(to, from); };
  }
  /// A copy of all state. The result puts it back and throws nothing; setLayout() and the edits of rules and
  /// planes must follow. Empty: this engine has none.
  virtual std::function<void()> backup() { return {}; }
};

/// A backend. Bodies are addressed by id.
class Engine {
 public:
  virtual ~Engine() = default;

  virtual void configure(const EngineSettings& settings) = 0;
  /// Applies edits in their order: all of them or, with std::bad_alloc, none. A backend on a device
  /// may have applied the first ones.
  virtual void apply(std::span<const Edit> edits) = 0;
  void apply(const Edit& edit) { apply({&edit, 1}); }
  virtual void step(StepReport& report) = 0;
  /// Sorts the bodies in memory along a space-filling curve (stages/pairs/order.h).
  virtual void sortBodies() = 0;

  /// Null unless it can hold many worlds.
  virtual BatchEngine* batch() { return nullptr; }

  /// Up to date, with all edits, until the next other call. `id`: the body, for Fetch::Body.
  virtual const TableReader& read(Fetch what = Fetch::All, int id = -1) = 0;
  virtual BodyState bodyState(int id) { return read(Fetch::Body, id).state(id); }
  /// Memory for n queries that are asked next, where the engine reads them without another copy.
  virtual std::span<EngineQuery> queryRoom(std::size_t n) = 0;
  /// The first hit, or the nearest body, of each query. Valid until the next query.
  virtual std::span<const EngineHit> hits(const EngineQueries& asked) = 0;
  virtual EngineOverlaps overlaps(const EngineQueries& asked) = 0;
  /// First hits of rays in memory of the device, there. Checked, but for their numbers. Only with
  /// deviceArrays().
  virtual RayHitArrays castRays(const EngineRays& rays);
  /// The first hit of each part of each body, of rays, casts and overlaps, on the host.
  virtual EngineAllHits allHits(const EngineQueries& asked) = 0;

  /// Includes all edits.
  virtual ArrayView array(StateArray which) = 0;
  /// As World::scatter. Shapes and types are checked already, and the memory is accessible to this engine.
  virtual void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) = 0;
  /// Sets what the rows of the following arrays are. Bodies and joints that they name must exist.
  virtual void setJointRows(const JointRows& rows) = 0;
  virtual ArrayView array(JointArray which) = 0;
  virtual ArrayView array(SensorArray which) = 0;
  virtual ArrayView array(VertexArray which) = 0;
  /// Contact forces on the second body of each pair of ids.
  virtual ArrayView contactForces(std::span<const std::array<int, 2>> pairs) = 0;
  /// As World::scatter. Checked as above.
  virtual void scatter(JointArray which, const ArrayView& rows, const ArrayView& values) = 0;
  /// Null: array() is host memory.
  virtual DeviceArrays* deviceArrays() { return nullptr; }
  /// Null: array() is host memory.
  virtual PoseCopies* poseCopies() { return nullptr; }

  /// Reserves table memory for a counted kind. Returns false if the kind does not exist.
  virtual bool reserve(const std::string& kind, int count) = 0;
  virtual std::size_t memoryBytes() const = 0;
  virtual std::vector<TableHash> tableHashes() = 0;
  virtual std::shared_ptr<const EngineSnapshot> snapshot() = 0;
  virtual void restore(const EngineSnapshot& snapshot) = 0;
};

/// Hash of bytes, and of all state.
std::uint64_t hashOf(std::span<const std::byte> bytes);
std::uint64_t hashOf(Engine& engine);

/// Returns whether the CUDA backend is built and has a usable device.
bool cudaReady();
/// Options of an engine whose steps run on a GPU.
struct CudaOptions {
  bool timings = true;  ///< measure stage times
  int processors = 0;   ///< multiprocessors that kernels are laid out for, at most; 0: those of the device
};
/// Null unless cudaReady().
std::unique_ptr<Engine> makeCudaEngine(const CudaOptions& options);

namespace f32 {
class CpuExecutor;
}

/// Options of an engine whose steps run on a processor.
struct CpuOptions {
  int threads = 0;      ///< 0: one per core
  bool timings = true;  ///< measure stage times
  /// The step of the core in float, compiled for instructions that the processor has; null: as the core is.
  void (*variant)(f32::CpuExecutor&) = nullptr;
  TaskSystem tasks = {};     ///< run all loops, if given
  MemorySystem memory = {};  ///< of the tables
  /// Each loop takes its elements one by one, the last one first: results must not depend on their order.
  bool backward = false;
};

namespace f32 {
/// Hash of the names and element sizes of all kept arrays: states of equal layouts may be exchanged.
std::uint64_t tableLayout();
std::unique_ptr<Engine> makeCpuEngine(const CpuOptions& options);
/// Ranks as threads, or one rank of the processes that share the world.
std::unique_ptr<Engine> makeDistributedEngine(const RankOptions& ranks, const CpuOptions& options);
/// Two engines of this precision, compared after every kernel.
std::unique_ptr<Engine> makeLockstepEngine(std::unique_ptr<Engine> a, std::unique_ptr<Engine> b);
/// Declared in tables/soft_queries.h too.
std::vector<std::vector<EngineHit>> softHits(const EngineQueries& asked, const EngineSoftTargets& targets);
}  // namespace f32
namespace f64 {
/// Declared in tables/soft_queries.h too.
std::vector<std::vector<EngineHit>> softHits(const EngineQueries& asked, const EngineSoftTargets& targets);
std::uint64_t tableLayout();
std::unique_ptr<Engine> makeCpuEngine(const CpuOptions& options);
}  // namespace f64

}  // namespace rubble
