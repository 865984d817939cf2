#pragma once
/// Two executors side by side: the step runs on both, stage by stage, and the first stage, table and element that differ are named.
#include <cstring>
#include <string>

#include "backend/cpu/cpu_executor.h"

namespace rubble::RUBBLE_CORE {

class LockstepExecutor {
 public:
  using Lane = CpuExecutor::Lane;

  LockstepExecutor(int threadsA, int threadsB) : a_(threadsA), b_(threadsB) {}

  CpuExecutor& a() { return a_; }
  CpuExecutor& b() { return b_; }
  const CpuExecutor& a() const { return a_; }
  View& view() { return a_.view(); }

  template <class Kernel, class Count>
  void forEach(const Kernel& kernel, Count n) {
    enter(Kernel::kName);
    both([&](CpuExecutor& e) { e.forEach(kernel, n); });
  }
  template <class Kernel, class VertexKernel>
  void forEachColor(const Kernel& kernel, const VertexKernel& vertexKernel) {
    enter(Kernel::kName);
    both([&](CpuExecutor& e) { e.forEachColor(kernel, vertexKernel); });
  }
  template <class Kernel>
  void forEachIn(const Kernel& kernel, int* View::*offsets, int k) {
    enter(Kernel::kName);
    both([&](CpuExecutor& e) { e.forEachIn(kernel, offsets, k); });
  }
  void group(int* View::*keys, int n, int* View::*offsets, int* View::*order, int Counters::*keyCount) {
    both([&](CpuExecutor& e) { e.group(keys, n, offsets, order, keyCount); });
  }
  template <class Count>
  void clear(int* View::*array, Count n) {
    both([&](CpuExecutor& e) { e.clear(array, n); });
  }
  template <class Count>
  void scan(int* View::*counts, int* View::*offsets, Count n) {
    both([&](CpuExecutor& e) { e.scan(counts, offsets, n); });
  }
  template <class Count>
  void scan(int* View::*counts, int* View::*offsets, Count n, int Counters::*total, Per per) {
    both([&](CpuExecutor& e) { e.scan(counts, offsets, n, total, per); });
  }
  void require(Per per, int Counters::*count) {
    both([&](CpuExecutor& e) { e.require(per, count); });
  }
  template <class Take, class Propose>
  void rounds(const Take& take, const Propose& propose, int Counters::*count, int Counters::*left, int Counters::*turn) {
    both([&](CpuExecutor& e) { e.rounds(take, propose, count, left, turn); });
  }
  void lodgeRows() {
    both([](CpuExecutor& e) { e.lodgeRows(); });
  }
  void keepManifolds() {
    enter("between steps");
    both([](CpuExecutor& e) { e.keepManifolds(); });
  }

  /// "stage narrow, table manifold, element 12" of the first difference since the start, or "".
  const std::string& firstDifference() const { return difference_; }
  void setStep(std::int64_t step) { step_ = step; }

 private:
  template <class F>
  void both(F&& f) {
    a_.run([&] { f(a_); });
    b_.run([&] { f(b_); });
  }

  /// A stage of several kernels is compared when it has ended: in between, orders may differ.
  void enter(const char* stage) {
    if (stage_ && std::strcmp(stage, stage_) != 0) compare();
    stage_ = stage;
  }

  /// Elements of an array that this step has written so far.
  static std::size_t written(const View& s, Per per) {
    const Counters& c = *s.counters;
    if (const int type = jointTypeOf(per); type >= 0) return static_cast<std::size_t>(s.joints[type]);
    switch (per) {
      case Per::Body: return static_cast<std::size_t>(s.bodies);
      case Per::Pair: return static_cast<std::size_t>(c.pairs);
      case Per::Manifold: return static_cast<std::size_t>(c.manifolds);
      case Per::Rolling: return static_cast<std::size_t>(c.rollers);
      case Per::Group: return static_cast<std::size_t>(c.groups);
      case Per::Chunk: return static_cast<std::size_t>(c.chunks);
      case Per::External: return static_cast<std::size_t>(c.externals);
      case Per::MemberLevel: return static_cast<std::size_t>(s.members() * kCoarseLevels);
      case Per::Lump: return static_cast<std::size_t>(s.lumps);
      case Per::Entry: return static_cast<std::size_t>(c.entries);
      case Per::Color: return static_cast<std::size_t>(c.colors);
      case Per::Cell: return static_cast<std::size_t>(s.cells);
      case Per::Vertex: return static_cast<std::size_t>(s.vertices);
      case Per::PointOwner: return static_cast<std::size_t>(s.owners());
      case Per::Feature: return static_cast<std::size_t>(s.features);
      case Per::FeatureCell: return static_cast<std::size_t>(s.featureCells);
      case Per::GrainCell: return static_cast<std::size_t>(s.grainCells);
      case Per::PointPair: return static_cast<std::size_t>(c.pointPairs);
      case Per::PointEntry: return static_cast<std::size_t>(c.pointEntries);
      case Per::Cluster: return static_cast<std::size_t>(s.clusterBegin[kClusterLevels]);
      case Per::Attachment: return static_cast<std::size_t>(s.attachments);
      case Per::TreeNode: return static_cast<std::size_t>(treeNodes(s));
      case Per::TreeSource: return static_cast<std::size_t>(s.treeSources);
      default: return elementCount(s, per);
    }
  }

  void compare() {
    if (!difference_.empty()) return;
    const View &s = a_.view(), &t = b_.view();
    forEachArray([&]<class T>(const ArrayInfo<T>& array) {
      if (!difference_.empty() || array.life == Life::Unordered) return;
      const T *p = s.*array.member, *q = t.*array.member;
      const std::size_t n = written(s, array.per);
      if (!p || !q || std::memcmp(p, q, n * sizeof(T)) == 0) return;
      for (std::size_t i = 0; i < n; ++i)
        if (std::memcmp(p + i, q + i, sizeof(T)) != 0) {
          difference_ = "step " + std::to_string(step_) + ", stage " + stage_ + ", table " + array.name + ", element " + std::to_string(i);
          return;
        }
    });
  }

  CpuExecutor a_, b_;
  const char* stage_ = nullptr;
  std::int64_t step_ = 0;
  std::string difference_;
};

}  // namespace rubble::RUBBLE_CORE
