#pragma once
/// Runs each step on two engines and compares all tables after each kernel. Reports the first stage, kernel,
/// table and element that differ.
#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "backend/observable_engine.h"
#include "stages/contacts/contacts.h"
#include "tables/clean_copy.h"

namespace rubble::RUBBLE_CORE {

/// Each engine runs the step in a thread of its own. The threads meet at the end of each kernel. Reads are of
/// the first engine.
class LockstepEngine final : public Engine, public BatchEngine {
 public:
  LockstepEngine(std::unique_ptr<ObservableEngine> a, std::unique_ptr<ObservableEngine> b)
      : a_{std::move(a)}, b_{std::move(b)} {}

  void configure(const EngineSettings& settings) override {
    both([&](Engine& e) { e.configure(settings); });
  }
  void apply(std::span<const Edit> edits) override {
    both([&](Engine& e) { e.apply(edits); });
  }
  void step(StepReport& report) override {
    stepBoth(report, [](Engine& e, StepReport& own) { e.step(own); });
  }
  void sortBodies() override {
    both([](Engine& e) { e.sortBodies(); });
  }
  const TableReader& read(Fetch what, int id) override { return a_.engine->read(what, id); }
  std::span<EngineQuery> queryRoom(std::size_t n) override { return a_.engine->queryRoom(n); }
  std::span<const EngineHit> hits(const EngineQueries& asked) override {
    b_.engine->hits(asked);
    return a_.engine->hits(asked);
  }
  EngineAllHits allHits(const EngineQueries& asked) override {
    b_.engine->allHits(asked);
    return a_.engine->allHits(asked);
  }
  RayHitArrays castRays(const EngineRays& rays) override { return a_.engine->castRays(rays); }
  EngineOverlaps overlaps(const EngineQueries& asked) override {
    b_.engine->overlaps(asked);
    return a_.engine->overlaps(asked);
  }
  ArrayView array(StateArray which) override { return a_.engine->array(which); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    both([&](Engine& e) { e.scatter(which, rows, values); });
  }
  void setJointRows(const JointRows& rows) override {
    both([&](Engine& e) { e.setJointRows(rows); });
  }
  ArrayView array(JointArray which) override { return a_.engine->array(which); }
  ArrayView array(SensorArray which) override { return a_.engine->array(which); }
  ArrayView array(VertexArray which) override { return a_.engine->array(which); }
  DeviceArrays* deviceArrays() override { return a_.engine->deviceArrays(); }
  ArrayView contactForces(std::span<const std::array<int, 2>> pairs) override {
    return a_.engine->contactForces(pairs);
  }
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values) override {
    both([&](Engine& e) { e.scatter(which, rows, values); });
  }
  bool reserve(const std::string& kind, int count) override {
    return b_.engine->reserve(kind, count) && a_.engine->reserve(kind, count);
  }
  std::size_t memoryBytes() const override { return a_.engine->memoryBytes() + b_.engine->memoryBytes(); }
  std::vector<TableHash> tableHashes() override { return a_.engine->tableHashes(); }
  std::shared_ptr<const EngineSnapshot> snapshot() override { return a_.engine->snapshot(); }
  void restore(const EngineSnapshot& snapshot) override {
    both([&](Engine& e) { e.restore(snapshot); });
  }

  BatchEngine* batch() override { return a_.engine->batch() && b_.engine->batch() ? this : nullptr; }
  void setLayout(std::span<const WorldLayout> worlds, std::span<const int> spare) override {
    both([&](Engine& e) { e.batch()->setLayout(worlds, spare); });
  }
  const WorldSettings& settingsOf(int world) const override { return a_.engine->batch()->settingsOf(world); }
  void setSettings(int world, const WorldSettings& settings) override {
    const WorldSettings own = settings;  // a reference to those of the first engine may be given
    both([&](Engine& e) { e.batch()->setSettings(world, own); });
  }
  void stepWorlds(StepReport& report, std::span<const char> paused) override {
    stepBoth(report, [&](Engine& e, StepReport& own) { e.batch()->stepWorlds(own, paused); });
  }
  const TableReader& readWorld(int world) override { return a_.engine->batch()->readWorld(world); }
  std::vector<std::byte> takeWorld(int world) override { return a_.engine->batch()->takeWorld(world); }
  void putWorlds(std::span<const int> worlds, std::span<const std::span<const std::byte>> states) override {
    both([&](Engine& e) { e.batch()->putWorlds(worlds, states); });
  }

 private:
  /// One of the two engines, and its present kernel.
  struct Side {
    std::unique_ptr<ObservableEngine> engine;
    std::string stage = "", kernel = "", nextStage = "";
    bool ended = false;  ///< its thread has finished this step
    std::exception_ptr error = nullptr;
    /// Tables when the present stage began, one behind the other. Empty if there was no memory for them.
    std::vector<std::byte> left = {};
    std::vector<std::size_t> ends = {};  ///< of each of them
    MostWritten most = {};

    void keep() {
      const HostTables& tables = engine->tablesNow();
      try {
        std::size_t size = 0;
        ends.clear();
        forEachArray([&]<class T>(const ArrayInfo<T>& array) {
          const std::size_t elements = most.of(tables, array, ends.size());
          ends.push_back(size += tables.view().*array.member ? elements * sizeof(T) : 0);
        });
        left.resize(size);
      } catch (const std::bad_alloc&) {
        left.clear();
        return;
      }
      std::size_t begin = 0;
      auto end = ends.begin();
      forEachArray([&]<class T>(const ArrayInfo<T>& array) {
        if (*end > begin)
          std::memcpy(&left[begin], static_cast<const void*>(tables.view().*array.member), *end - begin);
        begin = *end++;
      });
    }
    /// The table of a number.
    std::span<const std::byte> before(std::size_t number) const {
      const std::size_t begin = number > 0 ? ends[number - 1] : 0;
      return std::span(left).subspan(begin, ends[number] - begin);
    }
  };
  /// Where the two threads wait for each other. Not std::barrier, whose waits lose wakes in GCC 12 where the
  /// system has no futex.
  struct Meeting {
    std::mutex mutex = {};
    std::condition_variable over = {};
    int expected = 2, waiting = 0, number = 0;
  };
  /// Waits for the other thread, unless it has left. The last one to come calls meet().
  void await() {
    std::unique_lock lock(meeting_.mutex);
    if (++meeting_.waiting == meeting_.expected) return conclude();
    meeting_.over.wait(lock, [this, number = meeting_.number] { return meeting_.number != number; });
  }
  void leave() {
    const std::lock_guard lock(meeting_.mutex);
    if (meeting_.waiting == --meeting_.expected) conclude();
  }
  void conclude() noexcept {
    meet();
    meeting_.waiting = 0, ++meeting_.number;
    meeting_.over.notify_all();
  }

  template <class F> void both(F&& f) { f(*a_.engine), f(*b_.engine); }

  /// take(engine, report) takes a step.
  template <class Take> void stepBoth(StepReport& report, const Take& take) {
    step_ = report.step, rowsBuilt_ = false;
    a_.ended = b_.ended = false;
    a_.keep(), b_.keep();
    meeting_.expected = 2, meeting_.waiting = 0;
    StepReport otherReport = report;
    std::thread other([&] { run(b_, otherReport, take); });
    run(a_, report, take);
    other.join();
    report.difference = difference_;
    for (const Side* side : {&a_, &b_})
      if (side->error) std::rethrow_exception(side->error);
  }

  template <class Take> void run(Side& side, StepReport& report, const Take& take) {
    side.stage.clear(), side.error = nullptr;
    side.engine->observe([this, &side](std::string_view stage, std::string_view kernel) {
      side.nextStage = stage;
      if (!side.stage.empty()) await();
      side.stage = stage, side.kernel = kernel;
    });
    try {
      take(*side.engine, report);
    } catch (...) {
      side.error = std::current_exception();
    }
    side.engine->observe({});
    side.nextStage.clear();
    side.ended = true;
    leave();
  }

  /// Both threads are at the end of a kernel or of the step.
  void meet() {
    if (!difference_.empty() || (a_.ended && b_.ended)) return;
    if (a_.ended == b_.ended && a_.stage == b_.stage && a_.kernel == b_.kernel)
      return compare(a_.nextStage != a_.stage);
    difference_ = place(a_.kernel) + " beside " + b_.stage + " " + b_.kernel;
  }

  std::string place(const std::string& kernel) const {
    return "step " + std::to_string(step_) + ", stage " + a_.stage +
           (kernel.empty() ? "" : ", kernel " + kernel);
  }

  /// Within a stage the order of elements may differ, if a later kernel of it sorts them. A difference counts
  /// if it is there at the end of the stage, and in work memory if one side has written the element in it:
  /// others are what earlier steps have left in memory. It has the kernel after which its table differed
  /// first.
  void compare(bool stageEnds) {
    const HostTables &s = a_.engine->tablesNow(), &t = b_.engine->tablesNow();
    if (stageEnds && a_.stage == BuildContactRows<Real>::kStage) rowsBuilt_ = true;
    std::size_t number = 0;
    forEachArray([&]<class T>(const ArrayInfo<T>& array) {
      const std::size_t table = number++;
      if (!difference_.empty() || array.life == Lifetime::Unordered || !isValid(array)) return;
      const T *p = s.view().*array.member, *q = t.view().*array.member;
      const std::size_t n = std::min(elementsWritten(s, array), elementsWritten(t, array));
      if (!p || !q || std::memcmp(p, q, n * sizeof(T)) == 0) return;
      const std::string& kernel = firstKernel_.try_emplace(table, a_.kernel).first->second;
      if (!stageEnds) return;
      if (a_.left.empty() || b_.left.empty()) return;
      const std::span<const std::byte> ofA = a_.before(table), ofB = b_.before(table);
      for (std::size_t i = 0; i < n && difference_.empty(); ++i)
        if (std::memcmp(p + i, q + i, sizeof(T)) != 0 && valueOf(p[i]) != valueOf(q[i]) &&
            (array.life != Lifetime::Work || !isLeft(ofA, i, p[i]) || !isLeft(ofB, i, q[i])))
          difference_ = place(kernel) + ", table " + array.name + ", element " + std::to_string(i) + ", " +
                        describe(valueOf(p[i]), valueOf(q[i]));
    });
    if (!stageEnds) return;
    firstKernel_.clear();
    a_.keep(), b_.keep();
  }
  /// Contact rows reuse the memory of the old manifolds: those are valid up to the stage that builds rows,
  /// and rows from its end on.
  template <class T> bool isValid(const ArrayInfo<T>& array) const {
    if (array.aliases) return rowsBuilt_;
    return !std::is_same_v<T, Manifold> || !isOfLastStep(array) || !rowsBuilt_;
  }
  /// The bytes of an element that carry a value. Those of padding, and of rows of a tree that are not used,
  /// are zero.
  template <class T> using Bytes = std::array<std::byte, sizeof(T)>;
  template <class T> static Bytes<T> valueOf(const T& element) {
    Bytes<T> out;
    copyClean(out.data(), &element, sizeof(T));
    if constexpr (requires { element.part[0].bytes(); })
      for (const auto& part : element.part) {
        const auto begin = static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&part) -
                                                    reinterpret_cast<const std::byte*>(&element));
        const std::size_t used = std::max(part.bytes(), sizeof part.count);
        std::memset(&out[begin + used], 0, sizeof part - used);
      }
    return out;
  }
  /// Where two elements differ first, and both values there.
  template <std::size_t kSize>
  static std::string describe(const std::array<std::byte, kSize>& p, const std::array<std::byte, kSize>& q) {
    const auto at = static_cast<std::size_t>(std::ranges::mismatch(p, q).in1 - p.begin()) / 4 * 4;
    const auto word = [at](const std::array<std::byte, kSize>& bytes) {
      std::uint32_t out = 0;
      std::memcpy(&out, &bytes[at], std::min(sizeof out, kSize - at));
      char text[16];
      std::snprintf(text, sizeof text, "%08x", static_cast<unsigned>(out));
      return std::string(text);
    };
    return "byte " + std::to_string(at) + ": " + word(p) + " beside " + word(q);
  }
  /// Has nothing written element i since the stage began? Memory that a table has grown by is zero.
  template <class T> static bool isLeft(std::span<const std::byte> before, std::size_t i, const T& now) {
    const auto* const bytes = reinterpret_cast<const std::byte*>(&now);
    if ((i + 1) * sizeof(T) <= before.size())
      return std::memcmp(&before[i * sizeof(T)], bytes, sizeof(T)) == 0;
    return std::all_of(bytes, bytes + sizeof(T), [](std::byte byte) { return byte == std::byte{0}; });
  }

  Side a_, b_;
  Meeting meeting_;
  std::int64_t step_ = 0;
  std::map<std::size_t, std::string> firstKernel_;  ///< of each table that differs in this stage
  bool rowsBuilt_ = false;                          ///< in this step
  std::string difference_;
};

}  // namespace rubble::RUBBLE_CORE
