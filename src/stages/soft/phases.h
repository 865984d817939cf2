#pragma once
/// Deformable objects: contacts of vertices, elements and attachments, and their place in the graph. Nothing happens in worlds without vertices.
#include "stages/executor.h"
#include "stages/soft/acceleration.h"
#include "stages/soft/crossings.h"
#include "stages/soft/vertex_graph.h"
#include "stages/soft/vertices.h"
#include "stages/soft/vertex_contacts.h"

namespace rubble::RUBBLE_CORE::soft {

/// Kernel<F> over all elements of each type.
template <template <class> class Kernel, Executor E>
void forEachElement(E& e) {
  forEachType(ElementTypes{}, [&]<class F>() { e.forEach(Kernel<F>{}, e.view().elements[typeIndex<F>(ElementTypes{})]); });
}

inline int tetrahedra(const View& s) { return s.elements[typeIndex<Tetrahedron>(ElementTypes{})]; }

/// The triangles and edges of surfaces, in a grid.
template <class Way, Executor E>
void fillFeatures(E& e) {
  const int features = e.view().features, cells = e.view().featureCells;
  e.forEach(ForgetFeatureLevels{}, kFeatureKinds);
  e.clear(&View::featureCount, cells);
  e.forEach(CountFeatures<Way>{}, features);
  e.scan(&View::featureCount, &View::featureOffset, cells);
  e.forEach(FillFeatures<Way>{}, features);
}

/// What each vertex and edge is near to.
template <Executor E>
void findPairs(E& e) {
  const View& s = e.view();
  if (s.vertices == 0) return;
  if (s.grainCells > 0) {
    e.clear(&View::grainCount, s.grainCells);
    e.forEach(CountGrains{}, s.vertices);
    e.scan(&View::grainCount, &View::grainOffset, s.grainCells);
    e.forEach(FillGrains{}, s.vertices);
  }
  if (s.features > 0) {
    fillFeatures<ExpectedWay>(e);
    e.forEach(FindDentingBodies{}, s.bodies);
  }
  const int owners = s.owners();
  e.forEach(FindPointPairs{}, owners);
  e.scan(&View::pointPairCount, &View::pointPairOffset, owners, &Counters::pointPairs, Per::PointPair);
  e.forEach(WritePointPairs{}, owners);
}

/// Contacts, elements and attachments at x^t.
template <Executor E>
void prepare(E& e) {
  const int vertices = e.view().vertices;
  if (vertices == 0) return;
  e.forEach(UpdatePointContacts{}, &Counters::pointPairs);
  e.forEach(PlaceVertices{}, vertices);
  forEachElement<BeginElements>(e);
  if (tetrahedra(e.view()) > 0) e.forEach(BeginTetraCorners{}, vertices);
  e.forEach(BeginAttachments{}, e.view().attachments);
}

/// Inertial targets and initial guesses, and the contacts that stay open at these.
template <Executor E>
void predict(E& e) {
  if (e.view().vertices == 0) return;
  e.forEach(PredictVertices{}, e.view().vertices);
  e.forEach(MarkDormantPoints{}, &Counters::pointPairs);
}

// Row blocks of vertices among those of bodies, and colors.

template <Executor E>
void countEntries(E& e) {
  if (e.view().vertices == 0) return;
  e.forEach(CountSoftEntries<AttachmentBlocks>{}, e.view().attachments);
  e.forEach(CountSoftEntries<PointContactBlocks>{}, &Counters::pointPairs);
  e.clear(&View::pointEntryCount, e.view().vertices);
  e.forEach(CountPointEntries{}, &Counters::pointPairs);
}
template <Executor E>
void fillEntries(E& e) {
  const int vertices = e.view().vertices;
  if (vertices == 0) return;
  e.forEach(FillSoftEntries<AttachmentBlocks>{}, e.view().attachments);
  e.forEach(FillSoftEntries<PointContactBlocks>{}, &Counters::pointPairs);
  e.scan(&View::pointEntryCount, &View::pointEntryOffset, vertices, &Counters::pointEntries, Per::PointEntry);
  e.forEach(FillPointEntries{}, &Counters::pointPairs);
  e.forEach(SortPointEntries{}, vertices);
}
template <Executor E>
void listColors(E& e) {
  const int vertices = e.view().vertices;
  if (vertices == 0) return;
  e.clear(&View::vertexColorCount, &Counters::colors);
  e.forEach(CountVertexColors{}, vertices);
  e.scan(&View::vertexColorCount, &View::vertexColorOffset, &Counters::colors);
  e.forEach(FillVertexColors{}, vertices);
}

/// Takes solids further than the sweep took them.
template <Executor E>
void accelerate(E& e, int iteration) {
  const StepConstants& c = e.view().step;
  const bool last = iteration + 1 == c.iterations;
  if (last || tetrahedra(e.view()) == 0 || !(c.acceleration > Real(0)) || c.iterations <= kFirstAccelerated + 1) return;
  e.forEach(AccelerateVertices{iteration, accelerationOf(c.acceleration, iteration)}, e.view().vertices);
}

/// After the dual updates of contacts and joints, with which these share nothing.
template <Executor E>
void updateDuals(E& e) {
  if (e.view().vertices == 0) return;
  e.beside(UpdatePointDuals{}, &Counters::pointPairs);
  forEachType(ElementTypes{}, [&]<class F>() {
    if constexpr (F::kHasDual) e.beside(UpdateElementDuals<F>{}, e.view().elements[typeIndex<F>(ElementTypes{})]);
  });
  e.beside(UpdateAttachmentDuals{}, e.view().attachments);
}

/// Ends ways on which surfaces would cross.
template <Executor E>
void keepApart(E& e) {
  const View& s = e.view();
  if (s.features == 0) return;
  const int owners = s.vertices + s.edges;
  e.forEach(BeginCrossings{}, s.vertices);
  fillFeatures<FoundWay>(e);
  e.forEach(FindNear{}, owners);
  e.scan(&View::nearCount, &View::nearOffset, owners, &Counters::nearFeatures, Per::NearFeature);
  e.forEach(WriteNear{}, owners);
  e.forEach(CountCrossings{}, &Counters::nearFeatures);
  e.rounds(TakeWays{}, ProposeWays{}, &Counters::crossingWork, &Counters::crossings, &Counters::crossingRounds);
}

/// What contacts and attachments bore, what yields and what breaks.
template <Executor E>
void finishRows(E& e) {
  const View& s = e.view();
  if (s.vertices == 0) return;
  e.forEach(FinishPoints{}, &Counters::pointPairs);
  forEachType(ElementTypes{}, [&]<class F>() {
    if constexpr (F::kHasDual) e.forEach(FinishElements<F>{}, s.elements[typeIndex<F>(ElementTypes{})]);
  });
  if (s.yielding > 0) e.forEach(FlowTetrahedra{}, tetrahedra(s));
  e.forEach(FinishAttachments{}, s.attachments);
}

/// Places and velocities at the end of the step.
template <Executor E>
void finish(E& e) {
  e.forEach(FinishVertices{}, e.view().vertices);
}

}  // namespace rubble::RUBBLE_CORE::soft
