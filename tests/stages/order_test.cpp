/// Bodies along a curve through space: where they go, and what follows them.
#include <gtest/gtest.h>

#include <stages/pairs/order.h>

#include <algorithm>
#include <random>

#include "tests/support/core_world.h"
#include "tests/support/scenes.h"

namespace rubble::RUBBLE_CORE {
namespace {

TEST(Curve, SpreadsEveryBitToItsOwnPlace) {
  for (int bit = 0; bit < 21; ++bit)
    EXPECT_EQ(spreadBits(std::uint64_t{1} << bit), std::uint64_t{1} << 3 * bit) << bit;
  EXPECT_EQ(spreadBits(~std::uint64_t{0}), 0x1249249249249249u);
}

/// Cubes of a lattice in any order, with a plane among them.
class SortedCubes : public ::testing::Test {
 protected:
  static constexpr int kSide = 8;

  SortedCubes() {
    std::vector<rubble::Vec3> places;
    for (int i = 0; i < kSide * kSide * kSide; ++i)
      places.push_back(rubble::Vec3{0, 0, .5} + 1.001 * rubble::Vec3{double(i % kSide) - 3,
                                                                     double(i / kSide % kSide) - 2,
                                                                     double(i / (kSide * kSide))});
    std::shuffle(places.begin(), places.end(), std::mt19937(1));
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (i == 100) world_.add(test::ground());
      world_.add(test::unitCube(places[i]));
    }
    world_.addBall(0, 3, 7);
    world_.finish({{2, 5}});
    for (int i = 0; i < 3; ++i) {
      world_.begin();
      step(world_.executor());
    }
  }
  SolverData& s() { return world_.view(); }
  void sort() { sortBodiesOf(world_.executor()); }

  CoreWorld world_;
};

TEST_F(SortedCubes, LieAlongTheCurve) {
  sort();
  for (int i = 0; i + 1 < s().bodies; ++i) EXPECT_LE(placeOnCurve(s(), i), placeOnCurve(s(), i + 1)) << i;
  for (int id = 0; id < s().bodies; ++id) EXPECT_EQ(s().idOf[s().placeOf[id]], id);
  // the plane is everywhere
  EXPECT_EQ(s().placeOf[100], world_.executor().tables().bodyIds - 1);
  EXPECT_EQ(s().planeBody[0], world_.executor().tables().bodyIds - 1);
}

TEST_F(SortedCubes, HaveNearPartnersNear) {
  const auto distance = [&] {
    double sum = 0, pairs = 0;
    for (int k = 0; k < s().oldPairOffset[s().bodies]; ++k) {
      const Pair p = s().oldPair[k];
      if (s().params[p.other].shape.kind == ShapeKind::Plane) continue;
      sum += std::abs(p.owner - p.other), ++pairs;
    }
    return sum / pairs;
  };
  const double before = distance();
  sort();
  EXPECT_LT(distance(), before / 3);
}

TEST_F(SortedCubes, KeepTheirPairsAndManifolds) {
  /// What a pair is, by ids. Its owner may be another.
  struct Known {
    int low, high, a, points;
    Real separation, load;
    auto operator<=>(const Known&) const = default;
  };
  const auto known = [&] {
    std::vector<Known> out;
    for (int i = 0; i < s().bodies; ++i)
      for (int k = s().oldPairOffset[i]; k < s().oldPairOffset[i + 1]; ++k) {
        const Pair p = s().oldPair[k];
        EXPECT_EQ(p.owner, i);
        const int m = manifoldOfOld(s(), k);
        Real load = 0;
        for (int j = 0; m >= 0 && j < kLanes; ++j) load += s().oldManifold[m].lambdaN[j];
        const int owner = s().idOf[p.owner], other = s().idOf[p.other];
        const int points = m < 0 ? -1 : s().oldManifold[m].count;
        out.push_back({std::min(owner, other), std::max(owner, other), s().idOf[ordered(p).a], points,
                       s().oldPairTest[k].separation, load});
      }
    std::sort(out.begin(), out.end());
    return out;
  };
  const std::vector<Known> before = known();
  sort();
  EXPECT_EQ(known(), before);
  EXPECT_TRUE(std::any_of(before.begin(), before.end(), [](const Known& k) { return k.load > 0; }));
}

TEST_F(SortedCubes, AreNamedByTheirNewPlaces) {
  sort();
  const JointSpec<BallJoint>& joint = s().specsOf<BallJoint>()[0];
  EXPECT_EQ(s().idOf[joint.a], 3);
  EXPECT_EQ(s().idOf[joint.b], 7);
  EXPECT_TRUE(isExcluded(s(), {2, 5}));
}

TEST_F(SortedCubes, FindTheSamePairsInTheNextStep) {
  const auto byId = [&] {
    std::set<std::pair<int, int>> out;
    for (const auto& [a, b] : world_.pairs()) {
      EXPECT_LT(s().idOf[a], s().idOf[b]);
      out.emplace(s().idOf[a], s().idOf[b]);
    }
    return out;
  };
  const auto before = byId();
  sort();
  EXPECT_EQ(byId(), before);
}

TEST(Owners, OfCornersFollowTheirBodyAndOthersStay) {
  int to[3] = {2, 0, 1};
  SolverData s{};
  s.vertices = 5, s.edges = 4;
  const NewPlaces places{nullptr, to};
  for (int owner = 0; owner < 9; ++owner) EXPECT_EQ(movedOwner(s, places, owner), owner);
  for (int body = 0; body < 3; ++body)
    for (int slot = 0; slot < kCornerSlots; ++slot)
      EXPECT_EQ(movedOwner(s, places, 9 + kCornerSlots * body + slot), 9 + kCornerSlots * to[body] + slot);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
