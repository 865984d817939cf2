/// Parts of the step of deformable objects in closed form: shares, limits, boxes and sums.
#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "stages/coarse/soft_nodes.h"
#include "stages/soft/spin.h"
#include "stages/soft/strands.h"
#include "stages/soft/vertex_graph.h"
#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

TEST(KeptSpin, IsTheMostThatDoesNotSpinFasterThanBefore) {
  Random random(5);
  int limited = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3 before = random.vector(2), after = random.vector(1.5), lost = random.vector(2);
    const Real share = FindSpins::keptShare(before, after, lost),
               most = std::max(length(before), length(after));
    ASSERT_TRUE(share >= 0 && share <= 1) << k;
    EXPECT_LE(length(after - share * lost), most * (1 + 1e-9)) << k;
    if (share == 1) continue;
    ++limited;
    EXPECT_GT(length(after - (share + 1e-6) * lost), most) << k;
  }
  EXPECT_GT(limited, 50);
  EXPECT_EQ(FindSpins::keptShare({1, 0, 0}, {1, 0, 0}, {0, 0, 0}), 0);
}

TEST(StrandRotation, IsTheRelativeMotionOfNeighborsOverTheirLimit) {
  StrandWork work[3]{};
  const Vec3 moved[3] = {{.1, .2, .3}, {.4, .2, -.1}, {.4, .2, -.1}};
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) work[k].x[i] = moved[k][i];
  const StrandRows rows(work, 9);
  constexpr Real kReach = .25;
  EXPECT_NEAR(strandRotation(rows, 1, kReach), .5 / (kMaxStrandRotation * kReach), 1e-12);
  EXPECT_EQ(strandRotation(rows, 2, kReach), 0) << "they move alike";
  work[2].x[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(strandRotation(rows, 2, kReach), kNoStrandRotation);
}

TEST(SoftNodeSum, IsThatOfTheSharesOfAnyNumberOfWorkers) {
  constexpr int kParts = 7;
  Random random(6);
  std::vector<ClusterMotion> motion(kParts);
  for (ClusterMotion& m : motion) m.push.f = random.vector();
  Cluster cluster{};
  cluster.sliceBegin = 1, cluster.sliceEnd = kParts;
  SoftNode node{0, 0, 1};
  SolverData s{};
  s.cluster = &cluster, s.softNode = &node, s.clusterMotion = motion.data();
  Vec3 expected{0, 0, 0};
  for (std::size_t k = 1; k < kParts; ++k) expected += motion[k].push.f;
  for (int workers : {1, 2, 4, 16}) {
    Block3 sum;
    for (int worker = 0; worker < workers; ++worker) SumSoftNode::addShare(s, 0, worker, workers, sum);
    EXPECT_TRUE(test::near(sum.f, expected, 1e-12)) << workers;
  }
}

/// A vertex, or a triangle of three vertices, that may move.
struct Vertices {
  static constexpr int kCount = 4;
  StepConstants step = testConstants();
  VertexParams params[kCount]{};
  Vec3d position[kCount]{};
  Vec3 velocity[kCount]{}, moved[kCount]{};
  SolverData view{};

  Vertices() {
    view.step = &step, view.vertices = kCount;
    view.vertexParams = params, view.vertexPosition = position;
    view.vertexVelocity = velocity, view.vertexMoved = moved;
  }
};

/// A free solid of four vertices in one cluster.
struct FreeSolid : Vertices {
  PaddedVec3 place[kCount]{};
  int members[kCount] = {0, 1, 2, 3}, tetraOffset[kCount + 1] = {0, 1, 1, 1, 1};
  Cluster cluster{};
  ClusterMotion motion{};
  SoftNode node{0, 0, 1};

  explicit FreeSolid(Random& random) {
    cluster.end = kCount, cluster.sliceEnd = 1;
    for (int k = 0; k < kCount; ++k) {
      params[k].mass = random.uniform(1, 2);
      place[k] = random.vector(), velocity[k] = random.vector(), moved[k] = random.vector(.1);
    }
    view.vertexPlace = place, view.clusterMember = members, view.tetraCornerOffset = tetraOffset;
    view.cluster = &cluster, view.clusterMotion = &motion, view.softNode = &node, view.softNodes = 1;
  }
  /// The rotation that is given back while all of it also moves at `common`.
  Vec3 turn(const Vec3& common) {
    Vec3 momentum{0, 0, 0};
    motion = {};
    for (int k = 0; k < kCount; ++k) {
      velocity[k] += common, moved[k] += step.dt * common;
      motion.mass += params[k].mass, momentum += params[k].mass * velocity[k];
    }
    motion.velocity = momentum / motion.mass;
    SumSpins{}(view, 0), FindSpins{}(view, 0);
    for (int k = 0; k < kCount; ++k) velocity[k] -= common, moved[k] -= step.dt * common;
    return motion.step.ang;
  }
};

TEST(KeptSpin, DoesNotDependOnHowTheSolidMovesAsAWhole) {
  Random random(7);
  int turns = 0;
  for (int round = 0; round < 100; ++round) {
    FreeSolid solid(random);
    const Vec3 alone = solid.turn({0, 0, 0});
    turns += length(alone) > 0;
    for (const Vec3& common : {random.vector(3), random.vector(30)})
      EXPECT_TRUE(test::near(solid.turn(common), alone, 1e-9 * (1 + length(alone)))) << round;
  }
  EXPECT_GT(turns, 20);
}

/// What a small particle may touch in a step includes what it falls onto from rest.
TEST(VertexBounds, HoldTheFallOfASmallParticle) {
  Vertices v;
  v.params[0].radius = v.params[0].length = 1e-5;
  v.velocity[0] = {.3, 0, 0};
  const SweptBox box = vertexBounds(v.view, 0);
  for (const Real t : {0., 1.}) {
    const Vec3 at = t * v.step.dt * (v.velocity[0] + v.step.dt * v.step.gravity);
    const Vec3 off = abs(at - box.center);
    for (int k = 0; k < 3; ++k) EXPECT_LE(off[k], box.half[k]);
  }
}

TEST(DetourLimit, ScalesWithTheSurfaceAndItsMotion) {
  Vertices v;
  for (const Real size : {1e-4, 1., 1e3}) {
    v.params[0].surfaceRadius = size;
    v.moved[0] = {0, 0, 0};
    EXPECT_NEAR(longestDetour(v.view, 0), kDetourRadii * size, 1e-12 * size);
    v.moved[0] = {3 * size, 0, -4 * size};
    EXPECT_NEAR(longestDetour(v.view, 0), kDetourRadii * size + kDetourShare * 5 * size, 1e-12 * size);
  }
}

/// A triangle of a surface, and a body with a corner over or under it.
struct OverTriangle : Vertices {
  static constexpr int kOwner = kCount;
  BodyParams body{};
  Vec3d bodyPosition{.1, .1, 0};
  PlacedCorner corner{};
  int offset[kOwner + 2]{};
  PointPair pairs[2]{};
  PointContact contacts[2]{};
  SurfacePart triangle{{0, 1, 2}, 3, false};

  OverTriangle() {
    position[1] = {1, 0, 0}, position[2] = {0, 1, 0};
    for (VertexParams& p : params) p.length = .1, p.radius = .002, p.collides = kHasInside;
    corner.radius = .01;
    view.params = &body, view.position = &bodyPosition;
    view.oldPointPairOffset = offset, view.oldPointPair = pairs, view.oldPointContact = contacts;
  }
  CornerReach reachAt(Real height) {
    corner.at = {.2, .1, height};
    return reachPart(view, 0, corner, triangle, {{0, 0, 0}, 0});
  }
};

TEST(CornerTouch, IsAtTheNearestPointOfTheSurface) {
  OverTriangle x;
  const CornerReach r = x.reachAt(.05);
  ASSERT_TRUE(r.touch.valid);
  EXPECT_TRUE(test::near(r.touch.n, Vec3{0, 0, 1}, 1e-12));
  EXPECT_TRUE(test::near(r.touch.foot, Vec3{.2, .1, 0}, 1e-12));
  EXPECT_NEAR(r.touch.distance, .05, 1e-12);
  EXPECT_NEAR(r.gap, .05 - .01 - .002, 1e-12) << "both are round";
}

TEST(CornerTouch, HoldsCornersBelowASurfaceToAShareOfItsSize) {
  OverTriangle x;
  const Real least = kHeldFromBelow * x.params[0].length;
  EXPECT_TRUE(x.reachAt(-.9 * least).touch.valid);
  EXPECT_FALSE(x.reachAt(-1.1 * least).touch.valid);
}

/// The side on which the triangle itself held the corner comes before those of its neighbors.
TEST(HeldSide, IsThatOfTheFeatureItself) {
  OverTriangle x;
  x.offset[OverTriangle::kOwner + 1] = 2;
  for (const int own : {0, 1}) {
    PointContact &self = x.contacts[own], &neighbor = x.contacts[1 - own];
    self.n = {0, 0, -1}, self.length = .1, self.active = 1;
    neighbor.n = {-1, 0, 0}, neighbor.length = .2, neighbor.active = 1;
    for (int k = 0; k < kPointCorners; ++k) self.v[k] = k < 3 ? k : -1, neighbor.v[k] = k == 0 ? 1 : -1;
    const HeldSide held = heldSide(x.view, OverTriangle::kOwner, x.triangle);
    EXPECT_TRUE(test::near(held.side, Vec3{0, 0, 1}, 0)) << own;
    EXPECT_EQ(held.behind, .1);
  }
}

TEST(SharedRow, OfACornerWithoutWeightAddsNothing) {
  struct {
    Real weight[2] = {0, Real(-.5)};
  } row;
  const auto add = [](Block3& b) { b.f += Vec3{1, 2, 3}, b.addDiagonal(4); };
  Block3 none, half;
  addShared(row, 0, none, add), addShared(row, 1, half, add);
  EXPECT_EQ(length(none.f), 0);
  EXPECT_EQ(none.h.xx, 0);
  EXPECT_EQ(half.f.y, 2);
  EXPECT_EQ(half.h.xx, 8);
}

/// A body that is attached to four vertices is listed once, and they are its neighbors.
TEST(SoftIncidences, OfABodyAreOneForEachVertexWithCodesOfTheirOwn) {
  Vertices v;
  for (VertexParams& p : v.params) p.kind = VertexKind::Dynamic;
  BodyParams body{};
  body.kind = BodyKind::Dynamic;
  Attachment attachments[2]{};
  for (Attachment& a : attachments) {
    a.alive = 1, a.body = 0, a.depth = 2;
    for (int k = 0; k < kPointCorners; ++k) a.v[k] = k;
  }
  int offset[2]{}, count[1]{};
  Incidence incidences[2 * kPointCorners]{};
  v.view.params = &body, v.view.attachment = attachments, v.view.incidence = incidences;
  v.view.incidenceOffset = offset, v.view.incidenceCount = count;
  for (int i = 0; i < 2; ++i) CountSoftIncidences<AttachmentBlocks>{}(v.view, i);
  ASSERT_EQ(count[0], 2 * kPointCorners);
  for (int i = 0; i < 2; ++i) FillSoftIncidences<AttachmentBlocks>{}(v.view, i);
  std::set<std::uint32_t> codes;
  std::multiset<int> neighbors;
  for (const Incidence& incidence : incidences)
    codes.insert(incidence.code), neighbors.insert(incidence.other - kVertexNode);
  EXPECT_EQ(codes.size(), 2u * kPointCorners);
  EXPECT_EQ(neighbors, (std::multiset<int>{0, 0, 1, 1, 2, 2, 3, 3}));
}

TEST(Attachment, OfFourVerticesHoldsTheirWeightedMean) {
  Vertices v;
  Attachment a{};
  a.alive = 1, a.body = kWorldBody, a.k = 1, a.compliance = 1, a.length = 1, a.mass = 1;
  a.worldPoint = {1, 2, 3};
  Vec3d mean{0, 0, 0};
  for (int k = 0; k < kPointCorners; ++k) {
    v.params[k].kind = VertexKind::Dynamic, v.params[k].mass = 1;
    v.position[k] = {k - 1., .5 * k, k * k + 2.};
    a.v[k] = k, a.weight[k] = k == 0 ? Real(-.3) : k == 1 ? Real(-.2) : Real(-.25);
    mean -= static_cast<double>(a.weight[k]) * v.position[k];
  }
  v.view.attachment = &a;
  BeginAttachments{}(v.view, 0);
  EXPECT_TRUE(test::near(a.c0, Vec3(a.worldPoint - mean), 1e-12));
}

/// Two layers fall together, 1 mm apart: the lower one may stop, so their contact stays active. Layers that
/// move apart do not meet even then.
TEST(InactivePoints, AreOpenWithEitherSideAtRest) {
  for (const bool apart : {false, true}) {
    Vertices v;
    v.step.inactiveRows = true;
    const Vec3 fall = v.step.dt * v.step.dt * v.step.gravity;
    Vec3 target[Vertices::kCount] = {apart ? -fall : fall, fall, fall, fall};
    PointPair pair{};
    pair.other = kFeatureNode;
    PointContact p{};
    p.body = -1, p.active = 1, p.n = {0, 0, -1}, p.c0 = -.001, p.length = .1, p.kN = p.kT = 1;
    for (int k = 0; k < Vertices::kCount; ++k) p.v[k] = k, p.weight[k] = k == 0 ? 1 : Real(-1) / 3;
    v.view.vertexTarget = target, v.view.pointPair = &pair, v.view.pointContact = &p;
    MarkInactivePoints{}(v.view, 0);
    EXPECT_EQ(p.kN > 0, !apart);
  }
}

/// A list of partners with other numbers between them is thinned out as one without.
TEST(Partners, ThatAreSidesOfOthersAreDroppedAtAnyStride) {
  Vertices v;
  SurfaceFeature features[2]{};
  features[0] = {FeatureKind::Triangle, {0, 1, 2}, {1, -1, -1}, {-1, -1}, {kNoSource, kNoSource}};
  features[1] = {FeatureKind::Edge, {0, 1, -1}, {-1, -1, -1}, {2, -1}, {kNoSource, kNoSource}};
  v.view.feature = features, v.view.features = 2;
  const int triangle = kFeatureNode, edge = kFeatureNode + 1, corner = kCornerNode + 2,
            other = kCornerNode + 3;
  const std::vector<std::vector<int>> lists = {
      {edge, triangle, corner, other}, {corner, other, edge}, {triangle}, {other, corner, triangle, edge}};
  const std::vector<std::vector<int>> kept = {
      {triangle, other}, {corner, other, edge}, {triangle}, {other, triangle}};
  for (std::size_t n = 0; n < lists.size(); ++n)
    for (const int stride : {1, 2, 3}) {
      std::vector<int> list(lists[n].size() * static_cast<std::size_t>(stride), -7);
      for (std::size_t k = 0; k < lists[n].size(); ++k)
        list[k * static_cast<std::size_t>(stride)] = lists[n][k];
      const int count = dropSides(v.view, 0, static_cast<int>(lists[n].size()), list.data(), stride);
      std::vector<int> found;
      for (int k = 0; k < count; ++k) found.push_back(list[static_cast<std::size_t>(k * stride)]);
      // an owner that is an edge keeps all of its partners; this one is a vertex
      EXPECT_EQ(found, kept[n]) << n << ", stride " << stride;
    }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
