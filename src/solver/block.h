#pragma once
/// The local problem of one body: its force, its Hessian and one Newton step.
#include "solver/inertia.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S5} f = -M (x - y) / dt^2 + the forces that rows add (stampRow and the contact's accumulate).
RUBBLE_HD inline void setInertialForce(Block6& block, const MassMatrix& m, const Pose& x, const Pose& y, Real inverseDt2) {
  const Vec6 d = difference(x, y);
  block.fl = -(inverseDt2 * m.mass) * d.lin;
  block.fa = -inverseDt2 * (m.inertia * d.ang);
}

/// \eq{S6} H = M / dt^2 + the Hessians that rows add.
RUBBLE_HD inline void setInertialHessian(Block6& block, const MassMatrix& m, Real inverseDt2) {
  const Real ml = inverseDt2 * m.mass;
  const Sym3& i = m.inertia;
  const Real s = inverseDt2;
  block.ll = {ml, 0, 0, ml, 0, ml};
  block.aa = {s * i.xx, s * i.xy, s * i.xz, s * i.yy, s * i.yz, s * i.zz};
  block.al0 = block.al1 = block.al2 = {0, 0, 0};
}

/// \eq{S4} dx with H dx = f.
RUBBLE_HD inline Vec6 newtonStep(const Block6& block) {
  Real x[6] = {block.fl.x, block.fl.y, block.fl.z, block.fa.x, block.fa.y, block.fa.z};
  solveLdlt(pack(block), x);
  return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
}

/// \eq{S3} One Newton step on the local problem of a body, all others held at their latest poses. A step that is not finite is not taken:
/// returns false.
RUBBLE_HD inline bool descend(const Block6& block, Pose& x) {
  const Vec6 dx = newtonStep(block);
  if (!isFinite(dx.lin) || !isFinite(dx.ang)) return false;
  x = retract(x, dx);
  return true;
}

}  // namespace rubble::RUBBLE_CORE
