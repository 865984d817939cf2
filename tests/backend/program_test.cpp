/// Programs that are written to, and what they leave of the process that starts them.
#include <gtest/gtest.h>

#include <csignal>
#include <string>

#include <rubble/error.h>

#include "platform/program.h"

namespace rubble {
namespace {

volatile std::sig_atomic_t brokenPipes = 0;
void countBrokenPipe(int) { brokenPipes = brokenPipes + 1; }

TEST(Program, ThatEndsEarlyLeavesTheSignalsOfTheProcessAsTheyAre) {
  const std::string program = platform::findProgram("true");
  if (program.empty()) GTEST_SKIP() << "no program of this name";
  struct sigaction own {
  }, before{}, after{};
  own.sa_handler = countBrokenPipe;
  sigaction(SIGPIPE, &own, &before);
  {
    platform::Program early(program, {"true"});
    const std::string bytes(1 << 20, 'x');
    EXPECT_FALSE(early.write(bytes.data(), bytes.size()));
    EXPECT_EQ(early.wait(), 0);
  }
  sigset_t blocked;
  pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  EXPECT_EQ(sigismember(&blocked, SIGPIPE), 0);
  sigaction(SIGPIPE, &before, &after);
  EXPECT_EQ(after.sa_handler, &countBrokenPipe);
  EXPECT_EQ(brokenPipes, 0);
}

TEST(Program, ThatDoesNotExistIsAnError) { EXPECT_THROW(platform::Program("/none/such", {"such"}), Error); }

}  // namespace
}  // namespace rubble
