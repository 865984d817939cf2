/// Threads of builds without oneTBB, and the names of kernels in the signatures of compilers.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "platform/team.h"
#include "stages/executor.h"
#include "tests/backend/counted_memory.h"

namespace rubble {
namespace {

constexpr int kOfTeam = 4;

/// task(k) for k = 0 .. n - 1 on a crew.
template <class Task> void forEach(Crew& crew, int n, const Task& task) {
  std::atomic<int> next{0};
  crew.run(crew.size(), [&](int) {
    for (int k; (k = next++) < n;) task(k);
  });
}

TEST(Team, DoesEachTaskOnce) {
  Team team(kOfTeam);
  for (int count = 0; count < 300; ++count) {
    std::vector<int> done(static_cast<std::size_t>(count));
    team.run([&](Crew& crew) { forEach(crew, count, [&](int k) { ++done[static_cast<std::size_t>(k)]; }); });
    EXPECT_TRUE(std::all_of(done.begin(), done.end(), [](int n) { return n == 1; }));
  }
}

TEST(Team, HasSeenAllWritesOfALoopBeforeTheNext) {
  Team team(kOfTeam);
  constexpr int kCount = 64;
  std::vector<long long> a(kCount, 1), b(kCount);
  long long expected = 1;
  team.run([&](Crew& crew) {
    for (int loop = 0; loop < 3000; ++loop, expected = (2 * expected) % 1000003) {
      // each task reads what others have written
      forEach(crew, kCount, [&](int k) {
        const auto at = [&](int i) { return static_cast<std::size_t>(i % kCount); };
        b[at(k)] = (a[at(k)] + a[at(k + 17)]) % 1000003;
      });
      std::swap(a, b);
    }
  });
  for (const long long n : a) EXPECT_EQ(n, expected);
}

TEST(Team, RunsOnTheCallingThreadAloneInsideOfALoopOfItsOwn) {
  Team team(kOfTeam), other(kOfTeam);
  std::atomic<int> done{0};
  team.run([&](Crew& crew) {
    forEach(crew, 8, [&](int) {
      team.run([&](Crew& inner) {
        EXPECT_EQ(inner.size(), 1);
        forEach(inner, 8, [&](int) { ++done; });
      });
      other.run([&](Crew& inner) { forEach(inner, 8, [&](int) { ++done; }); });
    });
  });
  EXPECT_EQ(done, 8 * 16);
}

TEST(Team, ServesTwoThreadsAtOnce) {
  Team team(kOfTeam);
  std::atomic<int> done{0};
  const auto work = [&] {
    for (int loop = 0; loop < 200; ++loop)
      team.run([&](Crew& crew) { forEach(crew, 16, [&](int) { ++done; }); });
  };
  std::thread second(work);
  work();
  second.join();
  EXPECT_EQ(done, 2 * 200 * 16);
}

TEST(Team, ThrowsTheFirstExceptionWhenAllIsDoneAndGoesOn) {
  Team team(kOfTeam);
  std::atomic<int> done{0};
  const auto run = [&](bool throws) {
    team.run([&](Crew& crew) {
      forEach(crew, 100, [&](int k) {
        ++done;
        if (throws && k % 10 == 3) throw std::runtime_error("a task");
      });
    });
  };
  EXPECT_THROW(run(true), std::runtime_error);
  EXPECT_EQ(done, 100);
  run(false);
  EXPECT_EQ(done, 200);
}

/// Of two tasks each waits for the other: do two threads run them?
bool areTwoAtWork(Crew& crew) {
  std::atomic<int> begun{0};
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  forEach(crew, 2, [&](int) {
    ++begun;
    while (begun < 2 && std::chrono::steady_clock::now() < limit) std::this_thread::yield();
  });
  return std::chrono::steady_clock::now() < limit;
}

TEST(Team, StartsAfterItHadNoMemoryForItsThreads) {
  Team team(2);
  std::atomic<int> done{0};
  {
    const test::FailingMemory none(0, true);
    team.run([&](Crew& crew) { forEach(crew, 2, [&](int) { ++done; }); });
  }
  EXPECT_EQ(done, 2);
  team.run([](Crew& crew) { EXPECT_TRUE(areTwoAtWork(crew)); });
}

TEST(Team, ComesAgainAfterALongRest) {
  Team team(2);
  team.run([&](Crew& crew) {
    EXPECT_TRUE(areTwoAtWork(crew));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // members leave
    EXPECT_TRUE(areTwoAtWork(crew));
  });
}

TEST(KernelName, IsReadFromSignaturesOfEachCompiler) {
  using RUBBLE_CORE::kernelNameIn;
  const char* const signatures[] = {
      "constexpr std::string_view rubble::f32::kernelName() [with Kernel = rubble::f32::SolveBody<float>; "
      "std::string_view = std::basic_string_view<char>]",
      "std::string_view rubble::f32::kernelName() [Kernel = rubble::f32::SolveBody<float>]",
      "class std::basic_string_view<char,struct std::char_traits<char> > __cdecl "
      "rubble::f32::kernelName<struct rubble::f32::SolveBody<float>>(void)"};
  for (const char* const signature : signatures) EXPECT_EQ(kernelNameIn(signature), "SolveBody");
  EXPECT_EQ(kernelNameIn("auto __cdecl rubble::kernelName<struct rubble::FillGrid>(void)"), "FillGrid");
  EXPECT_EQ(RUBBLE_CORE::kernelName<RUBBLE_CORE::AnyKernel>(), "AnyKernel");
}

}  // namespace
}  // namespace rubble
