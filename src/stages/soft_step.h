#pragma once
/// The parts of the step that only scenes with vertices have: contacts of vertices, their elements, and their place in the graph.
#include "stages/acceleration.h"
#include "stages/crossings.h"
#include "stages/lines.h"
#include "stages/lumps.h"
#include "stages/soft_sleep.h"
#include "stages/spin.h"

namespace rubble::RUBBLE_CORE {

/// Kernel<F> over all elements of each type.
template <template <class> class Kernel, class E>
void forEachElement(E& e) {
  forEachType(ElementTypes{}, [&]<class F>() { e.forEach(Kernel<F>{}, e.view().elements[typeIndex<F>(ElementTypes{})]); });
}

/// Where the clusters are, and their mean velocities.
template <class E>
void placeClusters(E& e) {
  const int* const begin = e.view().clusterBegin;
  e.forEach(PlaceClusters{}, begin[1]);
  e.forEach(PlaceLargeClusters{}, begin[kClusterLevels] - begin[1]);
}

/// The triangles and edges of surfaces, in a grid.
template <class Way, class E>
void fillFeatures(E& e) {
  const int features = e.view().features, cells = e.view().featureCells;
  e.forEach(ForgetFeatureLevels{}, kFeatureKinds);
  e.clear(&View::featureCount, cells);
  e.forEach(CountFeatures<Way>{}, features);
  e.scan(&View::featureCount, &View::featureOffset, cells);
  e.forEach(FillFeatures<Way>{}, features);
}

/// Ends ways on which surfaces would cross.
template <class E>
void keepApart(E& e) {
  const int owners = e.view().vertices + e.view().edges;
  e.forEach(BeginCrossings{}, e.view().vertices);
  fillFeatures<FoundWay>(e);
  e.forEach(FindNear{}, owners);
  e.scan(&View::nearCount, &View::nearOffset, owners, &Counters::nearFeatures, Per::NearFeature);
  e.forEach(WriteNear{}, owners);
  e.forEach(CountCrossings{}, &Counters::nearFeatures);
  e.rounds(TakeWays{}, ProposeWays{}, &Counters::crossingWork, &Counters::crossings, &Counters::crossingRounds);
}

/// What each vertex and edge is near to.
template <class E>
void findVertexPairs(E& e) {
  const int vertices = e.view().vertices, cells = e.view().grainCells;
  if (cells > 0) {
    e.clear(&View::grainCount, cells);
    e.forEach(CountGrains{}, vertices);
    e.scan(&View::grainCount, &View::grainOffset, cells);
    e.forEach(FillGrains{}, vertices);
  }
  if (e.view().features > 0) {
    fillFeatures<ExpectedWay>(e);
    e.forEach(FindDentingBodies{}, e.view().bodies);
  }
  const int owners = e.view().owners();
  e.forEach(FindPointPairs{}, owners);
  e.scan(&View::pointPairCount, &View::pointPairOffset, owners, &Counters::pointPairs, Per::PointPair);
  e.forEach(WritePointPairs{}, owners);
}

/// Kernel over what keeps bodies awake.
template <template <class> class Kernel, class E>
void forEachSoftNeighbor(E& e) {
  e.forEach(Kernel<NearVertex>{}, &Counters::pointPairs);
  e.forEach(Kernel<HeldByVertices>{}, e.view().attachments);
}

/// Are solids taken further than sweeps take them?
template <class E>
bool accelerates(E& e) {
  const StepConstants& c = e.view().step;
  return e.view().elements[typeIndex<Tetrahedron>(ElementTypes{})] > 0 && c.acceleration > Real(0) && c.iterations > kFirstAccelerated + 1;
}

/// Contacts, elements and attachments at x^t.
template <class E>
void beginVertices(E& e) {
  const int vertices = e.view().vertices;
  e.forEach(UpdatePointContacts{}, &Counters::pointPairs);
  e.forEach(PlaceVertices{}, vertices);
  forEachElement<BeginElements>(e);
  if (e.view().elements[typeIndex<Tetrahedron>(ElementTypes{})] > 0) e.forEach(BeginTetraCorners{}, vertices);
  e.forEach(BeginAttachments{}, e.view().attachments);
  placeClusters(e);
}

template <class E>
void countSoftEntries(E& e) {
  e.forEach(CountSoftEntries<AttachmentBlocks>{}, e.view().attachments);
  e.forEach(CountSoftEntries<PointContactBlocks>{}, &Counters::pointPairs);
  e.clear(&View::pointEntryCount, e.view().vertices);
  e.forEach(CountPointEntries{}, &Counters::pointPairs);
}

template <class E>
void fillSoftEntries(E& e) {
  const int vertices = e.view().vertices;
  e.forEach(FillSoftEntries<AttachmentBlocks>{}, e.view().attachments);
  e.forEach(FillSoftEntries<PointContactBlocks>{}, &Counters::pointPairs);
  e.scan(&View::pointEntryCount, &View::pointEntryOffset, vertices, &Counters::pointEntries, Per::PointEntry);
  e.forEach(FillPointEntries{}, &Counters::pointPairs);
  e.forEach(SortPointEntries{}, vertices);
}

/// Vertices by colour; the colours are those of the bodies.
template <class E>
void listVertexColors(E& e) {
  const int vertices = e.view().vertices;
  e.clear(&View::vertexColorCount, &Counters::colors);
  e.forEach(CountVertexColors{}, vertices);
  e.scan(&View::vertexColorCount, &View::vertexColorOffset, &Counters::colors);
  e.forEach(FillVertexColors{}, vertices);
}

/// Kernel over contacts and attachments, as blocks that join members of groups.
template <template <class> class Kernel, class E, class... Args>
void forEachSoftBlock(E& e, Args... args) {
  e.forEach(Kernel<PointContactBlocks>{args...}, &Counters::pointPairs);
  e.forEach(Kernel<AttachmentBlocks>{args...}, e.view().attachments);
}

/// What the groups of a level see of lumps.
template <class E>
void sumLumps(E& e, int level) {
  if (e.view().objects > 0) e.forEach(SumLumpPart{level}, e.view().clusterBegin[1]);
  e.forEach(SumLump{level}, e.view().lumps);
}

/// One sweep over the clusters of every level, from coarse to fine.
template <class E>
void correctClusters(E& e) {
  const int* const begin = e.view().clusterBegin;
  for (int level = kClusterLevels - 1; level >= 0; --level) {
    const int clusters = level > 0 ? begin[level + 1] - begin[level] : e.view().movingParts, parts = level > 0 ? begin[1] : clusters;
    if (clusters == 0) continue;
    if (e.view().features > 0) e.forEach(SumCluster<true>{}, parts);
    else e.forEach(SumCluster<false>{}, parts);
    e.forEach(SolveCluster{level}, clusters);
    e.forEach(MoveCluster{level}, parts);
  }
}

/// One step of every rope and rod.
template <class E>
void correctLines(E& e) {
  const View& s = e.view();
  if (s.features > 0) e.forEach(AssembleLines<true>{}, s.lineVertices);
  else e.forEach(AssembleLines<false>{}, s.lineVertices);
  e.forEach(SolveLine{}, s.lines);
  e.forEach(TakeLineForces{}, s.lineVertices);
  e.forEach(MoveLines{}, s.lineVertices);
}

/// After the dual updates of contacts and joints, with which these have nothing to do.
template <class E>
void updateSoftDuals(E& e) {
  e.beside(UpdatePointDuals{}, &Counters::pointPairs);
  forEachType(ElementTypes{}, [&]<class F>() {
    if constexpr (F::kHasDual) e.beside(UpdateElementDuals<F>{}, e.view().elements[typeIndex<F>(ElementTypes{})]);
  });
  e.beside(UpdateAttachmentDuals{}, e.view().attachments);
}

/// Gives free objects back the angular momentum that the time step takes.
template <class E>
void keepSpin(E& e) {
  e.forEach(SumSpins{}, e.view().clusterBegin[1]);
  e.forEach(FindSpins{}, e.view().lumps);
}

template <class E>
void finishSoftRows(E& e) {
  e.forEach(FinishPoints{}, &Counters::pointPairs);
  forEachType(ElementTypes{}, [&]<class F>() {
    if constexpr (F::kHasDual) e.forEach(FinishElements<F>{}, e.view().elements[typeIndex<F>(ElementTypes{})]);
  });
  if (e.view().yielding > 0) e.forEach(FlowTetrahedra{}, e.view().elements[typeIndex<Tetrahedron>(ElementTypes{})]);
  e.forEach(FinishAttachments{}, e.view().attachments);
}

}  // namespace rubble::RUBBLE_CORE
