#include <algorithm>

#include "stages/soft/cluster_phases.h"
#include "tables/host_reader.h"

namespace rubble::RUBBLE_CORE {

JointState HostReader::attachmentState(int index) const {
  const SolverData& s = data();
  const Attachment& a = s.attachment[attachmentsBegin() + index];
  Vec3d gap;
  for (int k = 0; k < kPointCorners && a.v[k] >= 0; ++k)
    gap += s.vertexPosition[a.v[k]] * static_cast<double>(a.weight[k]);
  if (a.isVertexVertex == 0)
    gap += a.body == kWorldBody ? a.worldPoint
                                : s.position[a.body] + Vec3d(rotate(s.orientation[a.body], a.anchor));
  JointState state;
  state.gap = length(gap);
  // force on the vertices (B): the rows push C down
  state.force = Vec3d(a.lambda);
  state.broken = a.broken != 0;
  return state;
}

std::vector<EngineVertexContact> HostReader::vertexContacts() const {
  const SolverData& s = data();
  std::vector<EngineVertexContact> out;
  const auto add = [&](int k) {
    const PointContact& p = s.oldPointContact[k];
    if (!p.active) return;
    Vec3 t1, t2;
    tangentBasis(p.n, t1, t2);
    double depth;
    int vertex = p.v[0], other = -1;
    if (s.oldPointPair[k].vertex >= s.vertices + s.edges) {
      PointContact now{};
      Real gap, margin;
      touchCorner(s, s.oldPointPair[k].vertex, s.oldPointPair[k].other, rowOfPair(s.oldPointPair, k), now,
                  gap, margin);
      depth = static_cast<double>(max(-gap, -p.length));
      // the corner nearest to the point
      Real most = 0;
      for (int c = 0; c < kPointCorners && p.v[c] >= 0; ++c)
        if (-p.weight[c] > most) most = -p.weight[c], vertex = p.v[c];
    } else if (p.body >= 0) {
      depth = static_cast<double>(
          s.vertexParams[vertex].radius -
          pointToBody(s, vertex, p.body, s.vertexParams[vertex].length, p.n).distance);
    } else if (s.oldPointPair[k].other >= kCornerNode) {
      const NearParts parts = nearParts(s, s.oldPointPair[k].vertex, s.oldPointPair[k].other);
      depth = static_cast<double>(touchDistance(s, parts) - length(parts.gap));
      // the corner of the other side nearest to the point
      Real most = 0;
      for (int c = 1; c < kPointCorners && p.v[c] >= 0; ++c)
        if (-p.weight[c] > most) most = -p.weight[c], other = p.v[c];
    } else {
      other = p.v[1];
      depth = static_cast<double>(s.vertexParams[vertex].radius + s.vertexParams[other].radius) -
              length(s.vertexPosition[other] - s.vertexPosition[vertex]);
    }
    if (depth < 0 && !(p.lambdaN > Real(0))) return;
    out.push_back({s.numberOfPoint(vertex), p.body < 0 ? -1 : s.idOf[p.body],
                   other < 0 ? -1 : s.numberOfPoint(other), Vec3d(p.n),
                   Vec3d(p.n * p.lambdaN + t1 * p.lambda1 + t2 * p.lambda2), depth});
  };
  for (const OwnerRange& owners : s.vertices > 0 ? pointOwners() : std::vector<OwnerRange>{})
    for (int k = s.oldPointPairOffset[owners.begin]; k < s.oldPointPairOffset[owners.end]; ++k) add(k);
  return out;
}

void HostReader::addSoftQuality(Quality& q, std::vector<double>& depths, int& joints) const {
  const SolverData& s = data();
  if (s.vertices == 0) return;
  for (const EngineVertexContact& c : vertexContacts()) depths.push_back(std::max(0.0, c.depth));
  for (int i = 0; i < attachmentsEnd() - attachmentsBegin(); ++i) {
    if (!active(s, s.attachment[attachmentsBegin() + i])) continue;
    const double gap = attachmentState(i).gap;
    q.jointGapMean += gap;
    q.jointGapMax = std::max(q.jointGapMax, gap);
    ++joints;
  }
  for (int v = verticesBegin(); v < verticesEnd(); ++v) {
    if (!isDynamicVertex(s, v)) continue;
    const VertexParams& p = s.vertexParams[v];
    const double v2 = dot(Vec3d(s.vertexVelocity[v]), Vec3d(s.vertexVelocity[v]));
    q.kineticEnergy += .5 * static_cast<double>(p.mass) * v2;
    q.potentialEnergy -= static_cast<double>(p.mass * p.gravityScale) *
                         dot(Vec3d(s.stepOfPoint(v).gravity), s.vertexPosition[v]);
    q.maxSpeed = std::max(q.maxSpeed, std::sqrt(v2));
  }
}

void HostReader::vertexStates(int first, std::span<rubble::Vec3> positions,
                              std::span<rubble::Vec3> velocities) const {
  const SolverData& s = data();
  first += verticesBegin();
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] = s.vertexPosition[static_cast<std::size_t>(first) + i];
  for (std::size_t i = 0; i < velocities.size(); ++i)
    velocities[i] = rubble::Vec3(s.vertexVelocity[static_cast<std::size_t>(first) + i]);
}

std::vector<char> HostReader::elementsAlive(int type, int first, int count) const {
  std::vector<char> alive(static_cast<std::size_t>(count));
  forEachType(ElementTypes{}, [&]<class F>() {
    if (typeIndex<F>(ElementTypes{}) != type) return;
    if (world_) first += world_->firstElement[type];
    for (int i = 0; i < count; ++i)
      alive[static_cast<std::size_t>(i)] = data().elementsOf<F>()[first + i].alive != 0;
  });
  return alive;
}

}  // namespace rubble::RUBBLE_CORE
