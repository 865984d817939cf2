#pragma once
/// Bending of cloth across an edge and of strands at a vertex.
///
/// Cloth: edge (x_0, x_1), opposite corners x_2, x_3.
///   flat at rest   E = K/2 |sum w_i x_i|^2, w from the cotangents at rest (quadratic isometric bending,
///                  Bergou et al. 2006)
///                  f_i = -K w_i sum w_j x_j,  H_i = K w_i^2 1 (exact and constant)
///   folded at rest E = D/2 (theta - theta_0)^2, theta the dihedral angle; Gauss-Newton H = D grad grad^T
/// Strand: E = K/2 |x_0 - 2 x_1 + x_2|^2, K = E I / l^3: the same quadratic form with weights 1, -2, 1.
/// Straight at rest; no twist.
///
/// A damper acts on theta, which is invariant under rigid motion. The quadratic forms have no damper, because
/// sum w_i x_i rotates with a bent element.
#include <array>

#include "math/block3.h"
#include "math/trig.h"
#include "solver/constants.h"

namespace rubble {

/// Cooked bends, in double precision. Vertices are those of their object.
template <int N> struct QuadraticBendModel {
  std::array<int, N> v;
  double stiffness, weight[N];
};
struct FoldBendModel {
  std::array<int, 4> v;
  double stiffness, damping, restAngle;
};

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

/// K/2 |sum w_i x_i|^2 over N vertices whose weights add up to zero.
template <int N> struct QuadraticBend {
  static constexpr int kCorners = N;
  static constexpr bool kHasDual = false;

  int v[N];
  int alive;
  Real stiffness;  ///< K [N/m], with dimensionless weights
  Real weight[N];

  using Model = QuadraticBendModel<N>;
  void set(const Model& m) {
    stiffness = Real(m.stiffness);
    for (int i = 0; i < N; ++i) weight[i] = Real(m.weight[i]);
  }

  RUBBLE_HD Vec3 sum(const Vec3 (&x)[N]) const {
    // relative to the first vertex; weights add up to zero
    Vec3 s = weight[1] * (x[1] - x[0]);
    for (int i = 2; i < N; ++i) s += weight[i] * (x[i] - x[0]);
    return s;
  }
  RUBBLE_HD void begin(const StepConstants&, const Vec3 (&)[N]) {}
  RUBBLE_HD Real energy(const StepConstants&, const Vec3 (&x)[N]) const {
    return stiffness / 2 * lengthSquared(sum(x));
  }
  RUBBLE_HD void accumulate(const StepConstants&, const Vec3 (&x)[N], int corner, Block3& block) const {
    const Real w = weight[corner];
    block.f -= (stiffness * w) * sum(x);
    block.addDiagonal(stiffness * w * w);
  }
};

struct FlatBend : QuadraticBend<4> {
  static constexpr const char* kName = "flat bend";
};
struct LineBend : QuadraticBend<3> {
  static constexpr const char* kName = "line bend";
};

/// D/2 (theta - theta_0)^2 with a damper on theta.
struct FoldBend {
  static constexpr const char* kName = "fold bend";
  static constexpr int kCorners = 4;
  static constexpr bool kHasDual = false;

  int v[kCorners];
  int alive;
  Real stiffness;   ///< D [N m/rad]
  Real damping;     ///< [N m s/rad]
  Real restAngle;   ///< theta_0 [rad]
  Real angleStart;  ///< theta at x^t [rad]

  using Model = FoldBendModel;
  void set(const Model& m) {
    stiffness = Real(m.stiffness), damping = Real(m.damping), restAngle = Real(m.restAngle);
  }

  struct Fold {
    Vec3 n1, n2, edge;  ///< normals, twice the areas long; x_1 - x_0
    Real angle;
    bool valid;  ///< both triangles have positive area
  };
  RUBBLE_HD Fold fold(const Vec3 (&x)[kCorners]) const {
    Fold f;
    f.edge = x[1] - x[0];
    f.n1 = cross(x[0] - x[2], x[1] - x[2]);
    f.n2 = cross(x[1] - x[3], x[0] - x[3]);
    const Real l = length(f.edge), smallest = Real(1e-8) * l * l;
    f.valid = l > Real(0) && length(f.n1) > smallest && length(f.n2) > smallest;
    f.angle = f.valid ? signedAngleOf(dot(cross(f.n1, f.n2), f.edge) / l, dot(f.n1, f.n2)) : Real(0);
    return f;
  }
  /// a - b, wrapped to half a revolution.
  RUBBLE_HD static Real turn(Real a, Real b) {
    constexpr Real kTurn = Real(6.283185307179586);
    const Real d = a - b;
    return d > kTurn / 2 ? d - kTurn : d < -kTurn / 2 ? d + kTurn : d;
  }
  RUBBLE_HD Vec3 gradient(const Fold& f, const Vec3 (&x)[kCorners], int corner) const {
    const Real l = length(f.edge);
    const Vec3 a = f.n1 / dot(f.n1, f.n1), b = f.n2 / dot(f.n2, f.n2);
    if (corner == 2) return -l * a;
    if (corner == 3) return -l * b;
    const Vec3& from = corner == 0 ? x[1] : x[0];
    const Real sign = corner == 0 ? Real(-1) : Real(1);
    return (sign * dot(x[2] - from, f.edge) / l) * a + (sign * dot(x[3] - from, f.edge) / l) * b;
  }
  RUBBLE_HD void begin(const StepConstants&, const Vec3 (&x)[kCorners]) { angleStart = fold(x).angle; }
  RUBBLE_HD Real energy(const StepConstants& c, const Vec3 (&x)[kCorners]) const {
    const Real angle = fold(x).angle, away = turn(angle, restAngle), moved = turn(angle, angleStart);
    return stiffness / 2 * away * away + damping * c.inverseDt / 2 * moved * moved;
  }
  RUBBLE_HD void accumulate(const StepConstants& c, const Vec3 (&x)[kCorners], int corner,
                            Block3& block) const {
    const Fold f = fold(x);
    if (!f.valid) return;
    const Vec3 g = gradient(f, x, corner);
    const Real d = damping * c.inverseDt;
    block.f -= (stiffness * turn(f.angle, restAngle) + d * turn(f.angle, angleStart)) * g;
    block.h += outer(g, stiffness + d);
  }
};

}  // namespace rubble::RUBBLE_CORE
