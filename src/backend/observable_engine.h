#pragma once
/// Engines whose tables can be looked at between the kernels of a step.
#include <algorithm>

#include "backend/engine.h"
#include "backend/kernel_observer.h"
#include "tables/host_tables.h"

namespace rubble::RUBBLE_CORE {

class ObservableEngine : public Engine {
 public:
  virtual void observe(KernelObserver observer) = 0;
  /// All arrays in host memory, as of the call of the observer from which it is called.
  virtual const HostTables& tablesNow() = 0;
};

/// Elements of a kind that a step has counted so far.
inline std::size_t elementsCounted(const SolverData& s, Per per) {
  const Counters& c = *s.counters;
  const auto count = [](int n) { return static_cast<std::size_t>(n); };
  if (const int type = jointTypeOf(per); type >= 0) return count(s.joints[type]);
  switch (per) {
    case Per::Body:
      return count(s.bodies);
    case Per::Pair:
      return count(c.pairs);
    case Per::ActivePair:
      return count(c.activePairs);
    case Per::Manifold:
      return count(c.manifolds);
    case Per::Rolling:
      return count(c.rollers);
    case Per::Aggregate:
      return count(c.aggregates);
    case Per::Slice:
      return count(c.slices);
    case Per::Boundary:
      return count(c.boundary);
    case Per::NodeLevel:
    case Per::Member:
      return count(s.nodes() * kCoarseLevels);
    case Per::SoftNode:
      return count(s.softNodes);
    case Per::Strand:
      return count(s.strands);
    case Per::StrandVertex:
      return count(s.strandVertices);
    case Per::Incidence:
      return count(c.incidences);
    case Per::ColumnNode:
      return count(c.columnNodes);
    case Per::Color:
      return count(c.colors);
    case Per::Cell:
      return count(s.cells);
    case Per::PathCell:
      return count(c.pathCells);
    case Per::Vertex:
      return count(s.vertices);
    case Per::PointOwner:
      return count(s.owners());
    case Per::Feature:
      return count(s.features);
    case Per::FeatureCell:
      return count(s.featureCells);
    case Per::ParticleCell:
      return count(s.particleCells);
    case Per::PointPair:
      return count(c.pointPairs);
    case Per::PointIncidence:
      return count(c.pointIncidences);
    case Per::Cluster:
      return count(s.clusterBegin[kClusterLevels]);
    case Per::Attachment:
      return count(s.attachments);
    case Per::TreeNode:
      return count(s.treeNodes);
    case Per::TreeChild:
      return count(2 * s.treeNodes);
    case Per::SmallTree:
      return count(s.smallTrees);
    default:
      return elementCount(s, per);
  }
}

/// Does a step itself count the elements of this kind?
inline bool isCountedInSteps(Per per) {
  constexpr Per kCounted[] = {Per::Pair,      Per::ActivePair, Per::Manifold,       Per::Rolling,
                              Per::Aggregate, Per::Slice,      Per::Boundary,       Per::Incidence,
                              Per::Color,     Per::PointPair,  Per::PointIncidence, Per::ColumnNode};
  return std::ranges::find(kCounted, per) != std::end(kCounted);
}

/// Is the array of the last step, which counted its elements?
template <class T> bool isOfLastStep(const ArrayInfo<T>& array) {
  return array.life == Lifetime::State && !array.aliases && isCountedInSteps(array.per);
}
/// Elements of a kind that the last step counted.
inline std::size_t elementsOfLastStep(const SolverData& s, Per per) {
  const int pairs = s.oldPairOffset[s.bodies], active = s.oldActivePairOffset[pairs];
  const int count = per == Per::Pair         ? pairs
                    : per == Per::ActivePair ? active
                    : per == Per::Rolling    ? (s.rolledBefore ? active : 0)
                                             : s.oldPointPairOffset[s.owners()];
  return static_cast<std::size_t>(count);
}

/// Elements of an array that have been written so far: those of the present step, of an old array those of
/// the last one. A count exceeds the capacity until the tables have grown.
template <class T> std::size_t elementsWritten(const HostTables& tables, const ArrayInfo<T>& array) {
  const SolverData& s = tables.view();
  const auto room = static_cast<std::size_t>(tables.room(array));
  if (isOfLastStep(array)) return std::min(elementsOfLastStep(s, array.per), room);
  // nodes of no aggregate may follow the members
  if (array.per == Per::Member && s.aggregateOffset)
    return std::min(static_cast<std::size_t>(
                        s.aggregateOffset[std::min(s.counters->aggregates, tables.capacity(Per::Aggregate))]),
                    room);
  return std::min(elementsCounted(s, array.per), room);
}

/// The most elements that steps have written to each table so far, and one more for the end of offsets:
/// behind them memory is zero. Scans may write their total behind the end, so of offsets it is all elements.
class MostWritten {
 public:
  /// Of a table by its number, now. No table has less room than before.
  template <class T> std::size_t of(const HostTables& tables, const ArrayInfo<T>& array, std::size_t number) {
    if (number >= most_.size()) most_.resize(number + 1);
    const auto room = static_cast<std::size_t>(tables.room(array));
    if (array.extra > 0) return room + static_cast<std::size_t>(array.extra);
    return most_[number] = std::min(room, std::max(most_[number], elementsWritten(tables, array) + 1));
  }

 private:
  std::vector<std::size_t> most_;
};

}  // namespace rubble::RUBBLE_CORE
