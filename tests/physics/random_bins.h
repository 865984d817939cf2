#pragma once
/// Closed bins of every kind with random bodies thrown in and left to come to rest, and the invariants of
/// each.
#include <cstdint>
#include <string>

#include <rubble/rubble.h>

namespace rubble::test {

/// The bin that a seed gives.
struct Bin {
  std::string kind;  ///< of its walls
  Scene scene;
  int walls = 0;  ///< bodies [0, walls) are the bin; what is thrown in comes last
  Vec3 inner;     ///< half extents of the room inside, about `center` [m]
  Vec3 center;
  std::vector<double> size;       ///< of each body beyond the walls: diameter of its bounding sphere [m]
  std::vector<double> thickness;  ///< likewise: its smallest width [m]
  double dt = 1. / 60;            ///< [s]
  int iterations = 4;
};
Bin randomBin(std::uint64_t seed);

/// Outcome after ten seconds.
struct BinOutcome {
  int outside = 0;    ///< bodies that left
  int restless = 0;   ///< bodies that move
  int unsettled = 0;  ///< of these, bodies with a speed above ten times the bound
  double
      depth = 0;  ///< largest penetration in the last two seconds, over the thickness of the thinner body [1]
  double depthMetres = 0;  ///< the same [m]
  double energyGain = 0;   ///< largest rise of the energy above its start, over the kinetic energy of the
                           ///< start [1]
  int quarantined = 0;
  bool holds() const;
  std::string what;  ///< for a log
};
BinOutcome settle(const Bin& bin, const std::string& backend = "cpu", int threads = 1);

}  // namespace rubble::test
