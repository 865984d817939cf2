#pragma once
/// Attachment: a point of a body, or of the world, coincides with a weighted mean of vertices. A
/// vertex-vertex attachment (`seam`) joins two such means.
///
///   C = x_A + sum c_i x_i,  x_A = p + r, r = R a (absent in a seam)     [m], 3 rows, F [N]
///   c_i: minus the weights of the vertices that are attached to x_A; in a seam + on one side, - on the other
///   J_body = [1, -[r]],  J_i = c_i 1;  G of the body: S(F, r), by its column norms
///
/// The three rows share one stiffness and one bound on |F|, the break threshold. C is stored as its value at
/// x^t and updated by displacements.
#include "forces/joint.h"
#include "math/block3.h"

namespace rubble::RUBBLE_CORE {

/// Most vertices of one contact or attachment.
inline constexpr int kPointCorners = 4;

/// Displacement of a body in this step.
struct BodyMove {
  Vec3 dp;    ///< [m]
  Quat turn;  ///< q (q^t)^-1
};

struct Attachment {
  static constexpr const char* kName = "attachment";
  static constexpr int kRows = 3;

  int v[kPointCorners];        ///< -1: unused
  Real weight[kPointCorners];  ///< c_i
  int body;                    ///< or kWorldBody
  int isVertexVertex;          ///< 1: vertex-vertex attachment
  int alive, broken;
  int depth;               ///< as in PointContact
  Vec3d worldPoint;        ///< x_A if the body is kWorldBody [m]
  Vec3 anchor;             ///< a [m]
  Real bound, compliance;  ///< break threshold [N]; 1/K [m/N], 0: hard
  Real length;             ///< L of the rows [m]
  Real mass;               ///< row mass of the vertices: least m_i / c_i^2 [kg]
  Vec3 lambda;             ///< F [N]
  Real k;                  ///< 0 before the first step [N/m]
  GroupState group;        ///< group state of this step
  Vec3 c0;                 ///< C(x^t) after regularization [m]
  Vec3 lever;              ///< r at x^t [m]

  RUBBLE_HD bool isNew() const { return !(k > Real(0)); }
  /// `gap`: C*(x^t); `leverNow`: r at x^t; `bodyMass`: 0 unless dynamic; `load`: initial multiplier of a new
  /// attachment.
  RUBBLE_HD void begin(const StepConstants& c, const Vec3& gap, const Vec3& leverNow, Real bodyMass,
                       const Vec3& load) {
    const bool hard = compliance == Real(0);
    const Real row = bodyMass > Real(0) ? (mass > Real(0) ? min(mass, bodyMass) : bodyMass) : mass;
    const StiffnessRule rule = jointRule(c, startStiffness(c, row), length);
    lambda = isNew() ? load : warmMultiplier(c, Real(1), hard) * lambda;
    const Real size = std::sqrt(dot(lambda, lambda)),
               warm = isNew() ? newStiffness(rule, size) : warmStiffness(c, rule, k, size);
    group = {warm, compliance, bound, rule, true};
    c0 = hard ? (Real(1) - c.alpha) * gap : gap;
    lever = leverNow;
  }
  RUBBLE_HD void error(const BodyMove& a, const Vec3& moved, Real (&e)[kRows]) const {
    const Vec3 at = c0 + moved + (isVertexVertex ? Vec3{0, 0, 0} : a.dp + (rotate(a.turn, lever) - lever));
    e[0] = at.x, e[1] = at.y, e[2] = at.z;
  }
  /// `moved`: sum c_i (x_i - x_i^t).
  RUBBLE_HD Vec3 force(const BodyMove& a, const Vec3& moved, Real& hessian) const {
    Real e[kRows], f[kRows];
    const Real l[kRows] = {lambda.x, lambda.y, lambda.z};
    error(a, moved, e);
    aggregateForce<kRows>(group, e, l, f, kRows, hessian);
    return {f[0], f[1], f[2]};
  }
  RUBBLE_HD void accumulateVertex(const BodyMove& a, const Vec3& moved, int corner, Block3& block) const {
    Real hessian;
    const Vec3 f = force(a, moved, hessian);
    block.f -= weight[corner] * f;
    block.addDiagonal(weight[corner] * weight[corner] * hessian);
  }
  RUBBLE_HD void accumulateBody(const BodyMove& a, const Vec3& moved, Block6& block) const {
    Real hessian;
    const Vec3 f = force(a, moved, hessian), r = rotate(a.turn, lever);
    accumulateRow(block, {{1, 0, 0}, {0, r.z, -r.y}}, f.x, hessian);
    accumulateRow(block, {{0, 1, 0}, {-r.z, 0, r.x}}, f.y, hessian);
    accumulateRow(block, {{0, 0, 1}, {r.y, -r.x, 0}}, f.z, hessian);
    accumulateCurvature(block, {{0, 0, 0}, turningColumnNorms(f, r)});
  }
  RUBBLE_HD void updateDual(const BodyMove& a, const Vec3& moved) {
    Real e[kRows], l[kRows] = {lambda.x, lambda.y, lambda.z};
    error(a, moved, e);
    updateGroup<kRows>(group, e, l, kRows);
    lambda = {l[0], l[1], l[2]};
  }
  /// Stores the stiffness; returns whether the attachment breaks in this step.
  RUBBLE_HD bool finish() {
    k = group.k;
    // forces are cut to the bound, so equality holds up to round-off only
    const bool broke = dot(lambda, lambda) >= bound * bound * (Real(1) - Real(1e-5));
    broken |= broke;
    return broke;
  }
};

}  // namespace rubble::RUBBLE_CORE
