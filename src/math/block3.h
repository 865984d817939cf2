#pragma once
/// The local problem of a vertex: three unknowns.
#include "math/sym.h"

namespace rubble::RUBBLE_CORE {

/// The 3x3 system H dx = f of one vertex [S 4].
struct Block3 {
  Sym3 h;    ///< [N/m]
  Vec3 f{};  ///< [N]

  RUBBLE_HD void addDiagonal(Real a) { h.xx += a, h.yy += a, h.zz += a; }
};

}  // namespace rubble::RUBBLE_CORE
