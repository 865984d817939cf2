#pragma once
/// The local problem of one body: force, Hessian and one Newton step.
#include <limits>

#include "math/block3.h"
#include "solver/inertia.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S5} f = -M (x - y) / dt^2 + the forces that rows add (accumulateRow and the contact's accumulate).
template <class L>
RUBBLE_HD RUBBLE_NEAR void setInertialForce(Block6T<L>& block, const MassMatrixT<L>& m, const PoseT<L>& x,
                                            const PoseT<L>& y, Real inverseDt2) {
  const Vec6T<L> d = difference(x, y);
  block.fl = -(inverseDt2 * m.mass) * d.lin;
  block.fa = LaneAccess<L>::splat(-inverseDt2) * (m.inertia * d.ang);
}

/// \eq{S6} H = M / dt^2 + the Hessians that rows add.
template <class L>
RUBBLE_HD RUBBLE_NEAR void setInertialHessian(Block6T<L>& block, const MassMatrixT<L>& m, Real inverseDt2) {
  const L ml = inverseDt2 * m.mass, zero = LaneAccess<L>::splat(0);
  const Sym3T<L>& i = m.inertia;
  const Real s = inverseDt2;
  block.ll = {ml, zero, zero, ml, zero, ml};
  block.aa = {s * i.xx, s * i.xy, s * i.xz, s * i.yy, s * i.yz, s * i.zz};
  block.al0 = block.al1 = block.al2 = {zero, zero, zero};
}

/// \eq{S4} dx with H dx = f.
template <class L> RUBBLE_HD Vec6T<L> newtonStep(const Block6T<L>& block) {
  L x[6] = {block.fl.x, block.fl.y, block.fl.z, block.fa.x, block.fa.y, block.fa.z};
  solveLdlt(pack(block), x);
  return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
}

/// Sets the components of locked axes to zero. `bits`: locks of the x, y and z axes.
RUBBLE_HD inline Vec3 unlocked(const Vec3& a, int bits) {
  return {bits & 1 ? Real(0) : a.x, bits & 2 ? Real(0) : a.y, bits & 4 ? Real(0) : a.z};
}

/// Removes locked axes from the system: off-diagonal entries and the force along them become zero.
RUBBLE_HD inline void lockAxes(Block6& b, int locks) {
  const auto keep = [&](int axis) { return (locks >> axis & 1) == 0; };
  const auto off = [&](Sym3& m, int first) {
    const bool x = keep(first), y = keep(first + 1), z = keep(first + 2);
    if (!x || !y) m.xy = 0;
    if (!x || !z) m.xz = 0;
    if (!y || !z) m.yz = 0;
  };
  off(b.ll, 0), off(b.aa, 3);
  Vec3* const columns[3] = {&b.al0, &b.al1, &b.al2};
  for (int j = 0; j < 3; ++j) *columns[j] = keep(j) ? unlocked(*columns[j], locks >> 3) : Vec3{0, 0, 0};
  b.fl = unlocked(b.fl, locks);
  b.fa = unlocked(b.fa, locks >> 3);
}

/// Largest rotation of one Newton step [rad]. Rows are linearized in it; a small body hit off its center
/// would otherwise take a step of several turns.
inline constexpr Real kLargestRotation = 1;
/// cos(angle / 2) of the rotation since x^t beyond which a Newton step may not rotate a body further (1.5
/// rad).
inline constexpr Real kMostTurned = Real(.7317);

/// Shortens a rotation of more than one Newton step. Returns whether it did.
RUBBLE_HD inline bool boundRotation(Vec3& turn) {
  const Real turn2 = dot(turn, turn);
  if (!(turn2 > kLargestRotation * kLargestRotation)) return false;
  turn *= kLargestRotation / std::sqrt(turn2);
  return true;
}
/// The translation that minimizes the local energy for a given rotation.
RUBBLE_HD inline Vec3 translationFor(const Block6& block, const Vec3& turn) {
  return solve(
      Block3{block.ll, block.fl - Vec3{dot(block.al0, turn), dot(block.al1, turn), dot(block.al2, turn)}});
}

/// The Newton step with a bounded rotation (a trust region). `q`: rotation since x^t.
RUBBLE_HD inline Vec6 trustedStep(const Block6& block, const Quat& q) {
  Vec6 dx = newtonStep(block);
  const bool bounded = boundRotation(dx.ang);
  const Real turned = std::fabs(q.s), then = std::fabs(retract({{0, 0, 0}, q}, dx).q.s);
  const bool further = then < kMostTurned && then < turned;
  if (further) dx.ang = {0, 0, 0};
  if (further || bounded) dx.lin = translationFor(block, dx.ang);
  return dx;
}

/// Round-off of the work of a step, relative to the sum of the absolute work per axis [1].
inline constexpr Real kWorkRoundOff = 32 * std::numeric_limits<Real>::epsilon();

/// Energy test of a Newton step: |dx|_M^2 / dt^2 <= 2 f . dx. With H >= M / dt^2 the exact step satisfies
/// |dx|_M^2 / dt^2 <= dx . H dx = f . dx, and a shortened step, or the optimum with less rotation, twice
/// that. So its kinetic energy does not exceed the work of the forces. The test fails where the row
/// stiffnesses exceed M / dt^2 by so much that round-off destroys H. `mass`, `inertia`: divided by dt^2.
template <class L>
RUBBLE_HD RUBBLE_NEAR auto isWithinWork(const Block6T<L>& block, const L& mass, const Sym3T<L>& inertia,
                                        const Vec6T<L>& dx) {
  const L work[6] = {block.fl.x * dx.lin.x, block.fl.y * dx.lin.y, block.fl.z * dx.lin.z,
                     block.fa.x * dx.ang.x, block.fa.y * dx.ang.y, block.fa.z * dx.ang.z};
  L sum = work[0], size = absOf(work[0]);
  RUBBLE_UNROLL
  for (int i = 1; i < 6; ++i) sum += work[i], size += absOf(work[i]);
  return mass * dot(dx.lin, dx.lin) + dot(dx.ang, inertia * dx.ang) <= sum + sum + kWorkRoundOff * size;
}

/// H dx
RUBBLE_HD inline Vec6 product(const Block6& b, const Vec6& dx) {
  return {b.ll * dx.lin + Vec3{dot(b.al0, dx.ang), dot(b.al1, dx.ang), dot(b.al2, dx.ang)},
          b.al0 * dx.lin.x + b.al1 * dx.lin.y + b.al2 * dx.lin.z + b.aa * dx.ang};
}
/// The exact line minimum along D^-1 f, with D = diag(H). It involves no cancellation and therefore descends
/// in spite of round-off. Takes the block by value so that the caller's stays in registers.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Vec6 diagonalStep(Block6 b) {
  const Vec6 d{{b.fl.x / b.ll.xx, b.fl.y / b.ll.yy, b.fl.z / b.ll.zz},
               {b.fa.x / b.aa.xx, b.fa.y / b.aa.yy, b.fa.z / b.aa.zz}};
  const Real work = dot(Vec6{b.fl, b.fa}, d), curvature = dot(d, product(b, d)), turn2 = dot(d.ang, d.ang);
  Real share = curvature > Real(0) ? min(work / curvature, Real(1)) : Real(0);
  if (share * share * turn2 > kLargestRotation * kLargestRotation)
    share = kLargestRotation / std::sqrt(turn2);
  return share * d;
}

/// Result of `descend`: Newton step taken; diagonal step taken, because the Newton step failed the energy
/// test; or no step taken, because it was not finite.
enum class Descent { Newton, Diagonal, Failed };

/// \eq{S3} One Newton step on the local problem of a body, with all other bodies at their latest poses.
/// `m`: its mass matrix. A step that is not finite is not taken.
RUBBLE_HD inline Descent descend(const Block6& block, const MassMatrix& m, Real inverseDt2, Pose& x) {
  Vec6 dx = trustedStep(block, x.q);
  if (!isFinite(dx.lin) || !isFinite(dx.ang)) return Descent::Failed;
  Descent how = Descent::Newton;
  if (!isWithinWork(block, inverseDt2 * m.mass, inverseDt2 * m.inertia, dx)) {
    dx = diagonalStep(block);
    if (!isFinite(dx.lin) || !isFinite(dx.ang)) return Descent::Failed;
    how = Descent::Diagonal;
  }
  x = retract(x, dx);
  return how;
}

}  // namespace rubble::RUBBLE_CORE
