#pragma once
/// Deformable objects: contacts of vertices, elements and attachments, and their nodes in the graph. All
/// phases return at once in worlds without vertices.
#include "stages/executor.h"
#include "stages/soft/acceleration.h"
#include "stages/soft/crossings.h"
#include "stages/soft/spin.h"
#include "stages/soft/vertex_contacts.h"
#include "stages/soft/vertex_graph.h"
#include "stages/soft/vertices.h"

namespace rubble::RUBBLE_CORE::soft {

/// Runs Kernel<F> over all elements of each type.
template <template <class> class Kernel, Executor E> void forEachElement(E& e) {
  forEachType(ElementTypes{},
              [&]<class F>() { e.forEach(Kernel<F>{}, e.view().elements[typeIndex<F>(ElementTypes{})]); });
}

inline int tetrahedra(const SolverData& s) { return s.elements[typeIndex<Tetrahedron>(ElementTypes{})]; }

/// Fills the grid of triangles and edges.
template <class SweptMotion, Executor E> void fillFeatures(E& e) {
  const int features = e.view().features, cells = e.view().featureCells;
  e.forEach(ForgetFeatureLevels{}, kFeatureKinds);
  e.clear(&SolverData::featureCount, cells);
  e.forEach(CountFeatures<SweptMotion>{}, features);
  e.scan(&SolverData::featureCount, &SolverData::featureOffset, cells);
  e.forEach(FillFeatures<SweptMotion>{}, features);
}

/// Finds the partners of vertices, edges and corners of bodies.
template <Executor E> void findPairs(E& e) {
  const SolverData& s = e.view();
  if (s.vertices == 0) return;
  if (s.particleCells > 0) {
    e.clear(&SolverData::particleCount, s.particleCells);
    e.forEach(CountParticles{}, s.vertices);
    e.scan(&SolverData::particleCount, &SolverData::particleOffset, s.particleCells);
    e.forEach(FillParticles{}, s.vertices);
  }
  if (s.features > 0) {
    fillFeatures<ExpectedWay>(e);
    e.forEach(FindDentingBodies{}, s.bodies);
  }
  const int owners = s.owners();
  e.forEach(FindPointPairs{}, owners);
  e.scan(&SolverData::pointPairCount, &SolverData::pointPairOffset, owners, &Counters::pointPairs,
         Per::PointPair);
  e.forEach(WritePointPairs{}, owners);
}

/// Builds contacts, elements and attachments at x^t.
template <Executor E> void prepare(E& e) {
  const int vertices = e.view().vertices;
  if (vertices == 0) return;
  e.forEach(UpdatePointContacts{}, &Counters::pointPairs);
  e.forEach(PlaceVertices{}, vertices);
  forEachElement<BeginElements>(e);
  if (tetrahedra(e.view()) > 0) e.forEach(BeginTetraCorners{}, vertices);
  e.forEach(BeginAttachments{}, e.view().attachments);
}

/// Inertial targets and initial guesses. Deactivates contacts that stay open at the targets.
template <Executor E> void predict(E& e) {
  if (e.view().vertices == 0) return;
  e.forEach(PredictVertices{}, e.view().vertices);
  e.forEach(MarkInactivePoints{}, &Counters::pointPairs);
}

// Constraints of vertices in the incidence lists of bodies, and colors.

template <Executor E> void countIncidences(E& e) {
  if (e.view().vertices == 0) return;
  e.forEach(CountSoftIncidences<AttachmentBlocks>{}, e.view().attachments);
  e.forEach(CountSoftIncidences<PointContactBlocks>{}, &Counters::pointPairs);
  e.clear(&SolverData::pointIncidenceCount, e.view().vertices);
  e.forEach(CountPointIncidences{}, &Counters::pointPairs);
}
template <Executor E> void fillIncidences(E& e) {
  const int vertices = e.view().vertices;
  if (vertices == 0) return;
  e.forEach(FillSoftIncidences<AttachmentBlocks>{}, e.view().attachments);
  e.forEach(FillSoftIncidences<PointContactBlocks>{}, &Counters::pointPairs);
  e.scan(&SolverData::pointIncidenceCount, &SolverData::pointIncidenceOffset, vertices,
         &Counters::pointIncidences, Per::PointIncidence);
  e.forEach(FillPointIncidences{}, &Counters::pointPairs);
  e.forEach(SortPointIncidences{}, vertices);
}
template <Executor E> void listColors(E& e) {
  const int vertices = e.view().vertices;
  if (vertices == 0) return;
  e.clear(&SolverData::vertexColorCount, &Counters::colors);
  e.forEach(CountVertexColors{}, vertices);
  e.scan(&SolverData::vertexColorCount, &SolverData::vertexColorOffset, &Counters::colors);
  e.forEach(FillVertexColors{}, vertices);
}

/// Chebyshev acceleration of solids after the sweep.
template <Executor E> void accelerate(E& e, int iteration) {
  const StepPlan& plan = e.view().plan;
  const bool last = iteration + 1 == plan.iterations;
  if (last || tetrahedra(e.view()) == 0 || !(plan.acceleration > Real(0)) ||
      plan.iterations <= kFirstAccelerated + 1)
    return;
  e.forEach(AccelerateVertices{iteration, accelerationOf(plan.acceleration, iteration)}, e.view().vertices);
}

/// Multipliers. Runs beside the dual updates of contacts and joints, with which it shares no data.
template <Executor E> void updateDuals(E& e) {
  if (e.view().vertices == 0) return;
  e.beside(UpdatePointDuals{}, &Counters::pointPairs);
  forEachType(ElementTypes{}, [&]<class F>() {
    if constexpr (F::kHasDual)
      e.beside(UpdateElementDuals<F>{}, e.view().elements[typeIndex<F>(ElementTypes{})]);
  });
  e.beside(UpdateAttachmentDuals{}, e.view().attachments);
}

/// Changes motions by which surfaces would cross.
template <Executor E> void keepApart(E& e) {
  const SolverData& s = e.view();
  if (s.features == 0) return;
  const int owners = s.vertices + s.edges;
  e.clear(&SolverData::crossingRound, s.worlds);
  e.forEach(BeginCrossings{}, s.vertices);
  fillFeatures<FoundWay>(e);
  e.forEach(FindNear{}, owners);
  e.scan(&SolverData::nearCount, &SolverData::nearOffset, owners, &Counters::nearFeatures, Per::NearFeature);
  e.forEach(WriteNear{}, owners);
  e.forEach(CountCrossings{}, &Counters::nearFeatures);
  e.rounds({&Counters::crossings, &Counters::crossingRounds}, phase(TakeWays{}, &Counters::crossingWork),
           phase(ProposeWays{}, &Counters::crossingWork));
}

/// Stores multipliers of contacts and attachments; plastic flow and breakage.
template <Executor E> void finishRows(E& e) {
  const SolverData& s = e.view();
  if (s.vertices == 0) return;
  e.forEach(FinishPoints{}, &Counters::pointPairs);
  forEachType(ElementTypes{}, [&]<class F>() {
    if constexpr (F::kHasDual) e.forEach(FinishElements<F>{}, s.elements[typeIndex<F>(ElementTypes{})]);
  });
  if (s.yielding > 0) e.forEach(FlowTetrahedra{}, tetrahedra(s));
  e.forEach(FinishAttachments{}, s.attachments);
}

/// Positions and velocities at the end of the step.
template <Executor E> void finish(E& e) { e.forEach(FinishVertices{}, e.view().vertices); }

}  // namespace rubble::RUBBLE_CORE::soft
