/// A rank that fails, or does not answer, ends the step of all with an error that names it.
#include <backend/distributed/rank_lists.h>
#include <backend/distributed/rank_team.h>
#include <cook/cook.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace rubble::RUBBLE_CORE {
namespace {

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}
template <class F> std::string failureOf(F&& f) {
  try {
    f();
  } catch (const RankFailure& failure) {
    return failure.what();
  }
  return "";
}

/// Three ranks with a row of cubes.
class RankFaults : public ::testing::Test {
 protected:
  RankFaults() : team_({.count = 3, .timeout = 30}, CpuOptions{.threads = 3, .timings = false}) {
    EngineSettings settings;
    settings.gravity = {0, 0, -10};
    team_.configure(settings);
    const Shape cube = Shape::box({.5, .5, .5});
    for (int i = 0; i < 30; ++i) {
      EngineBody body;
      body.kind = 3;
      body.shape = cook(cube).shape, body.radius = cook(cube).radius;
      const MassProperties mass = massProperties(cube, 1);
      body.mass = mass.mass, body.inertia = mass.inertia;
      body.state.position = {1. * i, 0, 0};
      static_cast<Engine&>(team_).apply(SetBody{i, body});
    }
  }
  void step() {
    StepReport report;
    team_.step(report);
  }
  RankTeam team_;
};

TEST_F(RankFaults, OfOneRankEndTheStepOfAllAndNameIt) {
  step();
  team_.rank(1).observe([](std::string_view, std::string_view kernel) {
    if (kernel == "FindPairs") throw std::runtime_error("lost its disk");
  });
  const auto begin = Clock::now();
  EXPECT_EQ(failureOf([&] { step(); }), "rank 1 failed: lost its disk");
  EXPECT_LT(secondsSince(begin), 5);
  // the world is lost, and says so
  EXPECT_EQ(failureOf([&] { step(); }), "rank 1 failed: lost its disk");
  EXPECT_EQ(failureOf([&] { team_.snapshot(); }), "rank 1 failed: lost its disk");
}

TEST(ThreadTransport, NamesARankThatDoesNotAnswer) {
  ThreadHub hub(2, .05);
  const auto end = hub.join(0);
  std::byte memory[4];
  const Transport::Receive receive{1, memory};
  EXPECT_EQ(failureOf([&] { end->exchange({}, {&receive, 1}); }), "rank 1 does not answer rank 0");
}

TEST(ThreadTransport, NamesAMessageOfAnotherLength) {
  ThreadHub hub(2, 10);
  const auto a = hub.join(0), b = hub.join(1);
  std::byte memory[4] = {};
  const Transport::Send send{1, std::span(memory).first(3)};
  a->exchange({&send, 1}, {});
  const Transport::Receive receive{0, memory};
  EXPECT_EQ(failureOf([&] { b->exchange({}, {&receive, 1}); }), "rank 0 sent 3 bytes, rank 1 expected 4");
}

/// check(end, rank) in a thread for each rank; returns how many errors they count.
template <class Check> int errorsOnRanks(int ranks, const Check& check) {
  ThreadHub hub(ranks, 30);
  std::vector<std::jthread> threads;
  std::atomic<int> wrong = 0;
  for (int r = 0; r < ranks; ++r) threads.emplace_back([&, r] { wrong += check(*hub.join(r), r); });
  threads.clear();
  return wrong;
}

constexpr int kRanks = 3;

TEST(ThreadTransport, KeepsTheOrderOfMessagesAndOfRanks) {
  constexpr int kRounds = 200;
  const auto check = [](Transport& end, int r) {
    int wrong = 0;
    for (int round = 0; round < kRounds; ++round) {
      // blocks of different lengths, some of them empty
      std::vector<std::size_t> sizes;
      for (int k = 0; k < kRanks; ++k) sizes.push_back(static_cast<std::size_t>((round + k) % 4));
      const std::vector<std::byte> own(sizes[static_cast<std::size_t>(r)], std::byte(round + r));
      std::vector<std::byte> all(sizes[0] + sizes[1] + sizes[2]), expected;
      for (int k = 0; k < kRanks; ++k)
        expected.insert(expected.end(), sizes[static_cast<std::size_t>(k)], std::byte(round + k));
      end.gather(own, all, sizes);
      wrong += all != expected;
    }
    return wrong;
  };
  EXPECT_EQ(errorsOnRanks(kRanks, check), 0);
}

/// Every rank asks for elements of the others, and receives these in the order in which it asked.
int errorsOfCouriers(int elements, int threads) {
  const auto check = [&](Transport& end, int r) {
    int wrong = 0;
    const std::size_t count = static_cast<std::size_t>(elements);
    RankCourier courier(end, threads);
    // element i belongs to rank i % kRanks, where it is i and 2 i
    std::vector<int> first(count, -1), small(count, 0);
    std::vector<double> second(count, -1);
    RankLists lists(kRanks);
    for (int i = r; i < elements; i += kRanks) first[std::size_t(i)] = i, second[std::size_t(i)] = 2 * i;
    std::vector<RankLists> needs(2, RankLists(kRanks));
    for (int i = 0; i < elements; ++i) {
      lists[std::size_t(i % kRanks)].push_back(i);
      small[std::size_t(i)] = i % kRanks == r ? i % 16 : 0;
      if (i % kRanks != r && i % (r + 2) == 0) needs[0][std::size_t(i % kRanks)].push_back(i);
    }
    const std::vector<RankTraffic> traffic = courier.ask(needs);
    courier.swap(traffic[0], first.data(), second.data());
    for (int i = 0; i < elements; ++i) {
      const bool has = i % kRanks == r || i % (r + 2) == 0;
      wrong += first[std::size_t(i)] != (has ? i : -1) || second[std::size_t(i)] != (has ? 2 * i : -1);
    }
    courier.gather(lists, first.data(), second.data());
    courier.gatherSmall<4>(small.data(), elements, [](int i) { return i % kRanks; });
    for (int i = 0; i < elements; ++i)
      wrong += first[std::size_t(i)] != i || second[std::size_t(i)] != 2 * i ||
               small[std::size_t(i)] != i % 16;
    return wrong;
  };
  return errorsOnRanks(kRanks, check);
}
TEST(RankCourier, BringsTheElementsThatWereAskedFor) {
  EXPECT_EQ(errorsOfCouriers(50, 1), 0);
  // several ranges
  EXPECT_EQ(errorsOfCouriers(3 * kLeastOfRange + 1, 3), 0);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
