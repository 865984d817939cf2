#pragma once
/// What a fuzz target is made of. A target implements testInput(); libFuzzer or replay.cpp calls it.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

namespace rubble::fuzz {

/// Tests one input. An Error of the engine is a correct answer; anything else ends the process.
void testInput(std::span<const std::uint8_t> bytes);
/// A replay: a program is run at every length that the target may choose, with all its claims. A fuzzer
/// mostly runs short ones with few.
bool isReplay();

/// Ends the process: a claim about the engine does not hold.
[[noreturn]] inline void fail(const std::string& claim) {
  std::fprintf(stderr, "fuzz: %s\n", claim.c_str());
  std::abort();
}
inline void expect(bool holds, const std::string& claim) {
  if (!holds) fail(claim);
}

}  // namespace rubble::fuzz
