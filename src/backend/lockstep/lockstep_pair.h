#pragma once
/// Runs the step on two executors and compares all tables after each stage. Reports the first stage, table
/// and element that differ.
#include <barrier>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <thread>

#include "backend/cpu/cpu_engine.h"

namespace rubble::RUBBLE_CORE {

/// Each executor runs the step in a thread of its own. The threads meet in a barrier at the end of each
/// stage.
class LockstepPair {
 public:
  LockstepPair(int threadsA, int threadsB) : a_(threadsA), b_(threadsB) { observe(); }
  LockstepPair(const LockstepPair&) = delete;
  LockstepPair& operator=(const LockstepPair&) = delete;

  CpuExecutor& a() { return a_.executor; }
  CpuExecutor& b() { return b_.executor; }
  const CpuExecutor& a() const { return a_.executor; }

  /// One step of both executors. `number` identifies it in a reported difference.
  void step(std::int64_t number) {
    step_ = number;
    a_.ended = b_.ended = false;
    meeting_.emplace(2, Compare{this});
    std::exception_ptr errors[2];
    std::thread other([&] { run(b_, errors[1]); });
    run(a_, errors[0]);
    other.join();
    for (const std::exception_ptr& error : errors)
      if (error) std::rethrow_exception(error);
  }

  /// Without barriers between the two.
  void sortBodies() {
    for (Side* side : {&a_, &b_}) {
      side->executor.observe({});
      sortBodiesOf(side->executor);
    }
    observe();
  }

  /// The first difference since the start, "stage narrow, table manifold, element 12", or "".
  const std::string& firstDifference() const { return difference_; }

 private:
  /// One of the two executors, and its present stage.
  struct Side {
    explicit Side(int threads) : executor(threads) {}
    CpuExecutor executor;
    const char* stage = "";
    bool ended = false;  ///< its thread has finished this step
  };
  struct Compare {
    LockstepPair* pair;
    void operator()() const noexcept { pair->meet(); }
  };

  void observe() {
    for (Side* side : {&a_, &b_})
      side->executor.observe([this, side](const char* stage) { enter(*side, stage); });
  }

  /// Compares a stage only at its end: within it, the kernels may run in different orders.
  void enter(Side& side, const char* stage) {
    if (*side.stage && std::strcmp(stage, side.stage) != 0) meeting_->arrive_and_wait();
    side.stage = stage;
  }
  void run(Side& side, std::exception_ptr& error) {
    try {
      side.executor.run([&] { RUBBLE_CORE::step(side.executor); });
    } catch (...) {
      error = std::current_exception();
    }
    side.ended = true;
    meeting_->arrive_and_drop();
  }

  /// Both threads are at the end of a stage or of the step.
  void meet() {
    if (!difference_.empty() || (a_.ended && b_.ended)) return;
    if (a_.ended == b_.ended && std::strcmp(a_.stage, b_.stage) == 0) return compare();
    difference_ = "step " + std::to_string(step_) + ", stage " + a_.stage + " beside " + b_.stage;
  }

  /// Elements of an array that this step has written so far.
  static std::size_t written(const SolverData& s, Per per) {
    const Counters& c = *s.counters;
    if (const int type = jointTypeOf(per); type >= 0) return static_cast<std::size_t>(s.joints[type]);
    switch (per) {
      case Per::Body:
        return static_cast<std::size_t>(s.bodies);
      case Per::Pair:
        return static_cast<std::size_t>(c.pairs);
      case Per::ActivePair:
        return static_cast<std::size_t>(c.activePairs);
      case Per::Manifold:
        return static_cast<std::size_t>(c.manifolds);
      case Per::Rolling:
        return static_cast<std::size_t>(c.rollers);
      case Per::Aggregate:
        return static_cast<std::size_t>(c.aggregates);
      case Per::Slice:
        return static_cast<std::size_t>(c.slices);
      case Per::Boundary:
        return static_cast<std::size_t>(c.boundary);
      case Per::NodeLevel:
        return static_cast<std::size_t>(s.nodes() * kCoarseLevels);
      case Per::SoftNode:
        return static_cast<std::size_t>(s.softNodes);
      case Per::Strand:
        return static_cast<std::size_t>(s.strands);
      case Per::StrandVertex:
        return static_cast<std::size_t>(s.strandVertices);
      case Per::Incidence:
        return static_cast<std::size_t>(c.incidences);
      case Per::Color:
        return static_cast<std::size_t>(c.colors);
      case Per::Cell:
        return static_cast<std::size_t>(s.cells);
      case Per::Vertex:
        return static_cast<std::size_t>(s.vertices);
      case Per::PointOwner:
        return static_cast<std::size_t>(s.owners());
      case Per::Feature:
        return static_cast<std::size_t>(s.features);
      case Per::FeatureCell:
        return static_cast<std::size_t>(s.featureCells);
      case Per::ParticleCell:
        return static_cast<std::size_t>(s.particleCells);
      case Per::PointPair:
        return static_cast<std::size_t>(c.pointPairs);
      case Per::PointIncidence:
        return static_cast<std::size_t>(c.pointIncidences);
      case Per::Cluster:
        return static_cast<std::size_t>(s.clusterBegin[kClusterLevels]);
      case Per::Attachment:
        return static_cast<std::size_t>(s.attachments);
      case Per::TreeNode:
        return static_cast<std::size_t>(s.treeNodes);
      case Per::TreeChild:
        return static_cast<std::size_t>(2 * s.treeNodes);
      case Per::SmallTree:
        return static_cast<std::size_t>(s.smallTrees);
      default:
        return elementCount(s, per);
    }
  }

  void compare() {
    const SolverData &s = a_.executor.view(), &t = b_.executor.view();
    forEachArray([&]<class T>(const ArrayInfo<T>& array) {
      if (!difference_.empty() || array.life == Lifetime::Unordered) return;
      const T *p = s.*array.member, *q = t.*array.member;
      const std::size_t n = written(s, array.per);
      if (!p || !q || std::memcmp(p, q, n * sizeof(T)) == 0) return;
      for (std::size_t i = 0; i < n; ++i)
        if (std::memcmp(p + i, q + i, sizeof(T)) != 0) {
          difference_ = "step " + std::to_string(step_) + ", stage " + a_.stage + ", table " + array.name +
                        ", element " + std::to_string(i);
          return;
        }
    });
  }

  Side a_, b_;
  std::optional<std::barrier<Compare>> meeting_;
  std::int64_t step_ = 0;
  std::string difference_;
};

}  // namespace rubble::RUBBLE_CORE
