/// Objects never change the bits of another object that they do not touch.
#include <gtest/gtest.h>
#include <rubble/info.h>
#include <scenes/registry.h>

#include <algorithm>
#include <bit>
#include <cctype>

#include "tests/locality/visitors.h"
#include "tests/physics/random_bins.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kFewPebbles = 200, kManyPebbles = 3000;

/// How long a sample runs, and before which step its visitors leave.
struct Course {
  int steps, leaves;
};
constexpr Course kShort{45, 30}, kLong{200, 120};

/// A scene with its parameters, before it is a world.
struct Sample {
  scenes::Job job;
  WorldOptions options;
};

using Maker = std::function<Sample()>;

Sample sampleOf(const std::string& name) {
  const scenes::Spec& spec = scenes::find(name);
  Sample out{scenes::prepare(spec, scenes::resolve(spec, spec.testArguments)), {}};
  out.job.probes.clear();
  out.options = test::options(out.job.iterations);
  out.options.params.substeps = out.job.substeps;
  return out;
}

Sample sampleOf(std::uint64_t seed) {
  const test::Bin bin = test::randomBin(seed);
  Sample out;
  out.job.scene = bin.scene;
  out.job.dt = bin.dt;
  out.options = test::options(bin.iterations);
  out.options.params.dt = bin.dt;
  out.options.params.sortInterval = 40;
  return out;
}

class Hash {
 public:
  void add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
  void add(const Quat& q) { add(q.v), add(q.s); }
  std::uint64_t value() const { return value_; }

 private:
  void add(double x) {
    value_ = (value_ ^ std::bit_cast<std::uint64_t>(x)) * 0x100000001b3u + (value_ >> 29);
  }
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

/// Ids of what a scene has had from the beginning.
struct Originals {
  std::vector<BodyId> bodies;
  std::vector<DeformableId> deformables;
  std::uint64_t hashIn(const World& world) const {
    Hash h;
    for (const BodyId id : bodies) {
      if (!world.alive(id)) continue;
      const BodyState s = world.state(id);
      h.add(s.position), h.add(s.orientation), h.add(s.velocity), h.add(s.angularVelocity);
    }
    for (const DeformableId id : deformables) {
      if (!world.alive(id)) continue;
      for (const Vec3& x : world.positions(id)) h.add(x);
      for (const Vec3& v : world.velocities(id)) h.add(v);
    }
    return h.value();
  }
};

/// Distant bodies that have the ids of bodies which events add. They are removed just before, so that the
/// ids are the same with and without visitors.
class Reserve {
 public:
  Reserve(Scene& scene, const Vec3& at) : first_(static_cast<int>(scene.bodies.size())) {
    for (const Event& event : scene.events) {
      if (event.add.empty()) continue;
      batches_.push_back({event.step, static_cast<int>(event.add.size())});
      for (std::size_t k = 0; k < event.add.size(); ++k) {
        scene.bodies.push_back(test::body(Shape::sphere(.01), at));
        scene.bodies.back().motion = Motion::Static, scene.bodies.back().filter.mask = 0;
      }
    }
  }
  /// Before a step.
  void leave(World& world, std::int64_t step) {
    for (; next_ < batches_.size() && batches_[next_].step <= step; ++next_) {
      const int count = batches_[next_].count;
      // what is freed last is used first
      for (int k = count - 1; k >= 0; --k) world.removeBody(world.bodyAt(first_ + k));
      first_ += count;
    }
  }

 private:
  struct Batch {
    int step, count;
  };
  std::vector<Batch> batches_;
  std::size_t next_ = 0;
  int first_;
};

/// Hashes of what the sample has of itself after each step, with visitors that leave on the way.
std::vector<std::uint64_t> hashesOf(const Maker& make, const std::vector<test::Visitor>& guests,
                                    const std::string& backend, int threads, Course course) {
  Sample sample = make();
  sample.options.backend = backend, sample.options.threads = threads;
  Scene& scene = sample.job.scene;
  const int bodies = static_cast<int>(scene.bodies.size()),
            objects = static_cast<int>(scene.deformables.size());
  const Vec3 far = test::farFrom(scene);
  Reserve reserve(scene, far * -1);
  const int ownBodies = static_cast<int>(scene.bodies.size());
  for (std::size_t k = 0; k < guests.size(); ++k)
    guests[k].addTo(scene, far * (1 + .1 * static_cast<double>(k)));
  const int allBodies = static_cast<int>(scene.bodies.size()),
            allObjects = static_cast<int>(scene.deformables.size());
  scenes::Runner runner(std::move(sample.job), sample.options);
  World& world = runner.world();
  Originals own;
  for (int i = 0; i < bodies; ++i) own.bodies.push_back(world.bodyAt(i));
  for (int i = 0; i < objects; ++i) own.deformables.push_back(world.deformableAt(i));
  std::vector<BodyId> leaving;
  for (int i = ownBodies; i < allBodies; ++i) leaving.push_back(world.bodyAt(i));
  std::vector<std::uint64_t> out;
  for (int step = 0; step < course.steps; ++step) {
    if (step == course.leaves) {
      world.removeBodies(leaving);
      for (int i = objects; i < allObjects; ++i) world.removeDeformable(world.deformableAt(i));
    }
    reserve.leave(world, step);
    runner.step();
    out.push_back(own.hashIn(world));
  }
  return out;
}

/// Says in which step the first of two runs part.
::testing::AssertionResult same(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  const auto at = std::mismatch(a.begin(), a.end(), b.begin()).first;
  if (at == a.end()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "other bits after step " << at - a.begin();
}

/// No point far away is outside of all of its planes.
bool isEnclosed(const Maker& make) { return test::farFrom(make().job.scene) == Vec3{}; }

void expectLocal(const Maker& sample, Course course, const std::string& backend = "cpu") {
  if (isEnclosed(sample)) GTEST_SKIP() << "planes on all sides";
  EXPECT_TRUE(same(hashesOf(sample, {}, backend, 1, course),
                   hashesOf(sample, test::visitors(kFewPebbles), backend, 3, course)));
}
void expectLocalToEach(const Maker& sample) {
  if (isEnclosed(sample)) GTEST_SKIP() << "planes on all sides";
  const auto alone = hashesOf(sample, {}, "cpu", 1, kLong);
  for (const test::Visitor& v : test::visitors(kManyPebbles))
    EXPECT_TRUE(same(alone, hashesOf(sample, {v}, "cpu", 1, kLong))) << v.name;
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const scenes::Spec& spec : scenes::registry())
    if (std::find(spec.tags.begin(), spec.tags.end(), "scale") == spec.tags.end()) out.push_back(spec.name);
  return out;
}

std::string testName(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
}

Maker makerOf(const std::string& name) {
  return [name] { return sampleOf(name); };
}
Maker makerOf(int seed) {
  return [seed] { return sampleOf(static_cast<std::uint64_t>(seed)); };
}

class Locality : public ::testing::TestWithParam<std::string> {};
TEST_P(Locality, AllVisitorsAtOnceChangeNoBit) { expectLocal(makerOf(GetParam()), kShort); }
INSTANTIATE_TEST_SUITE_P(Registry, Locality, ::testing::ValuesIn(names()), testName);

class LocalityOfBins : public ::testing::TestWithParam<int> {};
TEST_P(LocalityOfBins, AllVisitorsAtOnceChangeNoBit) { expectLocal(makerOf(GetParam()), kShort); }
INSTANTIATE_TEST_SUITE_P(Random, LocalityOfBins, ::testing::Range(0, 12));

/// Visitors that are made first have the lower ids, which break ties otherwise: other bits, the same outcome.
class VisitorsMadeFirst : public ::testing::TestWithParam<int> {};
TEST_P(VisitorsMadeFirst, LeaveTheOutcome) {
  test::Bin bin = test::randomBin(static_cast<std::uint64_t>(GetParam()));
  Scene scene = test::withVisitorsFirst(bin.scene, test::visitors(kFewPebbles));
  if (scene.bodies.size() == bin.scene.bodies.size()) GTEST_SKIP() << "planes on all sides";
  bin.scene = std::move(scene);
  const test::BinOutcome out = test::settle(bin, "cpu", 1);
  EXPECT_EQ(out.outside, 0) << out.what;
  EXPECT_EQ(out.unsettled, 0);
  EXPECT_EQ(out.quarantined, 0);
}
INSTANTIATE_TEST_SUITE_P(Random, VisitorsMadeFirst, ::testing::Range(2, 4));
INSTANTIATE_TEST_SUITE_P(LongRandom, VisitorsMadeFirst, ::testing::Range(0, 40));

// The long suite: one visitor after another, and in double precision.

class LongLocality : public Locality {};
TEST_P(LongLocality, AllVisitorsAtOnceChangeNoBit) { expectLocal(makerOf(GetParam()), kLong); }
TEST_P(LongLocality, NoVisitorChangesABit) { expectLocalToEach(makerOf(GetParam())); }
TEST_P(LongLocality, AllVisitorsAtOnceChangeNoBitInDoublePrecision) {
  expectLocal(makerOf(GetParam()), kLong, "reference");
}
INSTANTIATE_TEST_SUITE_P(LongRegistry, LongLocality, ::testing::ValuesIn(names()), testName);

/// On a GPU the strict build alone promises bits: others add up in orders that the size of a world decides.
class LongCudaLocality : public Locality {};
TEST_P(LongCudaLocality, AllVisitorsAtOnceChangeNoBit) {
  const std::vector<std::string> features = buildInfo().features, engines = backends();
  const bool isStrict = std::any_of(features.begin(), features.end(), [](const std::string& f) {
    return f.find("strict") != std::string::npos;
  });
  if (!isStrict || std::find(engines.begin(), engines.end(), "cuda") == engines.end())
    GTEST_SKIP() << "no strict build, or no GPU";
  expectLocal(makerOf(GetParam()), kLong, "cuda");
}
INSTANTIATE_TEST_SUITE_P(LongRegistry, LongCudaLocality, ::testing::ValuesIn(names()), testName);

class LongLocalityOfBins : public LocalityOfBins {};
TEST_P(LongLocalityOfBins, AllVisitorsAtOnceChangeNoBit) { expectLocal(makerOf(GetParam()), kLong); }
TEST_P(LongLocalityOfBins, NoVisitorChangesABit) { expectLocalToEach(makerOf(GetParam())); }
TEST_P(LongLocalityOfBins, AllVisitorsAtOnceChangeNoBitInDoublePrecision) {
  expectLocal(makerOf(GetParam()), kLong, "reference");
}
INSTANTIATE_TEST_SUITE_P(LongRandom, LongLocalityOfBins, ::testing::Range(0, 60));

}  // namespace
}  // namespace rubble
