#pragma once
/// The coarse correction of deformable objects: block descent whose blocks are rigid motions of clusters of
/// vertices, at several sizes up to the whole object. A vertex-by-vertex sweep propagates a correction by
/// about one edge and does not conserve the momentum of an object; a sweep over clusters does both.
///
/// Clusters are nested and are fixed when the object is made (src/cook/clusters.cpp). All clusters of a level
/// move at once, under-relaxed like aggregates (coarse.h). The finest clusters of solids do not move; they
/// are only partial sums. An element that n > 2 clusters share counts n/2 times in each of their Hessians.
#include "forces/group_accumulation.h"
#include "stages/bodies/coloring.h"
#include "stages/coarse/coarse.h"

namespace rubble::RUBBLE_CORE {

/// Rotational Hessian added about every axis, over the trace of the cluster's own [1].
inline constexpr Real kLeastRotation = Real(.01);

/// Center and mean velocity of each of the finest clusters: at x^t, and again at the initial guess.
struct PlaceClusters {
  static constexpr const char* kStage = "clusters";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Cluster& c = s.cluster[i];
    Real mass = 0;
    Vec3 moment{0, 0, 0}, momentum{0, 0, 0};
    for (int k = c.begin; k < c.end; ++k) {
      const int v = s.clusterMember[k];
      const Real m = s.vertexParams[v].mass;
      mass += m;
      moment += m * s.vertexPlace[v];
      momentum += m * s.vertexVelocity[v];
    }
    s.clusterMotion[i].mass = mass;
    s.clusterMotion[i].center = moment / mass;
    s.clusterMotion[i].velocity = momentum / mass;
  }
};
/// Mass, and mass-weighted sums of position and velocity.
struct ClusterMoments {
  Real mass = 0;
  Vec3 place{0, 0, 0}, velocity{0, 0, 0};
  RUBBLE_HD void add(const ClusterMotion& part) {
    mass += part.mass;
    place += part.mass * part.center;
    velocity += part.mass * part.velocity;
  }
  RUBBLE_HD void write(ClusterMotion& motion) const {
    motion.mass = mass;
    motion.center = place / mass;
    motion.velocity = velocity / mass;
  }
};
/// The same for coarser clusters, from their finest ones.
struct PlaceLargeClusters {
  static constexpr const char* kStage = "clusters";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int large = s.clusterBegin[1] + i;
    const Cluster& c = s.cluster[large];
    ClusterMoments sum;
    for (int k = c.sliceBegin; k < c.sliceEnd; ++k) sum.add(s.clusterMotion[k]);
    sum.write(s.clusterMotion[large]);
  }
};

/// Adds a row to the vertex at one of its corners. Other corners of the same side may move with it. The
/// weights c_i of a side add up to 1, so (sum c_i x_i)^2 <= sum |c_i| x_i^2, with equality for vertices that
/// move alike. The Hessian therefore counts |c_i| times, not c_i^2.
template <class Row, class Add> RUBBLE_HD void addShared(const Row& row, int corner, Block3& to, Add&& add) {
  const Real share = std::fabs(row.weight[corner]);
  if (!(share > Real(0))) return;
  Block3 own;
  add(own);
  to.f += own.f;
  to.h += (1 / share) * own.h;
}
/// Is it a contact of an object with itself?
RUBBLE_HD inline bool withinObject(const SolverData& s, const PointContact& p) {
  if (p.body >= 0) return false;
  bool within = true;
  RUBBLE_UNROLL
  for (int k = 1; k < kPointCorners; ++k)
    within &= p.v[k] < 0 || s.vertexParams[p.v[k]].first == s.vertexParams[p.v[0]].first;
  return within;
}

/// For a block that moves without any aggregate: all depths are larger.
inline constexpr int kNoLevel = -1;
/// Adds the share of worker `lane` of `lanes` of the inertia, loads, attachments and contacts of a vertex.
/// Rows inside aggregates of `level` are left out. Contacts of the object with itself are added to `self`;
/// returns whether there are any.
template <bool surfaces>
RUBBLE_HD bool addFromOutside(const SolverData& s, int v, int lane, int lanes, int level, Block3& own,
                              Block3& self) {
  if (lane == 0) own += startVertexBlock(s, v);
  // loads and attachments come last
  int first = s.refOffset[v + 1];
  while (first > s.refOffset[v] && pointType(s.ref[first - 1]) >= kFirstLoad) --first;
  for (int r = first + lane; r < s.refOffset[v + 1]; r += lanes)
    if (pointType(s.ref[r]) != kAttachmentCode)
      addElement(s, s.ref[r], own);
    else if (const Attachment& a = s.attachment[pointIndex(s.ref[r])]; a.depth > level)
      addShared(a, pointCorner(s.ref[r]), own, [&](Block3& b) { addElement(s, s.ref[r], b); });
  bool touchesSelf = false;
  for (int r = s.pointIncidenceOffset[v] + lane; r < s.pointIncidenceOffset[v + 1]; r += lanes) {
    const std::uint32_t code = s.pointIncidence[r];
    if (level != kNoLevel && s.pointContact[pointIndex(code)].depth <= level) continue;
    const auto& p = loadVectorized(s.pointContact[pointIndex(code)]);
    const bool isInner = surfaces && withinObject(s, p);
    touchesSelf |= isInner;
    addShared(p, pointCorner(code), isInner ? self : own, [&](Block3& b) {
      p.accumulateVertex(*s.step, s.plan.coneHessian, pointDisplacement(s, p), pointCorner(code), b);
    });
  }
  return touchesSelf;
}

/// Inertia, contacts, attachments and loads of the vertices of one of the finest clusters, about its center.
/// `surfaces`: objects with colliding surfaces exist; their vertices may have many contacts, also within the
/// object.
template <bool surfaces> struct SumCluster {
  static constexpr const char* kStage = "clusters";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Cluster& c = s.cluster[i];
    Block6 sum, inner;
    bool folded = false;
    for (int k = c.begin; k < c.end; ++k)
      folded |= addVertex(s, s.clusterMember[k], s.clusterMotion[i].center, 0, 1, sum, inner);
    s.clusterMotion[i].sum = sum;
    if (surfaces) {
      s.clusterMotion[i].inner = inner;
      s.clusterMotion[i].folded = folded;
    }
  }

  /// Adds the share of worker `lane` of `lanes` of a vertex. Returns whether its object touches itself there.
  RUBBLE_HD static bool addVertex(const SolverData& s, int v, const Vec3& center, int lane, int lanes,
                                  Block6& sum, Block6& inner) {
    Block3 own, self;
    const bool touchesSelf = addFromOutside<surfaces>(s, v, lane, lanes, kNoLevel, own, self);
    addAtLever(sum, s.vertexPlace[v] - center, own.f, own.h);
    if (touchesSelf) addAtLever(inner, s.vertexPlace[v] - center, self.f, self.h);
    return touchesSelf;
  }
};

/// Cluster i of a level: its vertices, and the elements on its boundary.
struct SolveCluster {
  static constexpr const char* kStage = "clusters";
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int index = s.clusterBegin[level] + i;
    const Cluster& c = s.cluster[index];
    ClusterMotion& motion = s.clusterMotion[index];
    Block6 block;
    for (int k = c.sliceBegin; k < c.sliceEnd; ++k) addSlice(s, c, k, motion.center, block);
    for (int k = c.refBegin; k < c.refEnd; ++k) addLeaving(s, s.clusterRef[k], motion.center, block);
    motion.step = stepOf(block);
  }

  /// Adds the vertices of finest cluster k.
  RUBBLE_HD static void addSlice(const SolverData& s, const Cluster& c, int k, const Vec3& center,
                                 Block6& block) {
    const ClusterMotion& chunk = s.clusterMotion[k];
    const Vec3 shift = chunk.center - center;
    const Block6 sum = chunk.sum;  // a copy: issues all loads at once
    addShifted(block, sum, shift);
    // contacts of an object with itself are invariant under a motion of the whole object
    if (s.features > 0 && c.parent >= 0 && chunk.folded) addShifted(block, chunk.inner, shift);
  }
  RUBBLE_HD static void addLeaving(const SolverData& s, const ClusterRef& ref, const Vec3& center,
                                   Block6& block) {
    forEachType(ElementTypes{}, [&]<class F>() {
      if constexpr (!kIsLoad<F>) {
        if (ref.type != typeIndex<F>(ElementTypes{})) return;
        const F e = s.elementsOf<F>()[ref.index];  // a copy: issues all loads at once
        if (!e.alive) return;
        Vec3 x[F::kCorners];
        gatherCorners(s, e, x);
        accumulateGroup(s.stepOfPoint(e.v[0]), e, x, ref.inside, center, static_cast<Real>(ref.clusters) / 2,
                        block);
      }
    });
  }
  RUBBLE_HD static Vec6 stepOf(Block6& block) {
    // Collinear vertices do not resist a rotation about their line. Every axis gets a small share of the
    // trace.
    const Real least = kLeastRotation * (block.aa.xx + block.aa.yy + block.aa.zz);
    block.aa.xx += least, block.aa.yy += least, block.aa.zz += least;
    return aggregateStep(block);
  }
};

/// Moves the vertices of one of the finest clusters with the cluster of a level that contains it.
struct MoveCluster {
  static constexpr const char* kStage = "clusters";
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    for (int k = s.cluster[i].begin; k < s.cluster[i].end; ++k) moveMember(s, i, k);
  }

  /// Moves the k-th member, which belongs to finest cluster i.
  RUBBLE_HD void moveMember(const SolverData& s, int i, int k) const {
    int owner = i;
    for (int n = 0; n < level && owner >= 0; ++n) owner = s.cluster[owner].parent;
    if (owner < 0) return;
    const ClusterMotion& motion = s.clusterMotion[owner];
    // an exact rotation: the elements inside are invariant under it
    const Quat turn = expRotation(motion.step.ang);
    const int v = s.clusterMember[k];
    const Vec3 at = s.vertexPlace[v] - motion.center, move = motion.step.lin + rotate(turn, at) - at;
    s.vertexMoved[v] += move;
    s.vertexPlace[v] += move;
  }
};

}  // namespace rubble::RUBBLE_CORE
