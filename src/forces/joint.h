#pragma once
/// What all joints share: two bodies, a list of parts, and the loops over them. A joint type F declares
///
///   kName      keyword
///   Parts      PartList<...> of constraints (linear_parts.h, angular_parts.h, or its own)
///   Data       authored constants, with a static function of(const EngineJoint&)
///   Memory     state besides multipliers that is kept between steps (NoMemory, or a struct with
///              remember(data, a, b, origin))
///   kGrounded  true: its errors change when both bodies move rigidly together (it refers to the world)
///   kHasFrameBodies   true: the axes of A and B are fixed in two further bodies, the frame bodies
///              (optional; gears and racks)
///   kChooses   true: its parts are activated step by step (optional): choose(spec, joint, a, b, bodies)
///              decides, Memory::takesPart(part) tells
///
/// A part P declares kRows, kUnit and kAxis. kAxis true: one scalar coordinate with limits, drive and
/// friction (axis.h). kAxis false: a group of rows with one stiffness and one bound on the norm of their
/// force. Further
///
///   constraint       C(x), for the poses of A and B in a common frame
///   jacobian         dC/dx of A (side 0) or B (side 1), rotations in world axes on the left; sides 2 and 3:
///                    the frame bodies of A and of B
///   curvature        column norms of sum F d2C/dx2 of that body
///   turns            axes: what full revolutions add to the coordinate (optional)
///   kStiffnessShare  axes: factor on the row inertia in k_start and in the growth of k (optional)
///
/// The rest follows from these: warm start, primal, dual, breakage, incidence, tests. What scenes say of it
/// is declared beside it, as joint kinds (forces/joint_build.h).
#include <utility>

#include "forces/axis.h"
#include "forces/contact.h"
#include "forces/joint_body.h"
#include "forces/joint_build.h"
#include "solver/dual.h"

namespace rubble::RUBBLE_CORE {

/// Body index of the fixed world.
inline constexpr int kWorldBody = -1;

template <class F> constexpr bool hasFrameBodies() {
  if constexpr (requires { F::kHasFrameBodies; })
    return F::kHasFrameBodies;
  else
    return false;
}
template <class F> constexpr bool choosesParts() {
  if constexpr (requires { F::kChooses; })
    return F::kChooses;
  else
    return false;
}
/// Sides of a joint: A, B and, if kHasFrameBodies, the frame bodies of A and of B. One body may be on several
/// sides.
template <class F> inline constexpr int kSides = hasFrameBodies<F>() ? 4 : 2;

/// Pose of a body and of the frame body of its axis.
struct FrameBodyPose : Pose {
  Pose frameBody;
};
/// Pose of A or B as the parts of a joint of type F read it.
template <class F> using SidePose = std::conditional_t<hasFrameBodies<F>(), FrameBodyPose, Pose>;

/// Body indices of the frame bodies, or kWorldBody. Empty for joints without.
template <bool present> struct FrameBodies {};
template <> struct FrameBodies<true> { int frameBodyA, frameBodyB; };
/// Positions of the frame bodies relative to p_B at x^t; 0 for the world, whose origin is at p_B [m].
template <bool present> struct FrameOffsets {};
template <> struct FrameOffsets<true> { Vec3 offsetFrameA, offsetFrameB; };

/// Stiffness share of couplings (gear, rack, pulley), which accelerate two bodies together. At 1 and 4
/// iterations the heavier mass of a pulley falls at 0.85 of its acceleration, and a rack at 0.76
/// (docs/joints.md).
inline constexpr Real kCouplingShare = Real(1) / 30;

template <class... P> struct PartList { static constexpr int kCount = sizeof...(P); };

struct AnchorRows;
/// Is F a joint about a point? Its anchors coincide, and its other rows depend on the rotation of A relative
/// to B only. Sweeps read its PivotFrame, its anchor rows and its angular rows, whose layout does not depend
/// on the type (forces/joint_accumulation.h).
template <class F> constexpr bool isPivot() {
  return []<class First, class... P>(PartList<First, P...>) {
    return std::is_same_v<First, AnchorRows> && ((P::kUnit == RowUnit::Angular) && ...) &&
           !hasFrameBodies<F>();
  }(typename F::Parts{});
}

/// Does part P depend on the rotation of A relative to B only? Its rows are linearized once per iteration
/// (forces/joint_accumulation.h).
template <class F, class P> constexpr bool isAngular() {
  return P::kUnit == RowUnit::Angular && !hasFrameBodies<F>();
}
/// Number of force laws of such a part: limit, drive, friction and rotor for an axis, else one.
template <class F, class P> constexpr int angularLaws() { return !isAngular<F, P>() ? 0 : P::kAxis ? 4 : 1; }
/// Number of force laws of the parts of F before part I; without I, of all parts.
template <class F, int I = F::Parts::kCount> constexpr int firstAngularLaw() {
  int laws = 0, part = 0;
  [&]<class... P>(PartList<P...>) {
    ((laws += part++ < I ? angularLaws<F, P>() : 0), ...);
  }(typename F::Parts{});
  return laws;
}
template <class F> constexpr bool hasAngularRows() { return firstAngularLaw<F>() > 0; }
/// Bit of force law `law` in JointFrame::acting. Bit 0 is the first part.
constexpr int angularBit(int law) { return 1 + law; }

/// Authored parameters of a group of rows. Joint records are aligned for loadVectorized.
struct alignas(4 * sizeof(Real)) GroupSpec {
  GroupMode mode;
  Real stiffness, damping;  ///< kHardValue: hard
  Real bound;               ///< largest norm of the force [N], [N m]
};

/// Multipliers and step state of a group of rows.
template <int N> struct alignas(4 * sizeof(Real)) GroupRows {
  Real lambda[N];    ///< [N], [N m]
  Real shift[N];     ///< part of C(x^t) that is not corrected in this step
  GroupState state;  ///< k is kept between steps; 0 before the first
};

template <class P> using PartSpec = std::conditional_t<P::kAxis, AxisSpec, GroupSpec>;
template <class P> using PartRows = std::conditional_t<P::kAxis, AxisRows, GroupRows<P::kRows>>;

template <int I, class T> struct PartSlot { T value; };
template <template <class> class Of, class List, class Sequence> struct PartStoreOf;
template <template <class> class Of, class... P, std::size_t... I>
struct PartStoreOf<Of, PartList<P...>, std::index_sequence<I...>> : PartSlot<static_cast<int>(I), Of<P>>... {
};
/// One Of<P> for each part P of a list.
template <template <class> class Of, class List>
using PartStore = PartStoreOf<Of, List, std::make_index_sequence<static_cast<std::size_t>(List::kCount)>>;

template <int I, class T> RUBBLE_HD T& partOf(PartSlot<I, T>& slot) { return slot.value; }
template <int I, class T> RUBBLE_HD const T& partOf(const PartSlot<I, T>& slot) { return slot.value; }

/// Calls f.operator()<I, P>() for each part.
template <class Function, class... P, std::size_t... I>
RUBBLE_HD void forEachPartOf(PartList<P...>, std::index_sequence<I...>, Function&& f) {
  (f.template operator()<static_cast<int>(I), P>(), ...);
}
template <class F, class Function> RUBBLE_HD void forEachPart(Function&& f) {
  forEachPartOf(typename F::Parts{}, std::make_index_sequence<static_cast<std::size_t>(F::Parts::kCount)>{},
                f);
}

template <class F> constexpr int rowCount() {
  int rows = 0;
  forEachPart<F>([&]<int, class P>() { rows += P::kRows; });
  return rows;
}

/// For joints without a memory of their own.
struct NoMemory {
  template <class D> RUBBLE_HD void remember(const D&, const Pose&, const Pose&, const Vec3d&) {}
};

/// Authored data of a joint of type F. Read-only in a step.
template <class F> struct JointSpec : FrameBodies<hasFrameBodies<F>()> {
  typename F::Data data;
  int a, b;  ///< bodies, or kWorldBody
  bool alive;
  bool isRigid;                  ///< does it connect its bodies rigidly, so that they form one aggregate?
  Real breakForce, breakTorque;  ///< [N], [N m]
  PartStore<PartSpec, typename F::Parts> parts;
};

/// One body of a joint about a point.
struct JointEnd {
  Vec3 lever;  ///< from its center of mass to its anchor, world axes at x^t [m]
  int body;
};
/// Frame of a joint, and which of its rows are active.
struct alignas(4 * sizeof(Real)) JointFrame {
  Vec3 offset;  ///< p_A - p_B at x^t [m]; the step works in a frame with origin p_B^t
  int acting;   ///< bit 0: the first part; bit 1 + k: force law k of the angular rows
};
struct PivotFrame : JointFrame {
  JointEnd end[2];
};

template <class F> using FrameOf = std::conditional_t<isPivot<F>(), PivotFrame, JointFrame>;

/// State of a joint of type F.
template <class F> struct Joint : FrameOf<F>, FrameOffsets<hasFrameBodies<F>()> {
  int broken;       ///< 0, 1
  int active;       ///< 0, 1: active in this step
  int sharedLevel;  ///< finest aggregate level at which its bodies share a cell (stages/coarse/aggregates.h)
  Real length;      ///< L: bounding diameter of the smaller dynamic body [m]
  typename F::Memory memory;
  PartStore<PartRows, typename F::Parts> parts;
};

template <class F> RUBBLE_HD FrameOf<F>& frameOf(Joint<F>& joint) { return joint; }
template <class F> RUBBLE_HD const FrameOf<F>& frameOf(const Joint<F>& joint) { return joint; }

template <class F> RUBBLE_HD int bodyOf(const JointSpec<F>& spec, int side) {
  if constexpr (hasFrameBodies<F>())
    if (side >= 2) return side == 2 ? spec.frameBodyA : spec.frameBodyB;
  return side == 0 ? spec.a : spec.b;
}
/// Is `side` the first side of its body?
template <class F> RUBBLE_HD bool isFirstSide(const JointSpec<F>& spec, int side) {
  if constexpr (hasFrameBodies<F>())
    for (int k = 0; k < side; ++k)
      if (bodyOf(spec, k) == bodyOf(spec, side)) return false;
  return true;
}

/// dC/dx of the body on that side: the sum over all sides of this body.
template <class P, class F>
RUBBLE_HD void jacobianOf(const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a,
                          const SidePose<F>& b, int side, Vec6 (&j)[P::kRows]) {
  P::jacobian(spec.data, joint.memory, a, b, side, j);
  if constexpr (hasFrameBodies<F>())
    for (int k = 0; k < kSides<F>; ++k) {
      if (k == side || bodyOf(spec, k) != bodyOf(spec, side)) continue;
      Vec6 more[P::kRows];
      P::jacobian(spec.data, joint.memory, a, b, k, more);
      for (int i = 0; i < P::kRows; ++i) j[i].lin += more[i].lin, j[i].ang += more[i].ang;
    }
}
/// Column norms for that body; for several sides the sum, which is an upper bound.
template <class P, class F>
RUBBLE_HD Vec6 curvatureOf(const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a,
                           const SidePose<F>& b, int side, const Real (&f)[P::kRows]) {
  Vec6 sum = P::curvature(spec.data, joint.memory, a, b, side, f);
  if constexpr (hasFrameBodies<F>())
    for (int k = 0; k < kSides<F>; ++k) {
      if (k == side || bodyOf(spec, k) != bodyOf(spec, side)) continue;
      const Vec6 more = P::curvature(spec.data, joint.memory, a, b, k, f);
      sum.lin += more.lin, sum.ang += more.ang;
    }
  return sum;
}

template <class P, class F>
RUBBLE_HD void beginPart(const StepConstants& c, const JointSpec<F>& spec, const Joint<F>& joint,
                         const GroupSpec& own, GroupRows<P::kRows>& rows, const SidePose<F>& a,
                         const SidePose<F>& b, const JointBody (&bodies)[kSides<F>], Real bound, bool) {
  GroupState& state = rows.state;
  if (own.mode == GroupMode::Off) return;
  Real error[P::kRows];
  P::constraint(spec.data, joint.memory, a, b, error);
  const Real inertia = lighter(bodies[0], bodies[1], [&](const JointBody& body, int side) {
    return rowInertia(body, P::kUnit, lengthSquared(localLever(spec.data, side)));
  });
  const Real damping = own.damping * c.inverseDt;
  const bool hard = own.stiffness >= kHardValue, friction = own.mode == GroupMode::Friction,
             ramp = !hard && !c.compliantRows;
  const Real total = hard ? own.stiffness : own.stiffness + damping;
  StiffnessRule rule = jointRule(c, startStiffness(c, inertia),
                                 P::kUnit == RowUnit::Linear ? joint.length : Real(1));
  if (ramp) {
    rule.policy = StiffnessPolicy::Ramp;
    rule.limit = min(rule.limit, total);
    rule.start = min(rule.start, rule.limit);
  }
  const Real share = friction ? Real(1) : hard ? c.alpha : damping / total;
  // a new row of finite stiffness starts with its elastic load at x^t
  const bool isNew = !(state.k > Real(0)), isLoaded = isNew && !hard && !friction;
  Real size = 1, size2 = 0;
  if (P::kUnit == RowUnit::Linear && isLoaded)
    size = joint.length + length(localLever(spec.data, 0)) + length(localLever(spec.data, 1));
  for (int i = 0; i < P::kRows; ++i) {
    rows.lambda[i] = ramp       ? Real(0)
                     : isLoaded ? own.stiffness * beyondRoundOff(error[i], size)
                                : warmMultiplier(c, rows.lambda[i], hard && !friction);
    rows.shift[i] = share * error[i];
    size2 += rows.lambda[i] * rows.lambda[i];
  }
  const Real k = isNew ? newStiffness(rule, std::sqrt(size2))
                       : warmStiffness(c, rule, state.k, std::sqrt(size2));
  state = {k, hard || ramp ? Real(0) : Real(1) / total, min(own.bound, bound), rule, !ramp};
}

/// Mean speed of an axis in a step that ends at x^t with the velocities of x^t. J v alone misses half of what
/// the curvature of the axis adds to its acceleration, at any time step.
template <class P, class F>
RUBBLE_HD Real speedBefore(const StepConstants& c, const JointSpec<F>& spec, const Joint<F>& joint,
                           const SidePose<F>& a, const SidePose<F>& b, const JointBody (&bodies)[kSides<F>],
                           Real value) {
  const auto before = [&](const Pose& x, int side) {
    const Vec6& v = bodies[side].velocity;
    return Pose{x.p - c.dt * v.lin, expRotation(-c.dt * v.ang) * x.q};
  };
  Real then[1];
  if constexpr (hasFrameBodies<F>())
    P::constraint(spec.data, joint.memory, {before(a, 0), before(a.frameBody, 2)},
                  {before(b, 1), before(b.frameBody, 3)}, then);
  else
    P::constraint(spec.data, joint.memory, before(a, 0), before(b, 1), then);
  return (value - then[0]) * c.inverseDt;
}

template <class P, class F>
RUBBLE_HD void beginPart(const StepConstants& c, const JointSpec<F>& spec, const Joint<F>& joint,
                         const AxisSpec& own, AxisRows& rows, const SidePose<F>& a, const SidePose<F>& b,
                         const JointBody (&bodies)[kSides<F>], Real bound, bool together) {
  Real value[1];
  Vec6 ja[1], jb[1];
  P::constraint(spec.data, joint.memory, a, b, value);
  jacobianOf<P>(spec, joint, a, b, 0, ja);
  jacobianOf<P>(spec, joint, a, b, 1, jb);
  AxisSituation at;
  at.value = value[0];
  at.turn = 0;
  if constexpr (requires { P::turns(spec.data, joint.memory); })
    at.turn = static_cast<Real>(P::turns(spec.data, joint.memory));
  at.change = dot(ja[0], bodies[0].change) + dot(jb[0], bodies[1].change);
  at.speed = own.armature > Real(0) ? speedBefore<P>(c, spec, joint, a, b, bodies, value[0]) : Real(0);
  at.inertia = lighter(bodies[0], bodies[1], [&](const JointBody& body, int side) {
    const Quat& q = side == 0 ? a.q : b.q;
    return axisInertia(body, q, side == 0 ? ja[0] : jb[0], leverOf(spec.data, q, side));
  });
  if constexpr (hasFrameBodies<F>())
    for (int side = 2; side < kSides<F>; ++side) {
      if (!isFirstSide(spec, side) || !(bodies[side].mass > Real(0))) continue;
      Vec6 j[1];
      jacobianOf<P>(spec, joint, a, b, side, j);
      at.change += dot(j[0], bodies[side].change);
      // the Jacobian of a frame body may vanish, as for wheels that counter-rotate
      const Real arm = P::kUnit == RowUnit::Linear ? joint.length : Real(1);
      if (!(lengthSquared(j[0].lin) + lengthSquared(j[0].ang) / (arm * arm) > Real(1e-8))) continue;
      const Real own = axisInertia(bodies[side], side == 2 ? a.frameBody.q : b.frameBody.q, j[0], {0, 0, 0});
      at.inertia = at.inertia > Real(0) ? min(at.inertia, own) : own;
    }
  // block descent moves one body at a time, so two bodies that a coupling accelerates together lag behind in
  // proportion to its stiffness
  if constexpr (requires { P::kStiffnessShare; })
    if (!together) at.inertia *= P::kStiffnessShare;
  at.length = P::kUnit == RowUnit::Linear ? joint.length : Real(1);
  at.reach = P::kUnit == RowUnit::Linear ? Real(1) : joint.length / 2;
  at.bound = bound;
  at.size = joint.length;
  beginAxis(c, own, rows, at);
}

template <class P> RUBBLE_HD RUBBLE_NEAR bool partActs(const PartSpec<P>& spec, const PartRows<P>& rows) {
  if constexpr (P::kAxis)
    return actsAtAll(rows);
  else
    return spec.mode != GroupMode::Off && (spec.mode != GroupMode::Point || rows.state.k > Real(0));
}
/// Is a force law of the given rotation-only part active?
template <class F> RUBBLE_HD bool turnActs(int acting, int part) {
  bool active = false;
  forEachPart<F>([&]<int I, class P>() {
    if (I == part)
      active = (acting >> angularBit(firstAngularLaw<F, I>()) & ((1 << angularLaws<F, P>()) - 1)) != 0;
  });
  return active;
}
/// Computes JointFrame::acting.
template <class F> RUBBLE_HD int actingRows(const JointSpec<F>& spec, const Joint<F>& joint) {
  int acting = 0;
  forEachPart<F>([&]<int I, class P>() {
    const auto& rows = partOf<I>(joint.parts);
    constexpr int kFirst = angularBit(firstAngularLaw<F, I>());
    if (I == 0) acting |= partActs<P>(partOf<I>(spec.parts), rows);
    if constexpr (isAngular<F, P>() && P::kAxis) {
      const int laws[] = {rows.limit.active, rows.drive.active, rows.friction.active, rows.rotor.active};
      for (int k = 0; k < angularLaws<F, P>(); ++k) acting |= (laws[k] != 0) << (kFirst + k);
    } else if constexpr (isAngular<F, P>()) {
      acting |= partActs<P>(partOf<I>(spec.parts), rows) << kFirst;
    }
  });
  return acting;
}

template <int N> RUBBLE_HD void restPart(GroupRows<N>& rows) {
  rows.state.k = 0;
  for (Real& lambda : rows.lambda) lambda = 0;
}

/// What a joint starts from at x^t. Poses are in the frame of the joint.
template <class F> struct JointStart {
  StepConstants constants;
  Vec3 offset;  ///< p_A - p_B [m]
  SidePose<F> a, b;
  JointBody bodies[kSides<F>];
  bool together;  ///< one joint tree solves both bodies (stages/trees/trees.h)
};

/// Activates the parts of a joint that chooses them; before beginPartOf().
template <class F>
RUBBLE_HD void chooseParts(const JointStart<F>& x, const JointSpec<F>& spec, Joint<F>& joint) {
  if constexpr (choosesParts<F>()) F::choose(spec, joint, x.a, x.b, x.bodies);
}
/// Warm start of the rows of part I at x^t; joint.length and joint.memory are set. Reads no other part.
template <class F, int I, class P>
RUBBLE_HD void beginPartOf(const JointStart<F>& x, const JointSpec<F>& spec, Joint<F>& joint) {
  if constexpr (choosesParts<F>())
    if (!joint.memory.takesPart(I)) return restPart(partOf<I>(joint.parts));
  const Real bound = P::kUnit == RowUnit::Linear ? spec.breakForce : spec.breakTorque;
  beginPart<P>(x.constants, spec, joint, partOf<I>(spec.parts), partOf<I>(joint.parts), x.a, x.b, x.bodies,
               bound, x.together);
}
/// Warm start of all rows.
template <class F>
RUBBLE_HD void beginJoint(const JointStart<F>& x, const JointSpec<F>& spec, Joint<F>& joint) {
  chooseParts(x, spec, joint);
  forEachPart<F>([&]<int I, class P>() { beginPartOf<F, I, P>(x, spec, joint); });
}
/// Stores the frame of the joint at x^t and its active rows; after the warm start.
template <class F>
RUBBLE_HD void placeJoint(const JointStart<F>& x, const JointSpec<F>& spec, Joint<F>& joint) {
  storeVectorized(frameOf(joint), [&](FrameOf<F>& frame) {
    frame.offset = x.offset;
    frame.acting = actingRows(spec, joint);
    if constexpr (isPivot<F>())
      for (int side = 0; side < 2; ++side)
        frame.end[side] = {leverOf(spec.data, side == 0 ? x.a.q : x.b.q, side), bodyOf(spec, side)};
    return true;
  });
}

/// Errors of a group of rows, less their shifts: of one joint (L = Real) or of SIMD lanes (math/lanes.h).
template <class P, class L, class D, class M, class S>
RUBBLE_HD RUBBLE_NEAR void heldErrors(const L (&shift)[P::kRows], const D& data, const M& memory, const S& a,
                                      const S& b, L (&error)[P::kRows]) {
  P::constraint(data, memory, a, b, error);
  for (int i = 0; i < P::kRows; ++i) error[i] -= shift[i];
}

/// Forces and Hessian stiffness of the rows of a part. `error`: C of an axis, or C less its shift for a group
/// of rows. Returns false if both are zero.
template <class P>
RUBBLE_HD RUBBLE_NEAR bool forcesAt(const PartRows<P>& rows, const Real (&error)[P::kRows],
                                    Real (&force)[P::kRows], Real& hessian) {
  if constexpr (P::kAxis) {
    axisForces(rows, error[0], force[0], hessian);
    return force[0] != Real(0) || hessian > Real(0);
  } else {
    aggregateForce<P::kRows>(rows.state, error, rows.lambda, force, P::kRows, hessian);
    return true;
  }
}
/// Errors of a part at the present poses, in the form that forcesAt expects.
template <class P, class F>
RUBBLE_HD RUBBLE_NEAR void partErrors(const JointSpec<F>& spec, const Joint<F>& joint,
                                      const PartRows<P>& rows, const SidePose<F>& a, const SidePose<F>& b,
                                      Real (&error)[P::kRows]) {
  if constexpr (P::kAxis)
    P::constraint(spec.data, joint.memory, a, b, error);
  else
    heldErrors<P>(rows.shift, spec.data, joint.memory, a, b, error);
}

template <class F, int I, class P>
RUBBLE_HD void updatePartDuals(const StepConstants& c, const JointSpec<F>& spec, Joint<F>& joint,
                               const SidePose<F>& a, const SidePose<F>& b) {
  updateVectorized(partOf<I>(joint.parts), [&](PartRows<P>& rows) {
    if (!partActs<P>(partOf<I>(spec.parts), rows)) return false;
    Real error[P::kRows];
    partErrors<P>(spec, joint, rows, a, b, error);
    if constexpr (P::kAxis)
      updateAxis(c, rows, error[0]);
    else
      updateGroup<P::kRows>(rows.state, error, rows.lambda, P::kRows);
    return true;
  });
}
template <class F>
RUBBLE_HD void updateJointDuals(const StepConstants& c, const JointSpec<F>& spec, Joint<F>& joint,
                                const SidePose<F>& a, const SidePose<F>& b) {
  forEachPart<F>([&]<int I, class P>() { updatePartDuals<F, I, P>(c, spec, joint, a, b); });
}

/// Squared norms of all linear and of all angular forces after the last dual update [N2], [N2 m2].
template <class F>
RUBBLE_HD void jointLoads(const JointSpec<F>& spec, const Joint<F>& joint, Real& linear, Real& angular) {
  linear = angular = Real(0);
  forEachPart<F>([&]<int I, class P>() {
    const auto& rows = partOf<I>(joint.parts);
    Real& sum = P::kUnit == RowUnit::Linear ? linear : angular;
    if constexpr (P::kAxis) {
      const Real load = axisLoad(rows);
      sum += load * load;
    } else if (partOf<I>(spec.parts).mode != GroupMode::Off) {
      for (int i = 0; i < P::kRows; ++i) sum += rows.lambda[i] * rows.lambda[i];
    }
  });
}

/// Marks the joint as broken if its force or torque has reached the break threshold; returns true then.
template <class F> RUBBLE_HD bool endJoint(const JointSpec<F>& spec, Joint<F>& joint) {
  Real linear, angular;
  jointLoads(spec, joint, linear, angular);
  // forces are cut to the threshold, so equality holds up to round-off only
  constexpr Real kReached = Real(1) - Real(1e-5);
  const bool broke = linear >= kReached * spec.breakForce * spec.breakForce ||
                     angular >= kReached * spec.breakTorque * spec.breakTorque;
  joint.broken |= broke;
  return broke;
}

}  // namespace rubble::RUBBLE_CORE
