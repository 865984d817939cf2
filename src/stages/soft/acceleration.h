#pragma once
/// Chebyshev acceleration of the sweeps over solids (Wang 2015; for block descent over vertices Chen et al.
/// 2024): an iteration extrapolates from the last but one,
///
///   y_n = y_(n-2) + w_n (x_n - y_(n-2)),    w_n = 4 / (4 - rho^2 w_(n-1)),    w = 2 / (2 - rho^2) at first
///
/// x_n: result of a sweep over y_(n-1); rho: estimated spectral radius of a sweep. Vertices with contacts or
/// attachments are excluded, because their multipliers and friction cones change between iterations. Vertices
/// without tetrahedra are excluded too, and so is the last iteration, which determines the momentum.
#include "stages/soft/vertex_graph.h"

namespace rubble::RUBBLE_CORE {

/// First accelerated iteration. The sweeps before it reduce the high-frequency error.
inline constexpr int kFirstAccelerated = 2;

/// Weight w of iteration n.
inline Real accelerationOf(Real rho, int n) {
  Real w = 1;
  for (int k = kFirstAccelerated; k <= n; ++k)
    w = k == kFirstAccelerated ? 2 / (2 - rho * rho) : 4 / (4 - rho * rho * w);
  return w;
}

struct AccelerateVertices {
  static constexpr const char* kStage = "acceleration";
  int iteration;
  Real weight;
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    if (s.tetraCornerOffset[v] == s.tetraCornerOffset[v + 1]) return;
    Vec3& previous = s.vertexIterates[v].moved[iteration % 2];
    Vec3 x = s.vertexMoved[v];
    if (iteration >= kFirstAccelerated && s.pointIncidenceOffset[v] == s.pointIncidenceOffset[v + 1]) {
      const Vec3 further = (weight - Real(1)) * (x - previous);
      x += further;
      s.vertexMoved[v] = x;
      s.vertexPlace[v] += further;
    }
    previous = x;
  }
};

}  // namespace rubble::RUBBLE_CORE
