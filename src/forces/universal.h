#pragma once
/// Universal joint (Hooke, Cardan): the anchors coincide, and the cross axis y of A is perpendicular to the
/// cross axis z of B. x is the shaft.
#include "forces/hinge.h"

namespace rubble::RUBBLE_CORE {

/// Two axes are perpendicular. y: y axis of A's joint frame, z: z axis of B's, in world axes.
///
///   C = y.z                                           [1: sine of the angle], F [N m]
///   J_A = [0, y x z],  J_B = -J_A,  G = F S(z, y) on both bodies
struct PerpendicularRow {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = false;

  template <class D> RUBBLE_HD static Vec3 crossA(const D& d, const Pose& a) {
    return rotate(frameOfA(d, a), Vec3{0, 1, 0});
  }
  template <class D> RUBBLE_HD static Vec3 crossB(const D& d, const Pose& b) {
    return rotate(frameOfB(d, b), Vec3{0, 0, 1});
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M&, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    c[0] = dot(crossA(d, a), crossB(d, b));
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    const Vec3 g = cross(crossA(d, a), crossB(d, b));
    j[0] = {{0, 0, 0}, side == 0 ? g : -g};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int,
                                  const Real (&f)[kRows]) {
    return {{0, 0, 0}, turningColumnNorms(f[0] * crossB(d, b), crossA(d, a))};
  }
};

struct UniversalJoint {
  static constexpr const char* kName = "universal";
  static constexpr bool kGrounded = false;
  using Parts = PartList<AnchorRows, PerpendicularRow>;
  using Memory = NoMemory;
  using Data = FramedData;
};

struct UniversalKind {
  using Joint = UniversalJoint;
  static constexpr JointType kType = JointType::Universal;
  static constexpr const char* kName = "universal";
  static constexpr const char* kDoc = "two shafts (x axes) joined by a cross of A's y and B's z axis";
  static constexpr auto kFields = HingeKind::kFields;
  static void build(JointBuild& b) { b.joint.groups = {b.held(), b.heldRotations()}; }
};

}  // namespace rubble::RUBBLE_CORE
