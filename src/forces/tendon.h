#pragma once
/// Tendon: a length over points of up to four bodies, and functions of joint coordinates between them. Sides
/// 0 to 3 are A, B and the frame bodies of A and B.
///
///   c = sum_i w_i L_i + sum_k f_k(q_k)                 [m], F [N], > 0: tension
///   L_i = |x_(i+1) - x_i|, or the length around a sphere or cylinder (tendon_wrap.h)
///   f(q) = c_1 q + c_2 q^2 + c_3 q^3 + c_4 q^4
///
/// x_i = p + r_i is a point of its side, n_i the direction of segment i. q_k is the turn of one side in
/// another about an axis (gear.h) or its travel along it (rack.h). A joint that has several coordinates has
/// travels and angles of its frames (gimbal.h).
///
///   J = w_i (-[n_i, r_i x n_i] at the first end, [n_i, r_(i+1) x n_i] at the second) + f' dq/dx
///   G: column norms of F d2c/dx2, with P of a segment under tension only (lengthCurvature)
#include "forces/gear.h"
#include "forces/gimbal.h"
#include "forces/linear_parts.h"
#include "forces/tendon_wrap.h"

namespace rubble {

/// Constants of a tendon, in the precision R.
template <class R, class V, class Q> struct TendonPath {
  static constexpr int kMostPoints = 12, kMostTerms = 3, kMostWraps = 4;
  struct Point {
    V at;      ///< in the frame of its body [m]
    R weight;  ///< of the segment to the next point [1]
    int side;
  };
  struct Term {
    Q base, frame;    ///< joint -> frame body and joint -> body; x is the axis
    V begin, anchor;  ///< in the frame body and in the body [m]; of a Cardan angle begin.x is its zero [rad]
    R c[4];
    int kind;             ///< 0: turn, 1: travel, 2 to 4: Cardan angle about x, y or z
    int body, frameBody;  ///< sides
    GimbalTilts<R> tilts;
  };
  Point point[kMostPoints];
  Term term[kMostTerms];
  TendonWrap<R, V> wrap[kMostWraps];
  int points, terms, wraps, world;  ///< world: bits of the frame bodies that are the world
};

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

/// Second derivative by the motion of one body.
struct Curve6 {
  Real m[6][6];

  RUBBLE_HD void addOuter(const Vec6& j, Real s) {
    const Real v[6] = {j.lin.x, j.lin.y, j.lin.z, j.ang.x, j.ang.y, j.ang.z};
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k < 6; ++k) m[i][k] += s * v[i] * v[k];
  }
  /// s (a b^T + b a^T) / 2 of rotations.
  RUBBLE_HD void addTurn(const Vec3& a, const Vec3& b, Real s) {
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) m[3 + i][3 + k] += s * (a[i] * b[k] + b[i] * a[k]) / 2;
  }
  RUBBLE_HD void addTurn(const Sym3& a, Real s) {
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) m[3 + i][3 + k] += s * a.column(k)[i];
  }
  /// s S(f, r): of f . exp(w) r.
  RUBBLE_HD void addLever(const Vec3& f, const Vec3& r, Real s) {
    addTurn(f, r, s);
    const Real along = s * dot(f, r);
    for (int i = 3; i < 6; ++i) m[i][i] -= along;
  }
  /// s u . (translation x rotation), for a direction u that turns with the body.
  RUBBLE_HD void addMixed(const Vec3& u, Real s) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 column = s * cross(u, unitAxis(k));
      for (int i = 0; i < 3; ++i) m[i][3 + k] += column[i], m[3 + k][i] += column[i];
    }
  }
  /// Of s |d|, where the body moves the head of d = |d| n by its lever r.
  RUBBLE_HD void addLength(const Vec3& n, Real size, const Vec3& r, Real s) {
    addLever(n, r, s);
    if (s < Real(0) || !(size > kNoDistance)) return;
    for (int i = 0; i < 3; ++i) {
      const Vec3 across = unitAxis(i) - n * n[i];
      // the square root of P: its columns are those of 1 - n n^T
      addOuter({across, cross(r, across)}, s / size);
    }
  }
  RUBBLE_HD Vec6 columnNorms() const {
    Real norm[6];
    for (int k = 0; k < 6; ++k) {
      Real sum = 0;
      for (int i = 0; i < 6; ++i) sum += m[i][k] * m[i][k];
      norm[k] = std::sqrt(sum);
    }
    return {{norm[0], norm[1], norm[2]}, {norm[3], norm[4], norm[5]}};
  }
};

struct TendonAxis {
  static constexpr int kRows = 1;
  static constexpr RowUnit kUnit = RowUnit::Linear;
  static constexpr bool kAxis = true;
  static constexpr Real kStiffnessShare = kCouplingShare;

  template <class D, class M>
  RUBBLE_HD static Pose sidePose(const D& d, const M& m, const FrameBodyPose& a, const FrameBodyPose& b,
                                 int side) {
    Pose pose = side == 0 ? Pose(a) : side == 1 ? Pose(b) : side == 2 ? a.frameBody : b.frameBody;
    if (d.world >> side & 1) pose.p = m.world;
    return pose;
  }
  /// A term: q, and at a side dq/dx.
  template <class T> struct Coordinate {
    const T& term;
    Pose body, frame;

    RUBBLE_HD Quat base() const { return frame.q * term.base; }
    RUBBLE_HD Quat turn() const { return shortArc(conjugate(base()) * body.q * term.frame); }
    RUBBLE_HD Vec3 lever() const { return rotate(body.q, term.anchor); }
    RUBBLE_HD int cardan() const { return term.kind - 2; }
    RUBBLE_HD CardanDerivatives cardanDerivatives() const {
      return CardanAngles(turn(), term.tilts).derivatives(base());
    }
    /// Within one revolution.
    RUBBLE_HD Real angle() const {
      return term.kind == 0 ? twistAngle(turn()) : CardanAngles(turn(), term.tilts).angle(cardan());
    }
    RUBBLE_HD Real value(const RevolutionCounter& counter) const {
      if (term.kind != 1) {
        const Real zero = term.kind == 0 ? Real(0) : term.begin.x;
        return counter.nearest(angle()) + static_cast<Real>(counter.turned()) - zero;
      }
      return dot(rotate(base(), Vec3{1, 0, 0}), body.p + lever() - frame.p - rotate(frame.q, term.begin));
    }
    RUBBLE_HD Vec6 gradient(bool ofFrame) const {
      if (term.kind != 1) {
        const Vec3 g = term.kind == 0 ? rotate(base(), twistGradient(turn()))
                                      : cardanDerivatives().g[cardan()];
        return {{0, 0, 0}, ofFrame ? -g : g};
      }
      const Vec3 u = rotate(base(), Vec3{1, 0, 0}), r = lever();
      return ofFrame ? -Vec6{u, cross(body.p + r - frame.p, u)} : Vec6{u, cross(r, u)};
    }
    RUBBLE_HD void bend(bool ofFrame, Real s, Curve6& sum) const {
      if (term.kind >= 2) return sum.addTurn(cardanDerivatives().second(cardan()), s);
      if (term.kind == 0) {
        const Vec3 g = twistGradient(turn());
        return sum.addTurn(rotate(base(), g), rotate(base(), Vec3{0, g.z, -g.y}), -s);
      }
      const Vec3 u = rotate(base(), Vec3{1, 0, 0}), r = lever();
      sum.addLever(u, ofFrame ? body.p + r - frame.p : r, s);
      if (ofFrame) sum.addMixed(u, s);
    }
    /// f, f' or f'' at q.
    RUBBLE_HD Real polynomial(Real q, int derivative) const {
      const Real* c = term.c;
      return derivative == 0   ? q * (c[0] + q * (c[1] + q * (c[2] + q * c[3])))
             : derivative == 1 ? c[0] + q * (2 * c[1] + q * (3 * c[2] + q * 4 * c[3]))
                               : 2 * c[1] + q * (6 * c[2] + q * 12 * c[3]);
    }
  };
  template <class D, class M>
  RUBBLE_HD static auto coordinate(const D& d, const M& m, const FrameBodyPose& a, const FrameBodyPose& b,
                                   int k) {
    const auto& term = d.term[k];
    return Coordinate<std::remove_cvref_t<decltype(term)>>{term, sidePose(d, m, a, b, term.body),
                                                           sidePose(d, m, a, b, term.frameBody)};
  }
  /// Calls f(weight, side of the first end, side of the second, levers, span) for each straight piece.
  /// Returns the weighted length on what is wrapped [m].
  template <class D, class M, class Function>
  RUBBLE_HD static Real forEachPiece(const D& d, const M& m, const FrameBodyPose& a, const FrameBodyPose& b,
                                     Function&& f) {
    Real curved = 0;
    for (int i = 0; i + 1 < d.points; ++i) {
      const Real weight = d.point[i].weight;
      if (!(weight > Real(0))) continue;
      const int first = d.point[i].side, last = d.point[i + 1].side;
      const Pose from = sidePose(d, m, a, b, first), to = sidePose(d, m, a, b, last);
      const Vec3 r = rotate(from.q, d.point[i].at), s = rotate(to.q, d.point[i + 1].at);
      int k = 0;
      while (k < d.wraps && d.wrap[k].point != i) ++k;
      if (k < d.wraps) {
        const auto& wrap = d.wrap[k];
        const Pose on = sidePose(d, m, a, b, wrap.side);
        const Vec3 center = rotate(on.q, wrap.center), guide = rotate(on.q, wrap.guide);
        const WrappedArc arc = wrapAround((from.p - on.p) + r - center, (to.p - on.p) + s - center,
                                          rotate(on.q, wrap.axis), wrap.radius,
                                          wrap.guided != 0 ? &guide : nullptr);
        if (arc.touches) {
          const Vec3 begin = center + arc.begin, end = center + arc.end;
          f(weight, first, wrap.side, r, begin, (on.p - from.p) + begin - r);
          f(weight, wrap.side, last, end, s, (to.p - on.p) + s - end);
          curved += weight * arc.length;
          continue;
        }
      }
      f(weight, first, last, r, s, (to.p - from.p) + s - r);
    }
    return curved;
  }

  template <class D, class M>
  RUBBLE_HD static void constraint(const D& d, const M& m, const FrameBodyPose& a, const FrameBodyPose& b,
                                   Real (&c)[kRows]) {
    Real straight = 0;
    c[0] = forEachPiece(d, m, a, b, [&](Real weight, int, int, const Vec3&, const Vec3&, const Vec3& span) {
      straight += weight * length(span);
    });
    c[0] += straight;
    for (int k = 0; k < d.terms; ++k) {
      const auto q = coordinate(d, m, a, b, k);
      c[0] += q.polynomial(q.value(m.counter[k]), 0);
    }
  }
  template <class D, class M>
  RUBBLE_HD static void jacobian(const D& d, const M& m, const FrameBodyPose& a, const FrameBodyPose& b,
                                 int side, Vec6 (&j)[kRows]) {
    j[0] = {{0, 0, 0}, {0, 0, 0}};
    forEachPiece(d, m, a, b, [&](Real w, int from, int to, const Vec3& r, const Vec3& s, const Vec3& span) {
      if (from == to || (from != side && to != side)) return;
      Vec3 n;
      direction(span, n);
      j[0] += from == side ? Vec6{-w * n, -w * cross(r, n)} : Vec6{w * n, w * cross(s, n)};
    });
    for (int k = 0; k < d.terms; ++k) {
      if (d.term[k].body != side && d.term[k].frameBody != side) continue;
      const auto q = coordinate(d, m, a, b, k);
      j[0] += q.polynomial(q.value(m.counter[k]), 1) * q.gradient(d.term[k].frameBody == side);
    }
  }
  template <class D, class M>
  RUBBLE_HD static Vec6 curvature(const D& d, const M& m, const FrameBodyPose& a, const FrameBodyPose& b,
                                  int side, const Real (&f)[kRows]) {
    Curve6 sum{};
    forEachPiece(d, m, a, b, [&](Real w, int from, int to, const Vec3& r, const Vec3& s, const Vec3& span) {
      if (from == to || (from != side && to != side)) return;
      Vec3 n;
      const Real size = direction(span, n);
      if (from == side)
        sum.addLength(-n, size, r, w * f[0]);
      else
        sum.addLength(n, size, s, w * f[0]);
    });
    for (int k = 0; k < d.terms; ++k) {
      const bool ofFrame = d.term[k].frameBody == side;
      if (!ofFrame && d.term[k].body != side) continue;
      const auto q = coordinate(d, m, a, b, k);
      const Real at = q.value(m.counter[k]);
      q.bend(ofFrame, f[0] * q.polynomial(at, 1), sum);
      sum.addOuter(q.gradient(ofFrame), f[0] * q.polynomial(at, 2));
    }
    return sum.columnNorms();
  }
};

struct TendonJoint {
  static constexpr const char* kName = "tendon";
  static constexpr bool kGrounded = false, kHasFrameBodies = true;
  using Parts = PartList<TendonAxis>;
  using Constants = TendonPath<double, rubble::Vec3, rubble::Quat>;
  struct Data : TendonPath<Real, Vec3, Quat> {
    static Data of(const EngineJoint& j) {
      const auto own = j.constants.get<Constants>();
      Data out{};
      out.points = own.points, out.terms = own.terms, out.wraps = own.wraps;
      out.world = (j.frameBodyA == kWorld ? 4 : 0) | (j.frameBodyB == kWorld ? 8 : 0);
      for (int i = 0; i < own.points; ++i)
        out.point[i] = {Vec3(own.point[i].at), Real(own.point[i].weight), own.point[i].side};
      for (int i = 0; i < own.wraps; ++i) {
        const auto& w = own.wrap[i];
        out.wrap[i] = {Vec3(w.center), Vec3(w.axis), Vec3(w.guide), Real(w.radius),
                       w.point,        w.side,       w.guided};
      }
      for (int i = 0; i < own.terms; ++i) {
        const auto& t = own.term[i];
        out.term[i] = {Quat(t.base),
                       Quat(t.frame),
                       Vec3(t.begin),
                       Vec3(t.anchor),
                       {Real(t.c[0]), Real(t.c[1]), Real(t.c[2]), Real(t.c[3])},
                       t.kind,
                       t.body,
                       t.frameBody,
                       t.tilts.as<Real>()};
      }
      return out;
    }
  };
  struct Memory {
    Vec3 world;  ///< origin of the world relative to p_B^t [m]
    RevolutionCounter counter[Data::kMostTerms];
    template <class D>
    RUBBLE_HD void remember(const D& d, const FrameBodyPose& a, const FrameBodyPose& b, const Vec3d& origin) {
      world = Vec3(Vec3d{} - origin);
      for (int k = 0; k < d.terms; ++k)
        if (d.term[k].kind != 1) counter[k].follow(TendonAxis::coordinate(d, *this, a, b, k).angle());
    }
  };
};

struct TendonKind {
  using Joint = TendonJoint;
  static constexpr const char* kName = "tendon";
  static constexpr const char*
      kDoc = "length over points of up to four bodies, and functions of the coordinates between them";
  static constexpr int kPointNumbers = 5, kTermNumbers = 13, kWrapNumbers = 13;
  static constexpr auto kFields = std::tuple_cat(
      std::tuple{
          field("path", "1, m", "five numbers for each point: side, x, y, z, weight of the segment",
                &TendonFields::path),
          field("terms", "1, m", "thirteen numbers for each coordinate: kind, sides, axis, anchor, c_1-4",
                &TendonFields::terms),
          field("wraps", "1, m", "thirteen numbers for each sphere or cylinder that the path goes around",
                &TendonFields::wraps),
          field("tilts", "rad", "two numbers for each coordinate: tilts of the gimbal that it is an angle of",
                &TendonFields::tilts)},
      kBreakForceField);

  static rubble::Quat fromRotationVector(const rubble::Vec3& v) {
    const double angle = length(v);
    return angle > 0 ? fromAxisAngle(v / angle, angle) : rubble::Quat{};
  }
  static void build(JointBuild& b) {
    const TendonFields& own = ownIn<TendonFields>(b.def.own);
    TendonJoint::Constants out{};
    const auto of = [&](double side) -> const JointBodyState& {
      return side == 0   ? b.bodies.a
             : side == 1 ? b.bodies.b
             : side == 2 ? b.bodies.frameBodyA
                         : b.bodies.frameBodyB;
    };
    for (std::size_t i = 0; i < own.path.size(); i += kPointNumbers) {
      const double* n = &own.path[i];
      out.point[out.points++] = {of(n[0]).inEngineFrame({n[1], n[2], n[3]}), n[4], static_cast<int>(n[0])};
    }
    for (std::size_t i = 0; i < own.wraps.size(); i += kWrapNumbers) {
      const double* n = &own.wraps[i];
      const JointBodyState& body = of(n[1]);
      const rubble::Vec3 axis = normalize(rubble::Vec3{n[5], n[6], n[7]}, {});
      out.wrap[out.wraps++] = {body.inEngineFrame({n[2], n[3], n[4]}),
                               rotateInverse(body.axes, axis),
                               rotateInverse(body.axes, {n[10], n[11], n[12]}),
                               n[8],
                               static_cast<int>(n[0]),
                               static_cast<int>(n[1]),
                               static_cast<int>(n[9])};
    }
    const TendonJoint::Constants before = b.before ? b.before->constants.get<TendonJoint::Constants>() : out;
    for (std::size_t i = 0; i < own.terms.size(); i += kTermNumbers) {
      const double* n = &own.terms[i];
      const JointBodyState &body = of(n[1]), &frame = of(n[2]);
      auto& term = out.term[out.terms++];
      term = {{},
              normalize(conjugate(body.axes) * frameAlong({n[3], n[4], n[5]})),
              {},
              body.inEngineFrame({n[6], n[7], n[8]}),
              {n[9], n[10], n[11], n[12]},
              static_cast<int>(n[0]),
              static_cast<int>(n[1]),
              static_cast<int>(n[2]),
              {}};
      term.base = normalize(conjugate(frame.orientation) * body.orientation * term.frame);
      term.begin = rotateInverse(frame.orientation, body.point(term.anchor) - frame.position);
      if (term.kind >= 2) {
        const std::size_t at = i / kTermNumbers * 2;
        const auto tilt = [&](std::size_t k) { return own.tilts.empty() ? 0 : own.tilts[at + k]; };
        term.tilts = GimbalTilts<double>::of(tilt(0), tilt(1));
        term.frame = normalize(conjugate(body.axes) * fromRotationVector({n[3], n[4], n[5]}));
        term.base = normalize(conjugate(frame.axes) * fromRotationVector({n[6], n[7], n[8]}));
        const rubble::Quat turn = conjugate(frame.orientation * term.base) * body.orientation * term.frame;
        const CardanAngles angles(shortArc(Quat(turn)), term.tilts.as<Real>());
        term.begin = {double(angles.angle(term.kind - 2)), 0, 0};
      }
      if (b.before && out.terms <= before.terms)
        term.base = before.term[out.terms - 1].base, term.begin = before.term[out.terms - 1].begin;
    }
    b.joint.constants.set(out);
    b.joint.isRigid = false;
  }
  static void check(const JointDef& def, const Path& path) {
    const TendonFields& own = ownIn<TendonFields>(def.own);
    const auto whole = [&](double value, double most, const Path& at) {
      if (!(value >= 0 && value <= most && value == std::floor(value)))
        throw Error(at, "a whole number up to " + numberText(most), numberText(value));
    };
    const auto size = [&](std::size_t numbers, int each, int most, const char* name) {
      if (numbers % static_cast<std::size_t>(each) != 0 || numbers > static_cast<std::size_t>(each * most))
        throw Error(path + name, numberText(each) + " numbers for each of at most " + numberText(most),
                    numberText(static_cast<double>(numbers)));
    };
    size(own.path.size(), kPointNumbers, TendonJoint::Constants::kMostPoints, ".path");
    size(own.terms.size(), kTermNumbers, TendonJoint::Constants::kMostTerms, ".terms");
    size(own.wraps.size(), kWrapNumbers, TendonJoint::Constants::kMostWraps, ".wraps");
    if (!own.tilts.empty() && own.tilts.size() != own.terms.size() / kTermNumbers * 2)
      throw Error(path + ".tilts", "two numbers for each term", numberText(double(own.tilts.size())));
    for (std::size_t i = 0; i < own.tilts.size(); ++i)
      GimbalKind::checkTilt(own.tilts[i], (path + ".tilts")[i]);
    for (std::size_t i = 0; i < own.wraps.size(); i += kWrapNumbers) {
      whole(own.wraps[i], static_cast<double>(own.path.size()) / kPointNumbers - 2, (path + ".wraps")[i]);
      whole(own.wraps[i + 1], 3, (path + ".wraps")[i + 1]);
      if (!(own.wraps[i + 8] > 0))
        throw Error((path + ".wraps")[i + 8], "a radius above 0 [m]", numberText(own.wraps[i + 8]));
      whole(own.wraps[i + 9], 1, (path + ".wraps")[i + 9]);
      for (std::size_t k = 0; k < i; k += kWrapNumbers)
        if (own.wraps[k] == own.wraps[i])
          throw Error((path + ".wraps")[i], "one sphere or cylinder for each segment", "two");
    }
    if (own.path.size() < 2 * kPointNumbers && own.terms.empty())
      throw Error(path + ".path", "two points, or a term", "neither");
    for (std::size_t i = 0; i < own.path.size(); i += kPointNumbers) {
      whole(own.path[i], 3, (path + ".path")[i]);
      if (own.path[i + 4] < 0) throw Error((path + ".path")[i + 4], "a weight of at least 0", "less");
    }
    for (std::size_t i = 0; i < own.terms.size(); i += kTermNumbers) {
      whole(own.terms[i], 4, (path + ".terms")[i]);
      whole(own.terms[i + 1], 3, (path + ".terms")[i + 1]),
          whole(own.terms[i + 2], 3, (path + ".terms")[i + 2]);
      if (own.terms[i + 1] == own.terms[i + 2])
        throw Error((path + ".terms")[i + 2], "another side than the one that moves", "the same");
      if (own.terms[i] < 2 && !(std::hypot(own.terms[i + 3], own.terms[i + 4], own.terms[i + 5]) > 1e-9))
        throw Error((path + ".terms")[i + 3], "a direction", "zeros");
    }
  }
};

}  // namespace rubble::RUBBLE_CORE
