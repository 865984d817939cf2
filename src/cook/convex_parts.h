#pragma once
/// Approximate convex decomposition of solids.
#include "cook/solid_cut.h"

namespace rubble {

/// A solid with its hull.
struct HulledSolid {
  CutSolid solid;
  std::vector<Vec3> hull;  ///< corners
  double hullVolume = 0;   ///< [m3]
  double volume = 0;       ///< of the solid [m3]

  double excess() const { return hullVolume - volume; }
};
/// Without a hull (no points, volume 0) if the solid is flat or empty.
HulledSolid hulled(CutSolid solid);

/// Cuts the solids whose hulls exceed them most, until the excess of all together is at most `excess` [m3] or
/// there are `most` of them.
void cutUntilConvex(std::vector<HulledSolid>& solids, double excess, std::size_t most);

}  // namespace rubble
