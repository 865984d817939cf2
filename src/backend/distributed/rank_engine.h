#pragma once
/// One rank of a distributed world: a CPU engine whose step is divided, and its end of the transport. All
/// ranks make the same calls in the same order.
#include "backend/cpu/cpu_engine.h"
#include "backend/distributed/rank_division.h"

namespace rubble::RUBBLE_CORE {

class RankEngine final : public ObservableEngine {
 public:
  RankEngine(std::unique_ptr<Transport> transport, const RankOptions& options, int threads, bool timings)
      : cpu_(threads, timings),
        transport_(std::move(transport)),
        division_(cpu_.tables(), *transport_, options) {
    cpu_.divide(&division_);
  }

  void configure(const EngineSettings& settings) override { cpu_.configure(settings); }
  void apply(std::span<const Edit> edits) override {
    guarded([&] { cpu_.apply(edits); });
  }
  void step(StepReport& report) override;
  void sortBodies() override {
    gatherState();
    // every rank sorts all of it
    cpu_.divide(nullptr);
    guarded([&] { cpu_.sortBodies(); });
    cpu_.divide(&division_);
    division_.restart();
  }
  /// State of bodies and vertices is on every rank. Anything else is gathered by all ranks together.
  const TableReader& read(Fetch what, int id) override {
    if (what == Fetch::All) gatherState();
    return cpu_.read(what, id);
  }
  std::span<EngineQuery> queryRoom(std::size_t n) override { return cpu_.queryRoom(n); }
  std::span<const EngineHit> hits(const EngineQueries& asked) override { return cpu_.hits(asked); }
  EngineOverlaps overlaps(const EngineQueries& asked) override { return cpu_.overlaps(asked); }
  EngineAllHits allHits(const EngineQueries& asked) override { return cpu_.allHits(asked); }
  ArrayView array(StateArray which) override { return cpu_.array(which); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    guarded([&] { cpu_.scatter(which, rows, values); });
  }
  // joints and contact forces are those of all ranks
  void setJointRows(const JointRows& rows) override { cpu_.setJointRows(rows); }
  ArrayView array(JointArray which) override {
    gatherState();
    return cpu_.array(which);
  }
  ArrayView array(SensorArray which) override {
    gatherState();
    return cpu_.array(which);
  }
  ArrayView contactForces(std::span<const std::array<int, 2>> pairs) override {
    gatherState();
    return cpu_.contactForces(pairs);
  }
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values) override {
    guarded([&] { cpu_.scatter(which, rows, values); });
  }
  bool reserve(const std::string& kind, int count) override { return cpu_.reserve(kind, count); }
  std::size_t memoryBytes() const override { return cpu_.memoryBytes(); }
  std::vector<TableHash> tableHashes() override {
    gatherState();
    return cpu_.tableHashes();
  }
  std::shared_ptr<const EngineSnapshot> snapshot() override {
    gatherState();
    return cpu_.snapshot();
  }
  void restore(const EngineSnapshot& snapshot) override {
    guarded([&] { cpu_.restore(snapshot); });
    division_.restart();
  }
  void observe(KernelObserver observer) override { cpu_.observe(std::move(observer)); }
  const HostTables& tablesNow() override { return cpu_.tablesNow(); }

  int rank() const { return transport_->rank(); }
  /// Gathers what only owners have: contacts and multipliers. Every rank calls it.
  void gatherState() {
    guarded([&] { division_.gatherState(); });
  }
  /// Tells the other ranks that this one cannot go on.
  void fail(const std::string& why) noexcept { transport_->fail(why); }

 private:
  /// Other ranks must not wait for one that has failed.
  template <class F> void guarded(F&& f) try { f(); } catch (const std::exception& error) {
    transport_->fail(error.what());
    throw;
  }

  CpuEngine cpu_;
  std::unique_ptr<Transport> transport_;
  RankDivision division_;
};

}  // namespace rubble::RUBBLE_CORE
