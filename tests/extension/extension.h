#pragma once
/// A joint, a soft element and a shape that exist only here: what docs/extending.md shows, compiled and
/// tested.
#include <array>
#include <numbers>

#include "forces/angular_parts.h"
#include "forces/linear_parts.h"
#include "math/block3.h"
#include "math/field.h"

#define RUBBLE_EXTRA_JOINTS , PlanarKind
#define RUBBLE_EXTRA_ELEMENTS , Strut
#define RUBBLE_EXTRA_SHAPES , Ellipsoid

namespace rubble {

// [joint fields]
/// Fields of a planar joint that JointDef has no members for.
struct PlanarFields {
  double offset = 0;  ///< [m]
};
// [joint fields]

// [element model]
/// Constants of a strut, in double precision. Vertices are those of its object.
struct StrutModel {
  std::array<int, 2> v{};
  double stiffness = 1000;  ///< [N/m]
  double restLength = .1;   ///< [m]
};
// [element model]

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

// [joint]
/// Anchor A lies in a plane across the x axis of the joint frame on B, `offset` from anchor B.
///
///   C = b_1.d - offset                                [m], 1 row, F [N];  J, G as for OnLineRows
struct InPlaneRow {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = false;

  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M&, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    c[0] = dot(axisOfB(d, b, 0), a.p - b.p + rotate(a.q, d.anchorA) - rotate(b.q, d.anchorB)) - d.offset;
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    j[0] = travelJacobian(d, a, b, side, axisOfB(d, b, 0));
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                  const Real (&f)[kRows]) {
    return travelCurvature(d, a, b, side, f[0] * axisOfB(d, b, 0));
  }
};

struct PlanarJoint {
  static constexpr const char* kName = "planar";
  static constexpr bool kGrounded = false;
  using Parts = PartList<InPlaneRow, ParallelRows>;
  using Memory = NoMemory;
  struct Constants {
    double offset = 0;
  };
  struct Data {
    Vec3 anchorA, anchorB;  ///< in the frames of their bodies [m]
    Quat frameA, frameB;    ///< joint -> body; x is across the plane
    Real offset;            ///< [m]
    static Data of(const EngineJoint& j) {
      return {Vec3(j.anchorA), Vec3(j.anchorB), Quat(j.frameA), Quat(j.frameB),
              Real(j.constants.get<Constants>().offset)};
    }
  };
};

struct PlanarKind {
  using Joint = PlanarJoint;
  static constexpr const char* kName = "planar";
  static constexpr const char* kDoc = "A moves in a plane of B and turns about its normal";
  static constexpr auto kFields = std::tuple_cat(
      kAnchorFields, kFrameFields, kStiffnessField, kAngularStiffnessField,
      std::tuple{field("offset", "m", "of the plane from the anchor of B", &PlanarFields::offset,
                       {.range = FieldRange::NotNegative})},
      kBreakFields);
  static void build(JointBuild& b) {
    b.joint.groups = {b.held(), b.heldRotations()};
    b.joint.isRigid = false;
    b.joint.constants.set(PlanarJoint::Constants{ownIn<PlanarFields>(b.def.own).offset});
  }
  static void check(const JointDef& def, const Path& path) {
    if (def.stiffness < 1) throw Error(path + ".stiffness", "at least 1 N/m for a planar joint", "less");
  }
};
// [joint]

// [element]
/// Strut by its Green strain: no square root, and stiffer the more it is stretched.
///
///   s = (|d|^2 - L^2) / (2 L),  d = x_0 - x_1         [m]
///   E = K s^2 / 2,  f_0 = -K s d / L = -f_1,  H = K (d d^T / L^2 + max(s, 0) / L 1)
struct Strut {
  static constexpr const char* kName = "strut";
  static constexpr const char* kDoc = "bar between two vertices, by its Green strain";
  static constexpr int kCorners = 2;
  static constexpr bool kHasDual = false;
  using Model = StrutModel;
  static constexpr std::tuple kFields{
      field("stiffness", "N/m", "at rest length", &StrutModel::stiffness, {.range = FieldRange::Positive}),
      field("rest_length", "m", "at which it has no force", &StrutModel::restLength,
            {.range = FieldRange::Positive, .always = true})};

  int v[kCorners];
  int alive;
  Real stiffness;   ///< K [N/m]
  Real restLength;  ///< L [m]

  void set(const Model& m) { stiffness = Real(m.stiffness), restLength = Real(m.restLength); }
  RUBBLE_HD Real strain(const Vec3& d) const {
    return (dot(d, d) - restLength * restLength) / (2 * restLength);
  }
  RUBBLE_HD void begin(const StepConstants&, const Vec3 (&)[kCorners]) {}
  RUBBLE_HD Real energy(const StepConstants&, const Vec3 (&x)[kCorners]) const {
    const Real s = strain(x[0] - x[1]);
    return stiffness * s * s / 2;
  }
  RUBBLE_HD void accumulate(const StepConstants&, const Vec3 (&x)[kCorners], int corner,
                            Block3& block) const {
    const Vec3 d = corner == 0 ? x[0] - x[1] : x[1] - x[0];
    const Real s = strain(d), k = stiffness / restLength;
    block.f -= k * s * d;
    block.h += outer(d, k / restLength);
    block.addDiagonal(k * max(s, Real(0)));
  }
};
// [element]

// [shape]
struct Ellipsoid {
  static constexpr const char* kName = "ellipsoid";
  static constexpr const char* kDoc = "ellipsoid about its center";
  static constexpr std::tuple kFields{
      field("size", "m", "its three diameters", &Shape::halfExtents,
            {.range = FieldRange::Positive, .always = true, .name = "halfExtents", .factor = 2})};

  static rubble::Vec3 half(const Shape& s) { return s.halfExtents; }
  static MassProperties massProperties(const Shape& s, double density) {
    const rubble::Vec3 h = s.halfExtents, h2 = mul(h, h);
    const double m = density * 4 / 3 * std::numbers::pi * h.x * h.y * h.z;
    return {m, rubble::Vec3{h2.y + h2.z, h2.z + h2.x, h2.x + h2.y} * (m / 5), {}, {}};
  }
  template <class S> RUBBLE_HD static Vec3T<S> support(const Vec3T<S>& half, const Vec3T<S>& d) {
    const Vec3T<S> scaled = mul(half, d);
    const S size = length(scaled);
    return size > S(0) ? mul(half, scaled) / size : Vec3T<S>{half.x, 0, 0};
  }
  /// To first order: exact on the surface.
  RUBBLE_HD static Real distance(const Vec3& half, const Vec3& x, Vec3& n) {
    const Vec3 unit{x.x / half.x, x.y / half.y, x.z / half.z};
    const Vec3 slope{unit.x / half.x, unit.y / half.y, unit.z / half.z};
    const Real radius = length(unit), steep = length(slope);
    if (!(steep > Real(0))) return n = {0, 0, 1}, -innerRadius(half);
    n = slope / steep;
    return (radius - 1) * radius / steep;
  }
  RUBBLE_HD static Real innerRadius(const Vec3& half) { return min(half.x, min(half.y, half.z)); }
};
// [shape]

}  // namespace rubble::RUBBLE_CORE
