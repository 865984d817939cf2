/// Incidence lists and colors on chains, stars and piles.
#include "tests/support/core_world.h"

#include <algorithm>

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

BodyDef cube(const Vec3& position, double half = .5) {
  BodyDef body;
  body.shape = Shape::box({half, half, half});
  body.position = position;
  return body;
}

/// Contacts, joints and incidence of the present state.
void findGraph(CoreWorld& world) {
  world.begin();
  CpuExecutor& e = world.executor();
  pairs::find(e);
  contacts::prepare(e);
  e.forEach(BeginJoints<BallJoint>{}, world.view().joints[0]);
  bodies::findIncidence(e);
}

const JointSpec<BallJoint>& ball(const SolverData& s, int i) { return s.specsOf<BallJoint>()[i]; }

/// Row blocks between two dynamic bodies, each once, from the tables of rows and not from the incidence
/// lists.
std::vector<std::pair<int, int>> edges(const SolverData& s) {
  std::vector<std::pair<int, int>> out;
  const auto dynamic = [&](int i) { return i != kWorldBody && s.params[i].kind == BodyKind::Dynamic; };
  for (int i = 0; i < s.counters->manifolds; ++i)
    if (dynamic(s.contact[i].a) && dynamic(s.contact[i].b)) out.emplace_back(s.contact[i].a, s.contact[i].b);
  for (int i = 0; i < s.joints[0]; ++i)
    if (ball(s, i).alive && dynamic(ball(s, i).a) && dynamic(ball(s, i).b))
      out.emplace_back(ball(s, i).a, ball(s, i).b);
  return out;
}

void expectProper(const SolverData& s, std::size_t atLeastEdges) {
  const auto list = edges(s);
  EXPECT_GE(list.size(), atLeastEdges);
  for (const auto& [a, b] : list) EXPECT_NE(s.color[a], s.color[b]) << a << " " << b;
  EXPECT_EQ(s.counters->clashes, 0);
  // every dynamic body is in the list of its color, once
  std::vector<int> seen(static_cast<std::size_t>(s.bodies), 0);
  for (int c = 0; c < s.counters->colors; ++c)
    for (int k = s.colorOffset[c]; k < s.colorOffset[c + 1]; ++k) {
      EXPECT_EQ(s.color[s.colorBody[k]], c);
      ++seen[static_cast<std::size_t>(s.colorBody[k])];
    }
  for (int i = 0; i < s.bodies; ++i)
    EXPECT_EQ(seen[static_cast<std::size_t>(i)], s.params[i].kind == BodyKind::Dynamic) << i;
}

void expectIncidence(const SolverData& s) {
  std::vector<std::vector<std::uint32_t>> expected(static_cast<std::size_t>(s.bodies));
  const auto add = [&](int type, int index, int a, int b) {
    if (a != kWorldBody && s.params[a].kind == BodyKind::Dynamic)
      expected[static_cast<std::size_t>(a)].push_back(constraintCode(type, index, 0));
    if (b != kWorldBody && s.params[b].kind == BodyKind::Dynamic)
      expected[static_cast<std::size_t>(b)].push_back(constraintCode(type, index, 1));
  };
  for (int i = 0; i < s.counters->manifolds; ++i) add(kContactType, i, s.contact[i].a, s.contact[i].b);
  for (int i = 0; i < s.joints[0]; ++i)
    if (ball(s, i).alive && !s.jointsOf<BallJoint>()[i].broken) add(1, i, ball(s, i).a, ball(s, i).b);
  for (int i = 0; i < s.bodies; ++i) {
    auto& codes = expected[static_cast<std::size_t>(i)];
    std::sort(codes.begin(), codes.end());
    ASSERT_EQ(static_cast<std::size_t>(s.incidenceOffset[i + 1] - s.incidenceOffset[i]), codes.size()) << i;
    for (std::size_t k = 0; k < codes.size(); ++k) {
      const Incidence& e = s.incidence[s.incidenceOffset[i] + static_cast<int>(k)];
      ASSERT_EQ(e.code, codes[k]) << "body " << i;
      const int index = constraintIndex(e.code);
      const bool contact = constraintType(e.code) == kContactType;
      const int a = contact ? s.contact[index].a : ball(s, index).a,
                b = contact ? s.contact[index].b : ball(s, index).b;
      const int other = constraintSide(e.code) == 0 ? b : a;
      EXPECT_EQ(constraintSide(e.code) == 0 ? a : b, i);
      EXPECT_EQ(e.other, other != kWorldBody && s.params[other].kind == BodyKind::Dynamic ? other : -1);
    }
  }
}

void buildChain(CoreWorld& world, int links) {
  for (int i = 0; i < links; ++i) world.add(cube({10. * i, 0, 0}));
  for (int i = 0; i + 1 < links; ++i) world.addBall(i, i, i + 1);
  world.finish();
}

TEST(Coloring, ColorsAChainInAFewRounds) {
  CoreWorld world;
  buildChain(world, 5000);
  findGraph(world);
  bodies::color(world.executor());
  expectProper(world.view(), 4999);
  EXPECT_LE(world.view().counters->colors, 4);
  EXPECT_LE(world.view().counters->rounds, 15);
}

TEST(Coloring, OfAStarWithFiveHundredNeighborsNeedsTwoColors) {
  CoreWorld world;
  world.add(cube({0, 0, 100}));
  for (int i = 0; i < 500; ++i) {
    world.add(cube({10. * i, 0, 0}));
    world.addBall(i, 0, i + 1);
  }
  world.finish();
  findGraph(world);
  expectIncidence(world.view());
  bodies::color(world.executor());
  expectProper(world.view(), 500);
  EXPECT_LE(world.view().counters->colors, 3);
}

TEST(Coloring, OfACliqueNeedsAsManyColorsAsBodies) {
  // more than a word of 64 bits holds
  CoreWorld world;
  constexpr int kBodies = 80;
  for (int i = 0; i < kBodies; ++i) world.add(cube({10. * i, 0, 0}));
  int joint = 0;
  for (int i = 0; i < kBodies; ++i)
    for (int j = 0; j < i; ++j) world.addBall(joint++, i, j);
  world.finish();
  findGraph(world);
  bodies::color(world.executor());
  expectProper(world.view(), kBodies * (kBodies - 1) / 2);
  EXPECT_EQ(world.view().counters->colors, kBodies);
}

/// A bonded pile of cubes on a plane: each touches up to 12 others.
void buildPile(CoreWorld& world) {
  BodyDef ground;
  ground.motion = Motion::Static;
  ground.shape = Shape::plane();
  world.add(ground);
  for (int z = 0; z < 10; ++z)
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 12; ++x)
        world.add(cube({1.001 * x + .5 * (z % 2), 1.001 * y + .3 * (z % 2), .5 + z}));
  world.finish();
}

TEST(Coloring, OfAPileIsProperAtAnyNumberOfThreads) {
  std::vector<int> first;
  for (const int threads : {1, 3}) {
    CoreWorld world(threads);
    buildPile(world);
    findGraph(world);
    expectIncidence(world.view());
    bodies::color(world.executor());
    expectProper(world.view(), 5000);
    EXPECT_LE(world.view().counters->colors, 20);
    const std::vector<int> colors = copyOf(world.view().color, world.view().bodies);
    if (first.empty()) first = colors;
    EXPECT_EQ(colors, first);
  }
}

/// Runs rounds of coloring until no body changes its color; returns their number.
int colorUntilKept(CoreWorld& world) {
  for (int step = 1;; ++step) {
    findGraph(world);
    bodies::color(world.executor());
    if (world.view().counters->rounds == 0 || step == 100) return step;
  }
}

TEST(Coloring, GoesDownToFewColorsStepByStep) {
  CoreWorld world;
  buildPile(world);
  // a proper start with a color for each body
  for (int i = 0; i < world.view().bodies; ++i) world.view().color[i] = i;
  EXPECT_LT(colorUntilKept(world), 100);
  expectProper(world.view(), 5000);
  EXPECT_LE(world.view().counters->colors, 12);
}

TEST(Coloring, KeepsColorsFromStepToStep) {
  CoreWorld world;
  buildPile(world);
  findGraph(world);
  bodies::color(world.executor());
  EXPECT_GT(world.view().counters->rounds, 1);
  EXPECT_LT(colorUntilKept(world), 20);
  const std::vector<int> before = copyOf(world.view().color, world.view().bodies);
  findGraph(world);
  bodies::color(world.executor());
  EXPECT_EQ(world.view().counters->rounds, 0);
  EXPECT_EQ(copyOf(world.view().color, world.view().bodies), before);
}

TEST(Coloring, RepairsAFewNewNeighborsInAFewRounds) {
  CoreWorld world;
  buildPile(world);
  findGraph(world);
  bodies::color(world.executor());
  Random random(1);
  const std::vector<int> before = copyOf(world.view().color, world.view().bodies);
  for (int i = 0; i < 30; ++i) world.addBall(i, 1 + random.below(700), 701 + random.below(700));
  findGraph(world);
  bodies::color(world.executor());
  expectProper(world.view(), 5000);
  EXPECT_LE(world.view().counters->rounds, 4);
  int changed = 0;
  for (std::size_t i = 0; i < before.size(); ++i) changed += before[i] != world.view().color[i];
  EXPECT_LE(changed, 60);
}

TEST(Incidence, LeavesOutWhatDoesNotMove) {
  CoreWorld world;
  BodyDef still = cube({0, 0, 0});
  still.motion = Motion::Static;
  world.add(still);
  world.add(cube({0, 0, 1}));
  BodyDef driven = cube({0, 0, 2});
  driven.motion = Motion::Kinematic;
  world.add(driven);
  world.addBall(0, kWorldBody, 1);
  world.finish();
  findGraph(world);
  const SolverData& s = world.view();
  expectIncidence(s);
  EXPECT_EQ(s.counters->incidences, 3);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(s.incidence[k].other, -1);
}

TEST(Incidence, LeavesOutBrokenAndRemovedJoints) {
  CoreWorld world;
  for (int i = 0; i < 3; ++i) world.add(cube({10. * i, 0, 0}));
  for (int i = 0; i < 3; ++i) world.addBall(i, i, (i + 1) % 3);
  world.finish();
  world.view().jointsOf<BallJoint>()[0].broken = true;
  world.view().specsOf<BallJoint>()[1].alive = false;
  findGraph(world);
  EXPECT_EQ(world.view().counters->incidences, 2);
  EXPECT_EQ(constraintIndex(world.view().incidence[0].code), 2);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
