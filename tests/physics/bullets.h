#pragma once
/// Bodies of every kind thrown at plates of every kind, and the outcome.
#include <cstdint>
#include <string>

#include <rubble/rubble.h>

namespace rubble::test {

/// What a seed stands for: body 0 is a plate across z whose front is at z > 0, body 1 is thrown at it from
/// there.
struct Throw {
  std::string bullet, plate;
  Scene scene;
  double speed = 0;      ///< [m/s]
  double reach = 0;      ///< radius of a sphere that holds the bullet [m]
  double halfWidth = 0;  ///< of the plate [m]
  double dt = 1. / 60;   ///< [s]
  int iterations = 4;
};
Throw randomThrow(std::uint64_t seed);

struct ThrowOutcome {
  bool passed = false;  ///< the bullet is behind the plate
  double gain = 0;      ///< of kinetic energy, over that of the start [1]
};
ThrowOutcome take(const Throw& shot, const std::string& backend = "cpu");

}  // namespace rubble::test
