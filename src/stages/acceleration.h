#pragma once
/// Chebyshev acceleration of the sweeps over solids (Wang 2015; for block descent over vertices Chen et al. 2024). Two iterations, there and back, are a
/// symmetric smoother E whose eigenvalues lie in [0, 1). With R the one up to which they are to vanish, g = 2 / (2 - R) and s = R / (2 - R):
///
///   y_(m+1) = y_(m-1) + w_(m+1) (g (E y_m - y_m) + y_m - y_(m-1)),    w_(m+1) = 1 / (1 - s^2 w_m / 4),    w_1 = 1, w_2 = 1 / (1 - s^2 / 2)
///
/// Vertices with contacts or attachments, whose multipliers and cones change from one iteration to the next, take no part, nor do those without
/// tetrahedra; nor does the last pair, which has the last word on momentum.
#include "stages/vertex_graph.h"
#include "stages/vertices.h"

namespace rubble::RUBBLE_CORE {

struct AccelerateVertices {
  static constexpr const char* kName = "acceleration";
  int pair;            ///< m
  Real weight, share;  ///< w_(m+1), g
  RUBBLE_HD void operator()(const View& s, int v) const {
    if (s.tetraCornerOffset[v] == s.tetraCornerOffset[v + 1]) return;
    const Vec3 own = s.vertexMoved[v], present = s.pastVertex[v].moved[pair % 2];
    Vec3& past = s.pastVertex[v].moved[(pair + 1) % 2];
    Vec3 next = own;
    if (s.pointEntryOffset[v] == s.pointEntryOffset[v + 1] && !isAttached(s, v)) {
      const Vec3 step = share * (own - present);
      next = pair == 0 ? present + step : past + weight * (step + (present - past));
      moveVertexTo(s, v, next);
    }
    past = next;
  }
};

/// After iteration n, which ends a pair. `rho`: spectral radius of one sweep.
inline AccelerateVertices accelerationAfter(const StepConstants& c, int n) {
  const Real r = c.acceleration * c.acceleration, s = r / (2 - r);
  const int pair = n / 2;
  Real weight = 1;
  for (int m = 1; m <= pair; ++m) weight = m == 1 ? 1 / (1 - s * s / 2) : 1 / (1 - s * s * weight / 4);
  return {pair, weight, 2 / (2 - r)};
}

}  // namespace rubble::RUBBLE_CORE
