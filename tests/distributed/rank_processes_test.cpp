/// A process shares worlds with others through one object at a time.
#include <backend/distributed/rank_processes.h>
#include <gtest/gtest.h>

#include <rubble/error.h>
#include <rubble/socket_ranks.h>

namespace rubble {
namespace {

TEST(RankProcesses, AreThoseOfOneObjectAtATime) {
  EXPECT_EQ(rankProcesses().count, 1);
  EXPECT_FALSE(rankProcesses().transport);
  const auto none = [](double) { return std::unique_ptr<Transport>(); };
  joinProcesses({3, none});
  EXPECT_EQ(rankProcesses().count, 3);
  EXPECT_THROW(joinProcesses({2, none}), Error);
  // before it looks for the other processes
  EXPECT_THROW(SocketRanks{}, Error);
  EXPECT_EQ(rankProcesses().count, 3);
  leaveProcesses();
  EXPECT_NO_THROW(requireNoProcesses());
  EXPECT_FALSE(rankProcesses().transport);
}

}  // namespace
}  // namespace rubble
