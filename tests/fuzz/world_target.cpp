/// Worlds that are made and edited at random keep their promises, and have the same bits at one and at three
/// threads.
#include "tests/fuzz/target.h"
#include "tests/fuzz/world_script.h"

namespace rubble::fuzz {

namespace {

void runScript(ByteSource in, ScriptOptions options, bool withThreeThreads) {
  WorldScript one(in, options);
  one.run();
  if (!withThreeThreads) return;
  options.threads = 3;
  WorldScript three(in, options);
  three.run();
  expect(one.errors() == three.errors(), "three threads give other Errors than one");
  expect(one.trace() == three.trace(), "three threads give other bits than one");
}

}  // namespace

/// The first byte chooses the backend of the program in the others. One in 32 is long: a claim that fails at
/// random mostly fails early. One in eight runs with three threads too.
void testInput(std::span<const std::uint8_t> bytes) {
  ByteSource in(bytes);
  const std::string backend = in.below(8) == 7 ? "reference" : "cpu";
  const unsigned lot = lotOf(bytes, 256);
  const bool isLong = lot < 8, withThreeThreads = isReplay() || lot % 8 == 0;
  if (isReplay() || !isLong) runScript(in, {.backend = backend}, withThreeThreads);
  if (isReplay() || isLong)
    runScript(in, {.backend = backend, .mostCommands = 64, .mostSteps = 60}, withThreeThreads);
}

}  // namespace rubble::fuzz
