/// Threads of builds without oneTBB, and the names of kernels in the signatures of compilers.
#include <gtest/gtest.h>

#include <chrono>
#include <numeric>
#include <stdexcept>

#include "platform/team.h"
#include "stages/executor.h"
#include "tests/backend/counted_memory.h"

namespace rubble {
namespace {

constexpr int kThreads = 4;

TEST(Team, DoesEachTaskOnce) {
  Team team(kThreads);
  for (std::size_t count = 0; count < 300; ++count) {
    std::vector<int> done(count);
    team.run(count, [&](std::size_t k) { ++done[k]; });
    EXPECT_EQ(std::accumulate(done.begin(), done.end(), 0), static_cast<int>(count));
    EXPECT_TRUE(std::all_of(done.begin(), done.end(), [](int n) { return n == 1; }));
  }
}

TEST(Team, HasSeenAllWritesOfALoopBeforeTheNext) {
  Team team(kThreads);
  constexpr std::size_t kCount = 64;
  std::vector<long long> a(kCount, 1), b(kCount);
  long long expected = 1;
  for (int loop = 0; loop < 3000; ++loop, expected = (2 * expected) % 1000003) {
    // each task reads what others have written
    team.run(kCount, [&](std::size_t k) { b[k] = (a[k] + a[(k + 17) % kCount]) % 1000003; });
    std::swap(a, b);
  }
  for (const long long n : a) EXPECT_EQ(n, expected);
}

TEST(Team, RunsLoopsInsideOfTasksAndOfOtherTeams) {
  Team team(kThreads), other(kThreads);
  std::atomic<int> done{0};
  team.run(8, [&](std::size_t) {
    team.run(8, [&](std::size_t) { ++done; });
    other.run(8, [&](std::size_t) { ++done; });
  });
  EXPECT_EQ(done, 8 * 16);
}

TEST(Team, ServesTwoThreadsAtOnce) {
  Team team(kThreads);
  std::atomic<int> done{0};
  const auto work = [&] {
    for (int loop = 0; loop < 200; ++loop) team.run(16, [&](std::size_t) { ++done; });
  };
  std::thread second(work);
  work();
  second.join();
  EXPECT_EQ(done, 2 * 200 * 16);
}

TEST(Team, ThrowsAnExceptionOfATaskAndGoesOn) {
  Team team(kThreads);
  std::atomic<int> done{0};
  EXPECT_THROW(team.run(100,
                        [&](std::size_t k) {
                          ++done;
                          if (k % 10 == 3) throw std::runtime_error("a task");
                        }),
               std::runtime_error);
  EXPECT_EQ(done, 100);
  team.run(100, [&](std::size_t) { ++done; });
  EXPECT_EQ(done, 200);
}

TEST(Team, StartsAfterItHadNoMemoryForItsThreads) {
  Team team(2);
  std::atomic<int> done{0};
  {
    const test::FailingMemory none(0, true);
    team.run(2, [&](std::size_t) { ++done; });
  }
  EXPECT_EQ(done, 2);
  // each waits for the other, which another thread has to run
  std::atomic<int> begun{0};
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  team.run(2, [&](std::size_t) {
    ++begun;
    while (begun < 2 && std::chrono::steady_clock::now() < limit) std::this_thread::yield();
  });
  EXPECT_LT(std::chrono::steady_clock::now(), limit);
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
