#pragma once
/// One rank of a distributed world: an engine whose step is divided, and its end of the transport. All ranks
/// make the same calls in the same order.
#include <memory>
#include <vector>

#include "backend/distributed/transport.h"
#include "backend/observable_engine.h"

namespace rubble::RUBBLE_CORE {

/// The engine of a rank.
class DividedEngine {
 public:
  virtual ~DividedEngine() = default;
  virtual ObservableEngine& engine() = 0;
  /// Binds the calling thread to the device of the rank; returns what leave() restores.
  virtual int enter() { return 0; }
  virtual void leave(int) {}
  /// Makes room for what was edited.
  virtual void settle() {}
  /// Gathers the state of all pairs and joints, which each rank has for its own bodies only. All ranks call
  /// it.
  virtual void gatherState() = 0;
  /// Sorts all bodies, as every rank does. The state is gathered.
  virtual void sortWhole() = 0;
  /// The tables were replaced. All ranks have the whole state.
  virtual void restart() = 0;
  /// Of the last step, by rank, without times and bytes.
  virtual std::vector<RankReport> reports() const = 0;
};

/// A CPU engine. The transport must outlive it.
std::unique_ptr<DividedEngine> makeCpuRank(Transport& transport, const RankOptions& options,
                                           const CpuOptions& cpu);

class RankEngine final : public ObservableEngine {
 public:
  RankEngine(std::unique_ptr<Transport> transport, std::unique_ptr<DividedEngine> divided)
      : transport_(std::move(transport)), divided_(std::move(divided)) {}

  void configure(const EngineSettings& settings) override { own().configure(settings); }
  void apply(std::span<const Edit> edits) override {
    guarded([&] { own().apply(edits); });
  }
  void step(StepReport& report) override;
  void sortBodies() override {
    gatherState();
    guarded([&] { divided_->sortWhole(); });
  }
  /// State of bodies and vertices is on every rank. Anything else is gathered by all ranks together.
  const TableReader& read(Fetch what, int id) override {
    if (what == Fetch::All) gatherState();
    return own().read(what, id);
  }
  std::span<EngineQuery> queryRoom(std::size_t n) override { return own().queryRoom(n); }
  std::span<const EngineHit> hits(const EngineQueries& asked) override { return own().hits(asked); }
  EngineOverlaps overlaps(const EngineQueries& asked) override { return own().overlaps(asked); }
  EngineAllHits allHits(const EngineQueries& asked) override { return own().allHits(asked); }
  RayHitArrays castRays(const EngineRays& rays) override { return own().castRays(rays); }
  ArrayView array(StateArray which) override { return own().array(which); }
  ArrayView array(VertexArray which) override { return own().array(which); }
  DeviceArrays* deviceArrays() override { return own().deviceArrays(); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    guarded([&] { own().scatter(which, rows, values); });
  }
  // joints and contact forces are those of all ranks
  void setJointRows(const JointRows& rows) override { own().setJointRows(rows); }
  ArrayView array(JointArray which) override {
    gatherState();
    return own().array(which);
  }
  ArrayView array(SensorArray which) override {
    gatherState();
    return own().array(which);
  }
  ArrayView contactForces(std::span<const std::array<int, 2>> pairs) override {
    gatherState();
    return own().contactForces(pairs);
  }
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values) override {
    guarded([&] { own().scatter(which, rows, values); });
  }
  bool reserve(const std::string& kind, int count) override { return own().reserve(kind, count); }
  std::size_t memoryBytes() const override { return divided_->engine().memoryBytes(); }
  std::vector<TableHash> tableHashes() override {
    gatherState();
    return own().tableHashes();
  }
  std::shared_ptr<const EngineSnapshot> snapshot() override {
    gatherState();
    return own().snapshot();
  }
  void restore(const EngineSnapshot& snapshot) override {
    guarded([&] { own().restore(snapshot); });
    divided_->restart();
  }
  void observe(KernelObserver observer) override { own().observe(std::move(observer)); }
  const HostTables& tablesNow() override { return own().tablesNow(); }

  int rank() const { return transport_->rank(); }
  /// Gathers what only owners have: contacts and multipliers. Every rank calls it.
  void gatherState() {
    guarded([&] { divided_->gatherState(); });
  }
  /// Tells the other ranks that this one cannot go on.
  void fail(const std::string& why) noexcept { transport_->fail(why); }
  DividedEngine& divided() { return *divided_; }

 private:
  ObservableEngine& own() { return divided_->engine(); }
  /// Other ranks must not wait for one that has failed.
  template <class F> void guarded(F&& f) try { f(); } catch (const std::exception& error) {
    transport_->fail(error.what());
    throw;
  }

  std::unique_ptr<Transport> transport_;
  std::unique_ptr<DividedEngine> divided_;
};

}  // namespace rubble::RUBBLE_CORE
