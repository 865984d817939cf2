#pragma once
/// All ranks of a world in this process, each with a thread of its own. What ranks tell one another goes
/// through a transport.
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "backend/distributed/rank_engine.h"
#include "backend/distributed/thread_transport.h"

namespace rubble::RUBBLE_CORE {

/// A thread for each rank, which may wait for the others and run loops on threads of its own. That of rank 0
/// is the calling one.
class RankThreads {
 public:
  explicit RankThreads(int ranks);
  ~RankThreads();
  RankThreads(const RankThreads&) = delete;
  RankThreads& operator=(const RankThreads&) = delete;
  /// Calls task(r) for all ranks at once, and returns when all are done. The task throws nothing.
  void run(const std::function<void(int)>& task);

 private:
  void work(int rank);

  std::mutex mutex_;
  std::condition_variable begins_, ends_;
  const std::function<void(int)>* task_ = nullptr;
  unsigned runs_ = 0;  ///< calls of run()
  int left_ = 0;       ///< other ranks that have not ended this one
  bool stops_ = false;
  std::vector<std::thread> threads_;
};

/// Reads are of rank 0.
class RankTeam final : public Engine {
 public:
  /// Makes the engine of a rank, in the thread of the rank.
  using Maker = std::function<std::unique_ptr<DividedEngine>(Transport&)>;
  RankTeam(const RankOptions& options, const Maker& make);
  /// Ranks on the CPU. `cpu.threads`: of all ranks together; 0: one per core.
  RankTeam(const RankOptions& options, const CpuOptions& cpu);

  void configure(const EngineSettings& settings) override {
    each([&](Engine& e) { e.configure(settings); });
  }
  void apply(std::span<const Edit> edits) override {
    together([&](Engine& e) { e.apply(edits); });
    edited_ = true;
  }
  void step(StepReport& report) override;
  void sortBodies() override {
    together([](Engine& e) { e.sortBodies(); });
  }
  const TableReader& read(Fetch what, int id) override {
    if (what == Fetch::All) gatherState();
    return first([&](RankEngine& e) -> const TableReader& { return e.read(what, id); });
  }
  std::span<EngineQuery> queryRoom(std::size_t n) override {
    return first([&](RankEngine& e) { return e.queryRoom(n); });
  }
  std::span<const EngineHit> hits(const EngineQueries& asked) override {
    return first([&](RankEngine& e) { return e.hits(asked); });
  }
  EngineOverlaps overlaps(const EngineQueries& asked) override {
    return first([&](RankEngine& e) { return e.overlaps(asked); });
  }
  EngineAllHits allHits(const EngineQueries& asked) override {
    return first([&](RankEngine& e) { return e.allHits(asked); });
  }
  RayHitArrays castRays(const EngineRays& rays) override {
    return first([&](RankEngine& e) { return e.castRays(rays); });
  }
  ArrayView array(StateArray which) override {
    return first([&](RankEngine& e) { return e.array(which); });
  }
  ArrayView array(VertexArray which) override {
    return first([&](RankEngine& e) { return e.array(which); });
  }
  DeviceArrays* deviceArrays() override { return ranks_.front()->deviceArrays(); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    each([&](Engine& e) { e.scatter(which, rows, values); });
  }
  void setJointRows(const JointRows& rows) override {
    each([&](Engine& e) { e.setJointRows(rows); });
  }
  ArrayView array(JointArray which) override {
    gatherState();
    return first([&](RankEngine& e) { return e.array(which); });
  }
  ArrayView array(SensorArray which) override {
    gatherState();
    return first([&](RankEngine& e) { return e.array(which); });
  }
  ArrayView contactForces(std::span<const std::array<int, 2>> pairs) override {
    gatherState();
    return first([&](RankEngine& e) { return e.contactForces(pairs); });
  }
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values) override {
    each([&](Engine& e) { e.scatter(which, rows, values); });
  }
  bool reserve(const std::string& kind, int count) override {
    bool known = true;
    each([&](Engine& e) { known = e.reserve(kind, count); });
    return known;
  }
  std::size_t memoryBytes() const override {
    std::size_t sum = 0;
    for (const auto& rank : ranks_) sum += rank->memoryBytes();
    return sum;
  }
  std::vector<TableHash> tableHashes() override {
    gatherState();
    return first([&](RankEngine& e) { return e.tableHashes(); });
  }
  std::shared_ptr<const EngineSnapshot> snapshot() override {
    gatherState();
    return first([&](RankEngine& e) { return e.snapshot(); });
  }
  void restore(const EngineSnapshot& snapshot) override {
    together([&](Engine& e) { e.restore(snapshot); });
  }

  RankEngine& rank(int r) { return *ranks_[static_cast<std::size_t>(r)]; }

 private:
  /// A call of a rank, by the calling thread.
  template <class F> static std::invoke_result_t<F&, RankEngine&> callOf(RankEngine& rank, F&& f) {
    struct Scope {
      DividedEngine& divided;
      int before = divided.enter();
      ~Scope() { divided.leave(before); }
    } const scope{rank.divided()};
    return f(rank);
  }
  /// Tables of all ranks grow by the same edits, also where only the first one is asked.
  template <class F> std::invoke_result_t<F&, RankEngine&> first(F&& f) {
    if (std::exchange(edited_, false)) each([](RankEngine& e) { e.divided().settle(); });
    return callOf(*ranks_.front(), f);
  }
  void gatherState() {
    if (!std::exchange(whole_, true)) together([](RankEngine& e) { e.gatherState(); });
  }
  /// For each rank, one after another: calls without exchanges.
  template <class F> void each(F&& f) {
    requireWhole();
    for (const auto& rank : ranks_) callOf(*rank, f);
  }
  /// For all ranks at once, each in a thread of its own.
  void together(const std::function<void(RankEngine&)>& f);
  /// Throws RankFailure if a rank has failed.
  void requireWhole() const;

  bool whole_ = false;   ///< rank 0 has the state of all since the last step
  bool edited_ = false;  ///< there were edits for which tables may lack room
  ThreadHub hub_;
  std::vector<std::unique_ptr<RankEngine>> ranks_;
  RankThreads threads_;
};

}  // namespace rubble::RUBBLE_CORE
