#include "backend/lockstep/lockstep_pair.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// One thread next to many threads. Reads are of the first executor.
class LockstepEngine final : public Engine {
 public:
  explicit LockstepEngine(int threads) : pair_(1, threads) {}

  void configure(const EngineSettings& settings) override {
    settings_ = settings;
    both([&](HostTables& t) { t.view().step->gravity = Vec3(settings.gravity); });
  }
  void apply(std::span<const Edit> edits) override {
    for (const Edit& edit : edits) both([&](HostTables& t) { RUBBLE_CORE::apply(t, edit); });
  }
  void step(StepReport& report) override {
    try {
      takeStep(report);
    } catch (const std::bad_alloc&) {
      both(abandonStep);
      throw;
    }
  }
  void sortBodies() override {
    both([&](HostTables& t) { beginStep(t.view(), settings_, previousDt_); });
    pair_.sortBodies();
  }
  const TableReader& read(Fetch, int) override { return reader_; }
  std::vector<EngineHit> query(std::span<const EngineQuery> queries) override {
    runQueries(pair_.b().tables(), queries);
    return runQueries(pair_.a().tables(), queries);
  }
  std::vector<std::vector<int>> overlaps(std::span<const EngineQuery> queries) override {
    runOverlaps(pair_.b().tables(), queries);
    return runOverlaps(pair_.a().tables(), queries);
  }
  /// Of the first executor: views are read-only.
  ArrayView array(StateArray which) override { return arrays_.view(which); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    both([&](HostTables& t) { scatterRows(t, which, rows, values); });
    arrays_.follow();
  }
  bool reserve(const std::string& kind, int count) override {
    bool known = false;
    both([&](HostTables& t) { known = reserveKind(t, kind, count); });
    return known;
  }
  std::size_t memoryBytes() const override { return 2 * pair_.a().tables().bytes(); }
  std::shared_ptr<const EngineSnapshot> snapshot() override {
    return std::make_shared<SavedState>(saveState(pair_.a().tables(), previousDt_));
  }
  void restore(const EngineSnapshot& snapshot) override {
    both([&](HostTables& t) { loadState(t, previousDt_, snapshot.bytes()); });
  }

 private:
  template <class F> void both(F&& f) { f(pair_.a().tables()), f(pair_.b().tables()); }

  void takeStep(StepReport& report) {
    both(planTrees);
    for (int k = 0; k < settings_.params.substeps; ++k) {
      both([&](HostTables& t) { beginStep(t.view(), settings_, previousDt_); });
      pair_.step(report.step);
      both([](HostTables& t) { t.view().rolledBefore = t.view().rolls; });
      previousDt_ = settings_.params.dt / settings_.params.substeps;
    }
    both(endForces);
    settings_.wakeAll = false;
    reportCounters(pair_.a().view(), report);
    report.difference = pair_.firstDifference();
    report.stages = pair_.a().takeTimes();
    pair_.b().takeTimes();
    report.grown = pair_.a().takeGrown();
    pair_.b().takeGrown();
    arrays_.follow();
  }

  LockstepPair pair_;
  HostReader reader_{pair_.a().tables()};
  HostArrays arrays_{pair_.a().tables()};
  EngineSettings settings_;
  double previousDt_ = 0;
};

}  // namespace

std::unique_ptr<Engine> makeLockstepEngine(int threads) { return std::make_unique<LockstepEngine>(threads); }

}  // namespace rubble::RUBBLE_CORE
