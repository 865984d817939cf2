/// Worlds that are made and edited at random keep their promises, and have the same bits at one and at three
/// threads, and beside objects far away that stand still or move.
#include "tests/fuzz/target.h"
#include "tests/fuzz/world_script.h"

namespace rubble::fuzz {

namespace {

void runScript(ByteSource in, ScriptOptions options, bool withThreeThreads, bool withCompany) {
  WorldScript one(in, options);
  one.run();
  if (withCompany) {
    options.company = Company::Still;
    WorldScript alone(in, options);
    options.company = Company::Moving;
    WorldScript beside(in, options);
    alone.run(), beside.run();
    expect(!alone.isLocal() || !beside.isLocal() || alone.end() == beside.end(),
           "objects far away change bits");
    options.company = Company::None;
  }
  if (!withThreeThreads) return;
  options.threads = 3;
  WorldScript three(in, options);
  three.run();
  expect(one.errors() == three.errors(), "three threads give other Errors than one");
  expect(one.trace() == three.trace(), "three threads give other bits than one");
}

}  // namespace

/// The first byte chooses the backend of the program in the others. One in 32 is long: a claim that fails at
/// random mostly fails early. One in eight runs with three threads too, one in 16 with company.
void testInput(std::span<const std::uint8_t> bytes) {
  ByteSource in(bytes);
  const std::string backend = in.below(8) == 7 ? "reference" : "cpu";
  const unsigned lot = lotOf(bytes, 256);
  const bool isLong = lot < 8, withThreeThreads = isReplay() || lot % 8 == 0,
             withCompany = isReplay() || lot % 16 == 3;
  if (isReplay() || !isLong) runScript(in, {.backend = backend}, withThreeThreads, withCompany);
  if (isReplay() || isLong)
    runScript(in, {.backend = backend, .mostCommands = 64, .mostSteps = 60}, withThreeThreads, withCompany);
}

}  // namespace rubble::fuzz
