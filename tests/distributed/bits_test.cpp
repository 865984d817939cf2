/// Worlds on ranks have the bits of worlds on one engine: for every scene, at any number of ranks, whoever
/// owns what.
#include <gtest/gtest.h>
#include <scenes/registry.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>

#include "tests/physics/random_bins.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

scenes::Job jobOf(const std::string& name) {
  const scenes::Spec& spec = scenes::find(name);
  scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
  job.probes.clear();
  return job;
}

scenes::Job jobOf(std::uint64_t seed) {
  const test::Bin bin = test::randomBin(seed);
  scenes::Job job;
  job.scene = bin.scene;
  job.iterations = bin.iterations;
  job.dt = bin.dt;
  return job;
}

using Maker = std::function<scenes::Job()>;
template <class Name> Maker maker(Name name) {
  return [name] { return jobOf(name); };
}

/// Options of a job on one engine.
WorldOptions optionsOf(const scenes::Job& job) {
  WorldOptions options = test::options(job.iterations);
  options.params.substeps = job.substeps;
  options.params.dt = job.dt;
  return options;
}
WorldOptions onRanks(WorldOptions options, int ranks, int cutInterval = 0,
                     RankExchange exchange = RankExchange::Messages) {
  options.backend = "distributed";
  options.ranks.count = ranks;
  options.ranks.cutInterval = cutInterval;
  options.ranks.exchange = exchange;
  return options;
}

/// Tables of one world whose hashes differ from those of the other.
std::string differences(const World& a, const World& b) {
  const std::vector<TableHash> x = a.tableHashes(), y = b.tableHashes();
  std::string out;
  for (std::size_t k = 0; k < x.size(); ++k)
    if (x[k].hash != y[k].hash) out += (out.empty() ? "" : ", ") + x[k].table;
  return out;
}

/// The bytes of positions, which every rank has: reading them gathers nothing.
std::uint64_t positionHash(World& world) {
  const ArrayView rows = world.array(StateArray::Position);
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto* bytes = static_cast<const unsigned char*>(rows.data);
  for (std::int64_t i = 0; i < rows.shape[0]; ++i)
    for (std::int64_t k = 0; k < 24; ++k) hash = (hash ^ bytes[i * rows.strides[0] + k]) * 0x100000001b3u;
  return hash;
}

/// What a report counts.
std::vector<double> countsOf(const StepReport& r) {
  return {1. * r.pairs,          1. * r.manifolds,     1. * r.contacts,         1. * r.recycled,
          1. * r.colors,         1. * r.clashes,       1. * r.vertexContacts,   1. * r.brokenJoints,
          1. * r.sleepingBodies, 1. * r.stoppedBodies, 1. * r.quarantined,      1. * r.failedSolves,
          1. * r.boundedSteps,   1. * r.spinLimited,   1. * r.unsettledImpacts, r.unfinishedMotion};
}

/// Steps of a scene on one engine: counts and positions of every step, all tables of some.
struct Course {
  std::vector<std::vector<double>> counts;
  std::vector<std::uint64_t> positions;
  std::map<int, std::vector<TableHash>> tables;

  /// Between steps of full comparison ranks keep what others do not have, which moves with its bodies.
  static bool comparesTables(int step, int steps) { return step % 7 == 4 || step + 1 == steps; }

  Course(const Maker& make, const WorldOptions& options, int steps) {
    scenes::Runner runner(make(), options);
    for (int i = 0; i < steps; ++i) {
      counts.push_back(countsOf(runner.step()));
      positions.push_back(positionHash(runner.world()));
      if (comparesTables(i, steps)) tables[i] = runner.world().tableHashes();
    }
  }
  /// The first difference of another run, or "".
  std::string differenceOf(const Maker& make, const WorldOptions& options) const {
    scenes::Runner runner(make(), options);
    const int steps = static_cast<int>(counts.size());
    for (int i = 0; i < steps; ++i) {
      const std::size_t k = static_cast<std::size_t>(i);
      const std::string at = "step " + std::to_string(i) + ": ";
      const std::vector<double> own = countsOf(runner.step());
      for (std::size_t c = 0; c < own.size(); ++c)
        if (own[c] != counts[k][c]) return at + "count " + std::to_string(c);
      if (positionHash(runner.world()) != positions[k]) return at + "positions";
      if (!comparesTables(i, steps)) continue;
      std::string tablesThatDiffer;
      const std::vector<TableHash> now = runner.world().tableHashes();
      for (std::size_t t = 0; t < now.size(); ++t)
        if (now[t].hash != tables.at(i)[t].hash) tablesThatDiffer += " " + now[t].table;
      if (!tablesThatDiffer.empty()) return at + "tables" + tablesThatDiffer;
    }
    return "";
  }
};

struct Sample {
  const char* scene;
  int steps, ranks, cutInterval;
};
/// One scene per subsystem, at numbers of ranks that divide nothing evenly.
class ScenesOnRanks : public ::testing::TestWithParam<Sample> {};
TEST_P(ScenesOnRanks, HaveTheBitsOfOne) {
  const Sample sample = GetParam();
  const Maker make = maker<std::string>(sample.scene);
  const WorldOptions options = optionsOf(make());
  const Course one(make, options, sample.steps);
  for (const RankExchange exchange :
       {RankExchange::Messages, RankExchange::StoresInTurns, RankExchange::Letters})
    EXPECT_EQ(one.differenceOf(make, onRanks(options, sample.ranks, sample.cutInterval, exchange)), "")
        << static_cast<int>(exchange);
}
INSTANTIATE_TEST_SUITE_P(Samples, ScenesOnRanks,
                         ::testing::Values(Sample{"pile-1k", 10, 3, 2}, Sample{"gables", 8, 7, 3},
                                           Sample{"ring-5k", 8, 4, 0}, Sample{"chains", 8, 3, 2},
                                           Sample{"ragdolls", 8, 4, 3}, Sample{"gear-train", 10, 2, 2},
                                           Sample{"break-row", 10, 3, 4}, Sample{"bounce-ladder", 12, 3, 2},
                                           Sample{"bullet-plate", 12, 2, 1}, Sample{"tumbler", 8, 3, 2},
                                           Sample{"rolling", 8, 2, 3}, Sample{"every-shape", 8, 3, 2},
                                           Sample{"sleepers", 40, 3, 6}, Sample{"soft-blocks", 6, 3, 2},
                                           Sample{"mixed-trampoline", 6, 4, 2}, Sample{"jenga", 4, 3, 0},
                                           Sample{"silo", 26, 2, 0}, Sample{"tower-40", 12, 3, 2}),
                         [](const auto& info) {
                           std::string name = info.param.scene;
                           std::erase_if(name, [](unsigned char c) { return !std::isalnum(c); });
                           return name;
                         });

/// Loops are long enough to be divided.
TEST(Ranks, OfSeveralThreadsHaveTheBitsOfOne) {
  const Maker make = [] {
    const scenes::Spec& spec = scenes::find("pile-10k");
    scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, {{"levels", 16}}));
    job.probes.clear();
    return job;
  };
  WorldOptions options = optionsOf(make());
  const Course one(make, options, 3);
  options.threads = 6;
  for (const RankExchange exchange : {RankExchange::Messages, RankExchange::Stores, RankExchange::Letters})
    EXPECT_EQ(one.differenceOf(make, onRanks(options, 2, 2, exchange)), "") << static_cast<int>(exchange);
}

TEST(Ranks, ThatStoreAreNotMoreThanABodyHasBitsFor) {
  const scenes::Job job = jobOf("break-row");
  for (const RankExchange exchange : {RankExchange::Stores, RankExchange::Letters})
    EXPECT_THROW(World(job.scene, onRanks(optionsOf(job), 33, 0, exchange)), Error);
}

TEST(Ranks, KeepTheBitsThroughEdits) {
  World one(test::heap(4), test::options(4)), team(test::heap(4), onRanks(test::options(4), 3, 3));
  for (int i = 0; i < 24; ++i) {
    for (World* world : {&one, &team}) {
      if (i == 3) world->removeBody(world->bodyAt(5)), world->removeBody(world->bodyAt(20));
      if (i % 4 == 1) world->addBody(test::unitCube({.3 * i, .1 * i, 5}));
      if (i == 9) world->applyImpulse(world->bodyAt(12), {1, 2, 3});
      if (i == 11) world->sortBodies();
      if (i == 14) world->setGravity({0, 1, -10});
      if (i == 16) world->setState(world->bodyAt(30), {{0, 0, 9}, {}, {}, {}});
      world->step();
    }
    ASSERT_EQ(positionHash(one), positionHash(team)) << i;
    if (i % 5 == 4) {
      ASSERT_EQ(differences(one, team), "") << i;
    }
  }
  EXPECT_EQ(one.hash(), team.hash());
}

/// Cubes in one another, across a border of cells: those of higher number find the others, which own the
/// pairs.
TEST(Ranks, FindMorePartnersForOneAnotherThanABodyHasSlotsFor) {
  Scene scene = test::emptyScene();
  for (int i = 0; i < 48; ++i) scene.bodies.push_back(test::unitCube({1.47 - 0.02 * i, 0, 2}));
  for (const RankExchange exchange :
       {RankExchange::Stores, RankExchange::StoresInTurns, RankExchange::Letters}) {
    World one(scene, test::options(4)), team(scene, onRanks(test::options(4), 3, 1, exchange));
    for (World* world : {&one, &team}) EXPECT_GT(world->step().pairs, 48 * 20);
    EXPECT_EQ(differences(one, team), "") << static_cast<int>(exchange);
  }
}

TEST(Ranks, GoOnFromTheBytesOfASnapshot) {
  World whole(test::heap(4), test::options(4)), part(test::heap(4), onRanks(test::options(4), 3, 2));
  test::run(whole, 30), test::run(part, 20);
  const std::vector<std::byte> state = part.snapshot().bytes();
  for (const int ranks : {0, 2, 5}) {
    World rest(test::heap(4), ranks > 0 ? onRanks(test::options(4), ranks) : test::options(4));
    rest.restore(Snapshot::fromBytes(state));
    EXPECT_EQ(rest.stepCount(), 20);
    test::run(rest, 10);
    EXPECT_EQ(rest.hash(), whole.hash()) << ranks;
  }
}

TEST(Ranks, TakeSnapshotsOfOneAnother) {
  World one(test::heap(3), test::options(4)), two(test::heap(3), onRanks(test::options(4), 2)),
      three(test::heap(3), onRanks(test::options(4), 3));
  test::run(one, 20), test::run(two, 20);
  three.restore(two.snapshot());
  for (World* world : {&one, &two, &three}) test::run(*world, 10);
  EXPECT_EQ(one.hash(), two.hash());
  EXPECT_EQ(one.hash(), three.hash());
}

/// Bodies that fly through one-way shelves of many parts, from all sides and along them, below solid roofs:
/// in a row that ranks divide.
scenes::Job shelvesJob(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto from = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  Material oneWay;
  oneWay.oneWay = {0, 0, 1};
  std::vector<ShapePartDef> parts{{Shape::box({2, 1, 0.02}), {0, 0, 2}, {}}};
  for (int k = 0; k < 8; ++k)
    parts.push_back({Shape::box({0.25, 1, 0.1}), {0.5 * k - 1.75, 0, -0.1}, {}, oneWay});
  const Shape shelf = Shape::compound(parts);
  const Shape dumbbell = Shape::compound(
      {{Shape::sphere(0.2), {0.4, 0, 0}, {}}, {Shape::box({0.2, 0.1, 0.2}), {-0.4, 0, 0}, {}}});
  scenes::Job job;
  job.scene = test::emptyScene();
  for (int i = 0; i < 8; ++i) {
    job.scene.bodies.push_back(test::body(shelf, {4.1 * i, 0, 2}));
    job.scene.bodies.back().motion = Motion::Static;
    for (int k = 0; k < 4; ++k) {
      const Vec3 at{4.1 * i + from(-1.5, 1.5), from(-0.8, 0.8), k < 2 ? 2 + from(-2, 1) : from(1.6, 2.1)};
      job.scene.bodies.push_back(test::body(k == 0 ? dumbbell : Shape::sphere(0.2), at));
      const Vec3 ways[] = {{10, 0, 60}, {10, 0, 20}, {120, 0, 3}, {120, 0, 3}};
      for (int axis = 0; axis < 3; ++axis)
        job.scene.bodies.back().velocity[axis] = from(-1, 1) * ways[k][axis];
      job.scene.bodies.back().angularVelocity = {from(-9, 9), from(-9, 9), 0};
    }
  }
  job.iterations = 6;
  return job;
}

TEST(Ranks, AgreeOnWhatPassesOneWaySurfaces) {
  // in 65 a body changes its rank while the parts that it has touched no longer make pairs with it
  for (std::uint64_t seed = 60; seed < 70; ++seed) {
    const Maker make = [seed] { return shelvesJob(seed); };
    const WorldOptions options = optionsOf(make());
    const Course alone(make, options, 24);
    EXPECT_EQ(alone.differenceOf(make, onRanks(options, 2 + int(seed % 3), 1)), "") << seed;
  }
}

TEST(Ranks, OwnAllBodiesAndReportTheirCosts) {
  World world(test::heap(8), onRanks(test::options(4), 4, 5));
  StepReport report;
  std::int64_t migrated = 0;
  for (int i = 0; i < 40; ++i) {
    report = world.step();
    for (const RankReport& rank : report.ranks) migrated += rank.migrated;
  }
  ASSERT_EQ(report.ranks.size(), 4u);
  int bodies = 0;
  for (const RankReport& rank : report.ranks) {
    bodies += rank.bodies;
    EXPECT_GT(rank.bodies, 0);
    EXPECT_GT(rank.ghosts, 0);
    EXPECT_GT(rank.bytes, 0);
  }
  EXPECT_EQ(bodies, 128);
  EXPECT_GT(migrated, 0);
}

// Long: every scene, every number of ranks.

RankExchange exchangeByStores(int ranks) {
  return ranks % 2 == 0 ? RankExchange::Stores : RankExchange::StoresInTurns;
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const scenes::Spec& spec : scenes::registry()) out.push_back(spec.name);
  return out;
}
class LongRanks : public ::testing::TestWithParam<std::string> {};
TEST_P(LongRanks, HaveTheBitsOfOne) {
  const Maker make = maker(GetParam());
  const WorldOptions options = optionsOf(make());
  const Course one(make, options, 32);
  for (const int ranks : {1, 2, 3, 4, 7})
    for (const int cutInterval : ranks == 3 ? std::vector{1, 5} : std::vector{0})
      for (const RankExchange exchange : {RankExchange::Messages, exchangeByStores(ranks)})
        EXPECT_EQ(one.differenceOf(make, onRanks(options, ranks, cutInterval, exchange)), "")
            << ranks << " ranks, cut interval " << cutInterval << ", exchange " << static_cast<int>(exchange);
}
INSTANTIATE_TEST_SUITE_P(LongRegistry, LongRanks, ::testing::ValuesIn(names()), [](const auto& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
});

TEST(LongRandomScenes, HaveTheBitsOfOneOnRanks) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Maker make = maker(seed);
    WorldOptions options = optionsOf(make());
    options.params.sleeping = seed % 3 == 0;
    options.params.sortInterval = seed % 4 == 0 ? 10 : 0;
    const Course one(make, options, 60);
    const int ranks = 2 + static_cast<int>(seed % 4), cutInterval = static_cast<int>(seed % 3) * 4;
    EXPECT_EQ(one.differenceOf(make, onRanks(options, ranks, cutInterval)), "") << seed;
  }
}

}  // namespace
}  // namespace rubble
