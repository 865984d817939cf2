/// SolverState of each body and vertex, for inspection: color, and the largest stiffness and multiplier of
/// its rows.
#include <algorithm>
#include <cmath>

#include "stages/contacts/contacts.h"
#include "stages/joints/joints.h"
#include "tables/host_reader.h"

namespace rubble::RUBBLE_CORE {
namespace {

void raise(SolverState& state, Real k, Real lambda) {
  state.stiffness = std::max(state.stiffness, static_cast<double>(k));
  state.multiplier = std::max(state.multiplier, static_cast<double>(std::fabs(lambda)));
}
Real sizeOf(const Real* lambda, int rows) {
  Real sum = 0;
  for (int i = 0; i < rows; ++i) sum += lambda[i] * lambda[i];
  return std::sqrt(sum);
}

/// Of pairs whose owners are the bodies [begin, end).
void addContacts(const SolverData& s, int begin, int end, std::vector<SolverState>& bodies) {
  for (int pair = s.oldPairOffset[begin]; pair < s.oldPairOffset[end]; ++pair) {
    const int manifold = manifoldOfOld(s, pair);
    if (manifold < 0 || s.oldPair[pair].other < 0) continue;
    const Manifold& m = s.oldManifold[manifold];
    if (m.count == 0 || m.row < 0) continue;
    const ContactRows& rows = s.contact[m.row];
    for (int k = 0; k < m.count; ++k) {
      const auto& load = rows.load[k];
      const Real lambda[3] = {load.lambdaN, load.lambda1, load.lambda2};
      for (const int body : {rows.a, rows.b})
        raise(bodies[static_cast<std::size_t>(body)], std::max(load.kN, rows.slip[k].kT), sizeOf(lambda, 3));
    }
  }
}

template <class F> void addJoint(const SolverData& s, int slot, std::vector<SolverState>& bodies) {
  const JointSpec<F>& spec = s.specsOf<F>()[slot];
  const Joint<F>& joint = s.jointsOf<F>()[slot];
  SolverState state;
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (P::kUnit == RowUnit::Linear) {
      const auto& rows = partOf<I>(joint.parts);
      if constexpr (P::kAxis) {
        for (const AxisRow* row : {&rows.limit, &rows.drive, &rows.friction})
          if (row->active) raise(state, row->k, row->lambda);
      } else if (partOf<I>(spec.parts).mode != GroupMode::Off) {
        raise(state, rows.state.k, sizeOf(rows.lambda, P::kRows));
      }
    }
  });
  for (int side = 0; side < kSides<F>; ++side)
    if (const int body = bodyOf(spec, side); body != kWorldBody)
      raise(bodies[static_cast<std::size_t>(body)], static_cast<Real>(state.stiffness),
            static_cast<Real>(state.multiplier));
}

void addVertexRows(const SolverData& s, std::vector<SolverState>& bodies,
                   std::vector<SolverState>& vertices) {
  for (int k = 0; k < s.oldPointPairOffset[s.owners()]; ++k) {
    const PointContact& p = s.oldPointContact[k];
    if (!p.active) continue;
    const Real lambda[3] = {p.lambdaN, p.lambda1, p.lambda2};
    for (const int v : p.v)
      if (v >= 0) raise(vertices[static_cast<std::size_t>(v)], std::max(p.kN, p.kT), sizeOf(lambda, 3));
    if (p.body >= 0) raise(bodies[static_cast<std::size_t>(p.body)], std::max(p.kN, p.kT), sizeOf(lambda, 3));
  }
  for (int k = 0; k < s.attachments; ++k) {
    const Attachment& a = s.attachment[k];
    if (!a.alive || a.broken) continue;
    const Real lambda[3] = {a.lambda.x, a.lambda.y, a.lambda.z};
    for (const int v : a.v)
      if (v >= 0) raise(vertices[static_cast<std::size_t>(v)], a.k, sizeOf(lambda, 3));
    if (a.body != kWorldBody) raise(bodies[static_cast<std::size_t>(a.body)], a.k, sizeOf(lambda, 3));
  }
}

void addRows(const SolverData& s, int begin, int end, std::vector<SolverState>& bodies,
             std::vector<SolverState>& vertices) {
  addContacts(s, begin, end, bodies);
  forEachType(JointTypes{}, [&]<class F>() {
    for (int i = 0; i < s.joints[typeIndex<F>(JointTypes{})]; ++i)
      if (active<F>(s, i)) addJoint<F>(s, i, bodies);
  });
  addVertexRows(s, bodies, vertices);
}

}  // namespace

std::vector<SolverState> HostReader::bodySolverStates() const {
  const SolverData& s = data();
  std::vector<SolverState> bodies(static_cast<std::size_t>(s.bodies)),
      vertices(static_cast<std::size_t>(s.vertices));
  for (int i = 0; i < s.bodies; ++i)
    if (s.params[i].kind == BodyKind::Dynamic) bodies[static_cast<std::size_t>(i)].color = s.color[i];
  addRows(s, bodiesBegin(), bodiesEnd(), bodies, vertices);
  std::vector<SolverState> out(static_cast<std::size_t>(world_ ? world_->bodies : tables_.bodyIds));
  for (std::size_t id = 0; id < out.size(); ++id)
    out[id] = bodies[static_cast<std::size_t>(placeOf(static_cast<int>(id)))];
  return out;
}

std::vector<SolverState> HostReader::vertexSolverStates() const {
  const SolverData& s = data();
  std::vector<SolverState> bodies(static_cast<std::size_t>(s.bodies)),
      vertices(static_cast<std::size_t>(s.vertices));
  for (int v = 0; v < s.vertices; ++v)
    if (isDynamicVertex(s, v)) vertices[static_cast<std::size_t>(v)].color = s.vertexColor[v];
  addRows(s, bodiesBegin(), bodiesEnd(), bodies, vertices);
  return {vertices.begin() + verticesBegin(), vertices.begin() + verticesEnd()};
}

}  // namespace rubble::RUBBLE_CORE
