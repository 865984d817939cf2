/// Worlds that are made and edited at random keep their promises, and have the same bits at one and at three
/// threads.
#include "tests/fuzz/target.h"
#include "tests/fuzz/world_script.h"

namespace rubble::fuzz {

void testInput(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  const std::string backend = bytes.front() % 8 == 7 ? "reference" : "cpu";
  WorldScript one(bytes.subspan(1), backend, 1), three(bytes.subspan(1), backend, 3);
  one.run();
  three.run();
  expect(one.errors() == three.errors(), "three threads give other Errors than one");
  expect(one.trace() == three.trace(), "three threads give other bits than one");
}

}  // namespace rubble::fuzz
