#pragma once
/// Gimbal: three hinges in a row, about z of B, about an axis between them, and about x of A. Axes that
/// follow one another need neither be orthogonal nor meet.
///
///   R(e) = R_z(q_2) R_x(b) R_y(q_1) R_z(a) R_x(q_0)    e: frame of A in that of B; b, a: tilts [rad]
///   o = R_z(q_2) (d_B + R_w(q_1) d_A)                  anchor A seen from anchor B, without travel [m]
///
/// w_k is the axis of q_k in the frame of B: w_2 = z, w_0 = x of A; d_B leads from the first axis to the
/// second one and d_A from there to the third one.
#include <cmath>

#include "forces/six_dof.h"
#include "math/portable.h"

namespace rubble {

/// Sines and cosines of the tilts b and a.
template <class R> struct GimbalTilts {
  R sinB, cosB, sinA, cosA;

  /// In another precision.
  template <class S> GimbalTilts<S> as() const { return {S(sinB), S(cosB), S(sinA), S(cosA)}; }
  static GimbalTilts of(double b, double a) {
    return {R(portable::sin(b)), R(portable::cos(b)), R(portable::sin(a)), R(portable::cos(a))};
  }
};

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

/// s (a b^T + b a^T) / 2
RUBBLE_HD inline Sym3 symmetricOuter(const Vec3& a, const Vec3& b, Real s) {
  return {s * a.x * b.x, s * (a.x * b.y + a.y * b.x) / 2, s * (a.x * b.z + a.z * b.x) / 2,
          s * a.y * b.y, s * (a.y * b.z + a.z * b.y) / 2, s * a.z * b.z};
}
RUBBLE_HD inline Vec3 columnNorms(const Sym3& m) {
  return {length(m.column(0)), length(m.column(1)), length(m.column(2))};
}

/// Derivatives of the three angles by the rotation of A. With V = w_0 . (w_1 x w_2) = cos b cos a cos q_1 and
/// indices modulo 3:
///
///   g_k = w_(k+1) x w_(k+2) / V                        J_A = R(Q_B) g,  J_B = -J_A
///   d2q_k = V ((g_k.g_0) sym(g_1 g_2) - (g_k.g_1) sym(g_0 g_2) + (g_k.g_2) sym(g_0 g_1)), for both bodies
struct CardanDerivatives {
  Vec3 g[3];
  Real volume;  ///< V

  RUBBLE_HD Sym3 second(int k) const {
    Sym3 sum = symmetricOuter(g[1], g[2], volume * dot(g[k], g[0]));
    sum += symmetricOuter(g[0], g[2], -volume * dot(g[k], g[1]));
    sum += symmetricOuter(g[0], g[1], volume * dot(g[k], g[2]));
    return sum;
  }
};

/// The angles of a relative orientation e, with q_1 within 90 degrees:
///   sin q_1 = (sin b sin a - w_0.z) / (cos b cos a),   V^2 = w_0.x^2 + w_0.y^2 - sin^2 b - sin^2 a
///                                                            + 2 sin b sin a w_0.z
class CardanAngles {
 public:
  RUBBLE_HD CardanAngles(const Quat& e, const GimbalTilts<Real>& tilts) : tilts_(tilts) {
    const Vec3 x = rotate(e, Vec3{1, 0, 0}), y = rotate(e, Vec3{0, 1, 0}), z = rotate(e, Vec3{0, 0, 1});
    const Real both = tilts.sinB * tilts.sinA, square = x.x * x.x + x.y * x.y - tilts.sinB * tilts.sinB -
                                                        tilts.sinA * tilts.sinA + 2 * both * x.z;
    volume_ = std::sqrt(max(square, Real(0)));
    turn_[1] = {both - x.z, volume_};
    normalize(turn_[1]);
    // w_0 turned back by q_2
    const Vec3 before = aboutSecond({tilts.cosA, tilts.sinA * tilts.cosB, tilts.sinA * tilts.sinB});
    turn_[2] = {x.y * before.x - x.x * before.y, x.x * before.x + x.y * before.y};
    normalize(turn_[2]);
    axis_[0] = x, axis_[1] = aboutFirst(second()), axis_[2] = {0, 0, 1};
    turn_[0] = {-dot(z, axis_[1]), dot(y, axis_[1])};
  }
  /// [rad]
  RUBBLE_HD Real angle(int k) const { return signedAngleOf(turn_[k].sin, turn_[k].cos); }
  /// w_k, in the frame of B.
  RUBBLE_HD const Vec3& axis(int k) const { return axis_[k]; }
  /// In the axes that `frame` leads to from those of B.
  RUBBLE_HD CardanDerivatives derivatives(const Quat& frame) const {
    // floor of cos q_1: the outer two angles are undefined where q_1 is 90 degrees
    constexpr Real kFloor = Real(0.05);
    CardanDerivatives out;
    out.volume = max(volume_, kFloor * tilts_.cosB * tilts_.cosA);
    for (int k = 0; k < 3; ++k)
      out.g[k] = rotate(frame, cross(axis_[(k + 1) % 3], axis_[(k + 2) % 3]) / out.volume);
    return out;
  }
  /// R_z(q_2) v
  RUBBLE_HD Vec3 aboutFirst(const Vec3& v) const {
    const auto [s, c] = turn_[2];
    return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
  }
  /// R_w(q_1) v
  RUBBLE_HD Vec3 aboutSecond(const Vec3& v) const {
    const Vec3 w = second();
    const auto [s, c] = turn_[1];
    return c * v + s * cross(w, v) + ((1 - c) * dot(w, v)) * w;
  }

 private:
  struct Turn {
    Real sin, cos;
  };
  RUBBLE_HD static void normalize(Turn& turn) {
    const Real size = std::sqrt(turn.sin * turn.sin + turn.cos * turn.cos);
    turn = size > Real(0) ? Turn{turn.sin / size, turn.cos / size} : Turn{0, 1};
  }
  /// The second axis where the first angle is 0.
  RUBBLE_HD Vec3 second() const { return {0, tilts_.cosB, tilts_.sinB}; }

  GimbalTilts<Real> tilts_;
  Vec3 axis_[3];
  Turn turn_[3];  ///< q_k; that of q_0 is not normalized
  Real volume_;
};

template <class D> RUBBLE_HD CardanAngles cardanOf(const D& d, const Pose& a, const Pose& b) {
  return {frameAInB(d, a, b), d.tilts};
}

/// o and its derivatives by q_2 and q_1, in the frame of B.
struct GimbalOffset {
  Vec3 o, inner;  ///< inner: R_z R_w d_A
  Vec3 z, w;

  template <class D>
  RUBBLE_HD GimbalOffset(const D& d, const CardanAngles& q)
      : inner(q.aboutFirst(q.aboutSecond(d.offsetA))), z(q.axis(2)), w(q.axis(1)) {
    o = q.aboutFirst(d.offsetB) + inner;
  }
  RUBBLE_HD Vec3 byFirst() const { return cross(z, o); }
  RUBBLE_HD Vec3 bySecond() const { return cross(w, inner); }
};

/// Travel I of anchor A beside where the hinges alone have it, along an axis of the joint frame on B.
///
///   c = b_I.d - o_I                                    [m], F [N]
///   J_A = J_A(travel) - [0, do_I],  J_B = J_B(travel) + [0, do_I],  do = (z x o) g_2 + (w x o_A) g_1
///   d2o = (z x o) d2q_2 + (w x o_A) d2q_1 + z x (z x o) g_2 g_2^T + 2 z x (w x o_A) sym(g_2 g_1)
///         + w x (w x o_A) g_1 g_1^T,  o_A = R_z R_w d_A
template <int I> struct GimbalTravel {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = true;

  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    TravelAxis<I>::constraint(d, m, a, b, c);
    if (d.meet != 0) return;
    c[0] -= GimbalOffset(d, cardanOf(d, a, b)).o[I];
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M& m, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    TravelAxis<I>::jacobian(d, m, a, b, side, j);
    if (d.meet != 0) return;
    const CardanAngles q = cardanOf(d, a, b);
    const GimbalOffset offset(d, q);
    const CardanDerivatives to = q.derivatives(frameOfB(d, b));
    const Vec3 change = offset.byFirst()[I] * to.g[2] + offset.bySecond()[I] * to.g[1];
    j[0].ang += side == 0 ? -change : change;
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M& m, const Pose& a, const Pose& b, int side,
                                  const Real (&f)[kRows]) {
    if (d.meet != 0) return TravelAxis<I>::curvature(d, m, a, b, side, f);
    const CardanAngles q = cardanOf(d, a, b);
    const GimbalOffset offset(d, q);
    const CardanDerivatives to = q.derivatives(frameOfB(d, b));
    const Vec3 first = offset.byFirst(), second = offset.bySecond();
    // S(u, r) less the second derivative of o_I
    const Vec3 u = axisOfB(d, b, I), r = rotate(a.q, d.anchorA) + (side == 0 ? Vec3{0, 0, 0} : a.p - b.p);
    Sym3 bend = symmetricOuter(u, r, 1);
    const Real along = dot(u, r);
    bend.xx -= along, bend.yy -= along, bend.zz -= along;
    bend += -first[I] * to.second(2);
    bend += -second[I] * to.second(1);
    bend += outer(to.g[2], -cross(offset.z, first)[I]);
    bend += symmetricOuter(to.g[2], to.g[1], -2 * cross(offset.z, second)[I]);
    bend += outer(to.g[1], -cross(offset.w, second)[I]);
    const Vec3 turn = columnNorms(bend);
    const Real force = absOf(f[0]);
    if (side == 0) return {{0, 0, 0}, force * turn};
    // B: also the off-diagonal block [u]
    const auto across = [&](int i) { return max(Real(1) - u[i] * u[i], Real(0)); };
    const auto norm = [&](int i) { return std::sqrt(across(i) + turn[i] * turn[i]); };
    return {force * Vec3{std::sqrt(across(0)), std::sqrt(across(1)), std::sqrt(across(2))},
            force * Vec3{norm(0), norm(1), norm(2)}};
  }
};

/// Angle q_I.
template <int I> struct GimbalAngle {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Angular;
  static constexpr bool kAxis = true;

  template <class D, class M> RUBBLE_HD static double turns(const D&, const M& m) {
    return m.angle[I].turned();
  }
  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const Pose& a, const Pose& b, Real (&c)[kRows]) {
    c[0] = m.angle[I].nearest(cardanOf(d, a, b).angle(I));
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M&, const Pose& a, const Pose& b, int side,
                                 Vec6 (&j)[kRows]) {
    const Vec3 g = cardanOf(d, a, b).derivatives(frameOfB(d, b)).g[I];
    j[0] = {{0, 0, 0}, side == 0 ? g : -g};
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M&, const Pose& a, const Pose& b, int,
                                  const Real (&f)[kRows]) {
    const Sym3 second = cardanOf(d, a, b).derivatives(frameOfB(d, b)).second(I);
    return {{0, 0, 0}, absOf(f[0]) * columnNorms(second)};
  }
};

struct GimbalJoint {
  static constexpr const char* kName = "gimbal";
  static constexpr bool kGrounded = false;
  using Parts = PartList<GimbalTravel<0>, GimbalTravel<1>, GimbalTravel<2>, GimbalAngle<0>, GimbalAngle<1>,
                         GimbalAngle<2>>;
  struct Constants {
    rubble::Vec3 offsetB, offsetA;
    double tiltB = 0, tiltA = 0;
  };
  struct Data : FramedData {
    Vec3 offsetB, offsetA;  ///< d_B and d_A, in the frame of B where all angles are 0 [m]
    GimbalTilts<Real> tilts;
    int meet;  ///< 0, 1: d_B and d_A are zero, and travel is as in other joints
    static Data of(const EngineJoint& j) {
      const auto own = j.constants.get<Constants>();
      return {FramedData::of(j), Vec3(own.offsetB), Vec3(own.offsetA),
              GimbalTilts<Real>::of(own.tiltB, own.tiltA),
              own.offsetB == rubble::Vec3{} && own.offsetA == rubble::Vec3{}};
    }
  };
  struct Memory {
    RevolutionCounter angle[3];
    template <class D> RUBBLE_HD void remember(const D& d, const Pose& a, const Pose& b, const Vec3d&) {
      const CardanAngles q = cardanOf(d, a, b);
      for (int k = 0; k < 3; ++k) angle[k].follow(q.angle(k));
    }
  };
};

struct GimbalKind {
  using Joint = GimbalJoint;
  static constexpr const char* kName = "gimbal";
  static constexpr const char*
      kDoc = "three hinges in a row, about z of B, an axis between them and x of A; travel along axes of B";
  static constexpr auto kFields = std::tuple_cat(
      kAnchorFields, kFrameFields,
      std::tuple{field("offset_b", "m", "from anchor B to the second axis, in the frame of B at angles of 0",
                       &GimbalFields::offsetB),
                 field("offset_a", "m", "from there to anchor A, likewise", &GimbalFields::offsetA),
                 field("tilt_b", "rad", "90 degrees less the angle between the first and the second axis",
                       &GimbalFields::tiltB),
                 field("tilt_a", "rad", "90 degrees less the angle between the second and the third axis",
                       &GimbalFields::tiltA)},
      kBreakFields);
  /// Axes that are nearly parallel are one [rad].
  static constexpr double kMostTilt = 1.48;

  static void build(JointBuild& b) {
    const GimbalFields& own = ownIn<GimbalFields>(b.def.own);
    b.joint.isRigid = SixDofKind::isRigid(b);
    b.joint.constants.set(GimbalJoint::Constants{own.offsetB, own.offsetA, own.tiltB, own.tiltA});
  }
  static void checkTilt(double tilt, const Path& path) {
    if (!(std::fabs(tilt) <= kMostTilt)) throw Error(path, "an angle of at most 1.48 rad", numberText(tilt));
  }
  static void check(const JointDef& def, const Path& path) {
    const GimbalFields& own = ownIn<GimbalFields>(def.own);
    checkTilt(own.tiltB, path + ".tiltB"), checkTilt(own.tiltA, path + ".tiltA");
  }
};

}  // namespace rubble::RUBBLE_CORE
