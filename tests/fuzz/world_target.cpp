/// Worlds that are made and edited at random keep their promises, and have the same bits at one and at three
/// threads.
#include "tests/fuzz/target.h"
#include "tests/fuzz/world_script.h"

namespace rubble::fuzz {

/// The first byte chooses the backend of the program in the others. One in 32 is long: a claim that fails at
/// random mostly fails early. One in eight runs with three threads too.
void testInput(std::span<const std::uint8_t> bytes) {
  ByteSource in(bytes);
  ScriptOptions options;
  if (in.below(8) == 7) options.backend = "reference";
  const unsigned lot = lotOf(bytes, 256);
  if (lot < 8) options.mostCommands = 64, options.mostSteps = 60;
  WorldScript one(in, options);
  one.run();
  if (lot % 8 != 0) return;
  options.threads = 3;
  WorldScript three(in, options);
  three.run();
  expect(one.errors() == three.errors(), "three threads give other Errors than one");
  expect(one.trace() == three.trace(), "three threads give other bits than one");
}

}  // namespace rubble::fuzz
