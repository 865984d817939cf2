#include "tables/host_reader.h"

#include <algorithm>

#include "stages/joints/joints.h"

namespace rubble::RUBBLE_CORE {

namespace {

Distribution distribution(std::vector<double>& values) {
  Distribution d;
  if (values.empty()) return d;
  std::sort(values.begin(), values.end());
  for (const double v : values) d.mean += v;
  d.mean /= static_cast<double>(values.size());
  d.p99 = values[static_cast<std::size_t>(.99 * static_cast<double>(values.size() - 1))];
  d.max = values.back();
  return d;
}

/// Calls visit(pair, its bodies, manifold) for every pair of the last step that has contact points, of owners
/// [begin, end).
template <class Visit> void forEachManifold(const SolverData& s, int begin, int end, Visit&& visit) {
  for (int k = s.oldPairOffset[begin]; k < s.oldPairOffset[end]; ++k)
    if (const int m = manifoldOfOld(s, k);
        m >= 0 && s.oldManifold[m].count > 0 && !s.oldManifold[m].passes && s.oldPair[k].other >= 0)
      visit(s.oldPair[k], ordered(s.oldPair[k]), s.oldManifold[m]);
}

/// The two surface points of a contact point, relative to the center of A.
struct SurfacePoints {
  Vec3 onA, onB;
};
SurfacePoints surfacePoints(const SolverData& s, const OrderedPair& o, const Manifold& m, int point) {
  return {rotate(s.orientation[o.a], pointOnA(m, point)),
          centerDistance(s, o.a, o.b) + rotate(s.orientation[o.b], pointOnB(m, point))};
}

}  // namespace

std::vector<EngineContact> HostReader::contacts() const {
  const SolverData& s = data();
  std::vector<EngineContact> out;
  forEachManifold(s, bodiesBegin(), bodiesEnd(), [&](const Pair& p, const OrderedPair& o, const Manifold& m) {
    // a sleeping pair has no rows, but keeps its multipliers
    const bool sleeps = m.row < 0 && (RUBBLE_CORE::isAsleep(s, o.a) || RUBBLE_CORE::isAsleep(s, o.b));
    if (m.row < 0 && !sleeps) return;
    const ContactRows* const r = sleeps ? nullptr : &s.contact[m.row];
    const Vec3 n = r ? r->n : m.normal;
    Vec3 t1, t2;
    tangentBasis(n, t1, t2);
    const PairParts parts = partsOf(s, p, o);
    for (int k = 0; k < m.count; ++k) {
      const SurfacePoints x = surfacePoints(s, o, m, k);
      const Vec3 force = r ? n * r->load[k].lambdaN + t1 * r->load[k].lambda1 + t2 * r->load[k].lambda2
                           : n * m.lambdaN[k] + t1 * m.lambda1[k] + t2 * m.lambda2[k];
      out.push_back({s.idOf[o.a], s.idOf[o.b], s.position[o.a] + Vec3d((x.onA + x.onB) * Real(.5)), Vec3d(n),
                     Vec3d(force), static_cast<double>(dot(n, x.onA - x.onB)), parts.ofA, parts.ofB});
    }
  });
  return out;
}

std::vector<EngineTouch> HostReader::touches() const {
  const SolverData& s = data();
  std::vector<EngineTouch> out;
  forEachManifold(s, bodiesBegin(), bodiesEnd(), [&](const Pair&, const OrderedPair& o, const Manifold& m) {
    bool touch = false;
    for (int k = 0; k < m.count; ++k) {
      const SurfacePoints x = surfacePoints(s, o, m, k);
      const bool loaded = m.row >= 0 && s.contact[m.row].load[k].lambdaN > Real(0);
      touch |= loaded ||
               dot(m.normal, x.onA - x.onB) > -kInactiveGap * pairLength(s.params[o.a], s.params[o.b]);
    }
    if (touch) out.push_back({s.idOf[o.a], s.idOf[o.b], isSensor(s, o.a) || isSensor(s, o.b)});
  });
  return out;
}

std::vector<int> HostReader::sleepers() const {
  const SolverData& s = data();
  std::vector<int> out;
  for (int i = bodiesBegin(); i < bodiesEnd(); ++i)
    if (s.asleep[i] != 0 && s.params[i].kind == BodyKind::Dynamic) out.push_back(s.idOf[i]);
  std::sort(out.begin(), out.end());
  return out;
}

Quality HostReader::quality() const {
  const SolverData& s = data();
  Quality q;
  std::vector<double> depths;
  for (const EngineContact& c : contacts()) depths.push_back(std::max(0.0, c.depth));
  int joints = 0;
  addSoftQuality(q, depths, joints);
  q.penetration = distribution(depths);
  forEachType(JointTypes{}, [&]<class F>() {
    const int type = typeIndex<F>(JointTypes{});
    for (int i = 0; i < jointSlots(type); ++i) {
      if (!active<F>(s, slotOfJoint(type, i))) continue;
      const double gap = jointState(type, i).gap;
      q.jointGapMean += gap;
      q.jointGapMax = std::max(q.jointGapMax, gap);
      ++joints;
    }
  });
  if (joints > 0) q.jointGapMean /= joints;

  for (int i = bodiesBegin(); i < bodiesEnd(); ++i) {
    const BodyParams& p = s.params[i];
    if (p.kind != BodyKind::Dynamic) continue;
    const Vec3 w = rotateInverse(s.orientation[i], s.angularVelocity[i]);
    const double v2 = dot(Vec3d(s.velocity[i]), Vec3d(s.velocity[i]));
    q.kineticEnergy += .5 *
                       (static_cast<double>(p.mass) * v2 + static_cast<double>(dot(w, mul(p.inertia, w))));
    q.potentialEnergy -= static_cast<double>(p.mass * p.gravityScale) *
                         dot(Vec3d(s.stepOf(i).gravity), s.position[i]);
    q.maxSpeed = std::max(q.maxSpeed, std::sqrt(v2));
  }
  return q;
}

}  // namespace rubble::RUBBLE_CORE
