#pragma once
/// Begin and end of the step of a body, and its primal update.
#include "stages/bodies/far_rotations.h"
#include "stages/ccd/fast_bodies.h"
#include "stages/contacts/arcs.h"
#include "stages/contacts/rolling.h"
#include "stages/soft/soft_rows.h"

namespace rubble::RUBBLE_CORE {

/// Damps v over a step by exp(-c dt). Returns the mean damping factor, (1 - exp(-c dt)) / (c dt), which
/// scales the impulse of a force.
RUBBLE_HD inline Real keptBy(Real damping, Real dt, Vec3& v) {
  const Decay decay = decayOver(damping * dt);
  v *= decay.left;
  return decay.mean;
}

/// Limits an angular velocity to what a step can represent.
RUBBLE_HD inline bool limitSpin(Vec3& w, Real dt) {
  constexpr Real kRoundOff = 1 + 8 * std::numeric_limits<Real>::epsilon();
  const Real turn = length(w) * dt;
  if (!(turn > kMaxSpinPerStep * kRoundOff)) return false;
  w *= kMaxSpinPerStep / turn;
  return true;
}

/// Inertial target y [S 2], mass matrix [S 8] and initial guess of every body.
struct PredictBodies {
  static constexpr const char* kStage = "predict";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const StepConstants c = s.stepOf(i);
    const BodyParams& p = s.params[i];
    Vec3 v = s.velocity[i], w = s.angularVelocity[i];
    s.fast[i] = 0;
    if (goesOnArcs(s, i) && atomicLoad(&s.counters->arcs) == 0) atomicRaise(&s.counters->arcs, 1);
    Displacement& moved = s.dx[i];
    if (!isDynamic(s, i)) {
      const bool moves = p.kind == BodyKind::Kinematic;
      moved = moves ? Displacement{c.dt * v, 0, c.dt * w, 0} : Displacement{{0, 0, 0}, 0, {0, 0, 0}, 0};
      s.dq[i] = expRotation(moved.dw);
      return;
    }
    const Quat q = s.orientation[i];
    Vec3 gravity = p.gravityScale * c.gravity, push = s.force[i] / p.mass, torque = s.torque[i];
    const BodyExtras& extras = s.extras[i];
    // exact for constant forces: v exp(-c dt) + a (1 - exp(-c dt)) / c
    if (extras.linearDamping > Real(0)) {
      const Real kept = keptBy(extras.linearDamping, c.dt, v);
      gravity *= kept, push *= kept;
    }
    if (extras.angularDamping > Real(0)) torque *= keptBy(extras.angularDamping, c.dt, w);
    if (limitSpin(w, c.dt)) atomicCount(&s.counters->spinLimited, 1);
    v = unlocked(v, extras.locks), gravity = unlocked(gravity, extras.locks),
    push = unlocked(push, extras.locks);
    Vec3 w1 = w;
    if (!s.plan.literalRotations) {
      // Only the change of w is rotated to the body frame and back. Round-off of the full rotation would make
      // a free spin grow by 1e-7 per step.
      const Vec3 inBody = rotateInverse(q, w);
      w1 += rotate(q, torqueFreeSpin(inBody, rotateInverse(q, torque), p.inertia, c.dt) - inBody);
    }
    w1 = unlocked(w1, extras.locks >> 3);
    BodyTarget target;
    target.mass = massMatrix(p.mass, p.inertia, q);
    target.locks = extras.locks;
    target.unused = 0;
    target.y.p = inertialDisplacement(v, gravity + push, c.dt);
    target.y.q = s.plan.literalRotations ? retract({{0, 0, 0}, Quat{}}, {{0, 0, 0}, c.dt * w1}).q
                                         : expRotation(c.dt * w1);

    // The guess follows the share of a force that the body followed in the last step. A new force has no such
    // share: the guess includes all of it, as if the body had been given a velocity.
    const bool newPush = (s.pushed[i] & kForced) == 0;
    const Vec3 known = newPush ? gravity : gravity + push;
    Vec3 guess = followedShare(v, s.previousVelocity[i], known, c.dt) * known;
    if (newPush) guess += push;
    s.pushed[i] = (s.pushed[i] & ~kForced) | (s.force[i] != Vec3{0, 0, 0} ? kForced : 0);
    // Contacts may also hold a torque, and a guess that lifts a body off its contact points loses their load.
    const bool twisted = torque != Vec3{0, 0, 0} && !s.plan.literalRotations;
    const Quat turned = twisted ? expRotation(c.dt * unlocked(w, extras.locks >> 3)) : target.y.q;
    storeWhole(moved, {inertialDisplacement(v, guess, c.dt), 0, logRotation(turned), 0});
    storeWhole(s.dq[i], turned);
    storeWhole(s.target[i], target);
  }
};

/// Pose of a body in the frame of a joint, whose origin is p_B^t; `offset` = p^t minus that origin.
RUBBLE_HD RUBBLE_NEAR Pose jointPose(const SolverData& s, int body, const Vec3& offset) {
  if (body == kWorldBody) return {offset, Quat{}};
  return {offset + s.dx[body].dp, s.dq[body] * s.orientation[body]};
}

/// Position of the joint origin p_B^t in the world.
RUBBLE_HD inline Vec3d jointOrigin(const SolverData& s, int body) {
  return body == kWorldBody ? Vec3d{} : s.position[body];
}

/// Pose of side A or B of a joint at the present iterate, with the pose of its frame body if it has one.
template <class F>
RUBBLE_HD SidePose<F> poseOfA(const SolverData& s, const JointSpec<F>& spec, const Joint<F>& joint) {
  if constexpr (hasFrameBodies<F>())
    return {jointPose(s, spec.a, joint.offset), jointPose(s, spec.frameBodyA, joint.offsetFrameA)};
  else
    return jointPose(s, spec.a, joint.offset);
}
template <class F>
RUBBLE_HD SidePose<F> poseOfB(const SolverData& s, const JointSpec<F>& spec, const Joint<F>& joint) {
  if constexpr (hasFrameBodies<F>())
    return {jointPose(s, spec.b, {0, 0, 0}), jointPose(s, spec.frameBodyB, joint.offsetFrameB)};
  else
    return jointPose(s, spec.b, {0, 0, 0});
}

/// Displacement and rotation of a body since x^t.
RUBBLE_HD RUBBLE_NEAR Pose poseSinceStart(const SolverData& s, int body) {
  // loads are issued unconditionally; the test for the world only selects the result
  const int i = max(body, 0);
  const Vec3 moved = s.dx[i].dp;
  const Quat turned = s.dq[i];
  return body == kWorldBody ? Pose{{0, 0, 0}, Quat{}} : Pose{moved, turned};
}

/// Data of an anchored joint that sweeps read. `from` and `laws` are null if its type has no angular rows.
struct Pivot {
  const PivotFrame* frame;
  const GroupRows<AnchorRows::kRows>* anchors;
  const AngularOrigin* from;
  const AngularRows* laws;
};
template <class F> RUBBLE_HD RUBBLE_NEAR Pivot pivotOf(const SolverData& s, int index) {
  const Joint<F>& joint = s.jointsOf<F>()[index];
  Pivot pivot{&joint, &partOf<0>(joint.parts), nullptr, nullptr};
  if constexpr (hasAngularRows<F>())
    pivot.from = &s.angularRowsOf<F>()[index].from, pivot.laws = s.angularRowsOf<F>()[index].law;
  return pivot;
}
/// The pivot of a constraint; false if it is not an anchored joint.
RUBBLE_HD RUBBLE_NEAR bool findPivot(const SolverData& s, std::uint32_t code, Pivot& pivot) {
  bool found = false;
  forEachType(JointTypes{}, [&]<class F>() {
    if constexpr (isPivot<F>())
      if (constraintType(code) == typeIndex<F>(JointTypes{}) + 1)
        pivot = pivotOf<F>(s, constraintIndex(code)), found = true;
  });
  return found;
}

/// Adds an anchored joint to the block of one of its bodies. shift(body) leads from the reference point of
/// the block to the center of the body. `ahead`: issues all loads at once.
template <bool ahead, class Shift>
RUBBLE_HD RUBBLE_NEAR void accumulatePivotOfBody(const SolverData& s, const Pivot& pivot, int side,
                                                 Block6& block, Shift&& shift) {
  const auto& frame = loadVectorized(*pivot.frame);
  const auto& anchors = loadVectorized(*pivot.anchors);
  const Pose a = poseSinceStart(s, frame.end[0].body), b = poseSinceStart(s, frame.end[1].body);
  AngularRowStream<ahead> turns(pivot.laws ? frame.acting : 0, pivot.from, pivot.laws);
  accumulatePivot(frame, anchors, turns, a, b, side, block, shift(frame.end[side].body));
}
/// Adds a joint of any type to the block of one of its bodies. `shift` leads from the reference point of the
/// block to the center of the body.
template <class F>
RUBBLE_HD RUBBLE_OUT_OF_LINE void accumulateJointOfBody(const SolverData& s, int index, int side,
                                                        Block6& block, const Vec3& shift) {
  if constexpr (isPivot<F>()) {
    accumulatePivotOfBody<false>(s, pivotOf<F>(s, index), side, block, [&](int) { return shift; });
  } else {
    const JointAngularRows<F>* const turns = hasAngularRows<F>() ? s.angularRowsOf<F>() + index : nullptr;
    const auto accumulate = [&](const JointSpec<F>& spec, const Joint<F>& joint) {
      Quat turnedA, turnedB;
      if constexpr (hasAngularRows<F>())
        turnedA = poseSinceStart(s, spec.a).q, turnedB = poseSinceStart(s, spec.b).q;
      accumulateJoint(spec, joint, turns, poseOfA(s, spec, joint), poseOfB(s, spec, joint), turnedA, turnedB,
                      side, block, shift);
    };
    // larger types exceed the registers and are read part by part
    constexpr bool isSmall = F::Parts::kCount == 1 &&
                             sizeof(JointSpec<F>) + sizeof(Joint<F>) <= 64 * sizeof(Real);
    if constexpr (isSmall && alignof(JointSpec<F>) == 4 * sizeof(Real))
      accumulate(loadVectorized(s.specsOf<F>()[index]), loadVectorized(s.jointsOf<F>()[index]));
    else
      accumulate(s.specsOf<F>()[index], s.jointsOf<F>()[index]);
  }
}

/// Adds the lanes of a block to a scalar block.
template <class L> RUBBLE_HD void addLanes(Block6& to, const Block6T<L>& from) {
  to.ll.xx += sumOf(from.ll.xx), to.ll.xy += sumOf(from.ll.xy), to.ll.xz += sumOf(from.ll.xz);
  to.ll.yy += sumOf(from.ll.yy), to.ll.yz += sumOf(from.ll.yz), to.ll.zz += sumOf(from.ll.zz);
  to.aa.xx += sumOf(from.aa.xx), to.aa.xy += sumOf(from.aa.xy), to.aa.xz += sumOf(from.aa.xz);
  to.aa.yy += sumOf(from.aa.yy), to.aa.yz += sumOf(from.aa.yz), to.aa.zz += sumOf(from.aa.zz);
  const auto add = [](Vec3& a, const Vec3T<L>& b) { a += Vec3{sumOf(b.x), sumOf(b.y), sumOf(b.z)}; };
  add(to.al0, from.al0), add(to.al1, from.al1), add(to.al2, from.al2);
  add(to.fl, from.fl), add(to.fa, from.fa);
}

/// Starts the local problem of a body with its inertia; returns the present pose.
RUBBLE_HD inline Pose startBlock(const SolverData& s, int i, Block6& block) {
  const BodyTarget& target = loadUnchanging(s.target[i]);
  const Real inverseDt2 = s.step->inverseDt * s.step->inverseDt;
  const Pose x{loadUnchanging(s.dx[i]).dp, loadUnchanging(s.dq[i])};
  setInertialForce(block, target.mass, x, target.y, inverseDt2);
  setInertialHessian(block, target.mass, inverseDt2);
  return x;
}

/// Adds points of a contact on one of its bodies. Their Hessian counts `weight` times.
template <class L>
RUBBLE_HD void addContact(const SolverData& s, std::uint32_t code, int lane, Block6T<L>& points,
                          Real weight = 1) {
  const ContactRows& r = s.contact[constraintIndex(code)];
  accumulateContact<L>(s.plan.coneHessian, r, constraintSide(code) == 0, s.dx[r.a], s.dx[r.b], lane, points,
                       {0, 0, 0}, weight);
}

/// Sums over contacts, separately per contact point, so that the order of additions does not depend on L.
template <class L> struct PointSums {
  static constexpr int kStep = sizeof(L) / sizeof(Real);
  Block6T<L> sum[kLanes / kStep];

  /// add(lane, sum) for the points that an L represents.
  template <class Add> RUBBLE_HD void each(Add&& add) {
    for (int lane = 0; lane < kLanes; lane += kStep) add(lane, sum[lane / kStep]);
  }
  RUBBLE_HD void add(const SolverData& s, std::uint32_t code, Real weight = 1) {
    each([&](int lane, Block6T<L>& points) { addContact<L>(s, code, lane, points, weight); });
  }
  RUBBLE_HD void addTo(Block6& to) const {
    if constexpr (kStep == kLanes) {
      addLanes(to, sum[0]);
    } else {
      // the order of sumOf in lanes.h
      static_assert(kStep == 1 && kLanes == 4);
      Block6 pairs[2] = {sum[0], sum[2]};
      pairs[0] += sum[1], pairs[1] += sum[3];
      pairs[0] += pairs[1];
      to += pairs[0];
    }
  }
};

/// Adds a constraint other than a contact.
RUBBLE_HD inline void addJoint(const SolverData& s, std::uint32_t code, Block6& block) {
  forEachType(JointTypes{}, [&]<class F>() {
    if (constraintType(code) == typeIndex<F>(JointTypes{}) + 1 && !isLink<F>(code))
      accumulateJointOfBody<F>(s, jointIndex<F>(code), jointSide<F>(code), block, {0, 0, 0});
  });
  if (constraintType(code) > JointTypes::kSize) addSoftRows(s, code, block);
}
/// The same with one code path for all anchored joints: lanes of a warp with different joint types stay
/// converged and issue their loads together. addOther(block) adds any other constraint.
template <class AddOther>
RUBBLE_HD void addJointUniform(const SolverData& s, std::uint32_t code, Block6& block, AddOther&& addOther) {
  if (Pivot pivot; findPivot(s, code, pivot))
    accumulatePivotOfBody<true>(s, pivot, constraintSide(code), block, [](int) { return Vec3{0, 0, 0}; });
  else
    addOther(block);
}

template <class L> RUBBLE_HD L squaredStep(const Vec3T<L>& to, const Vec3T<L>& from) {
  const Vec3T<L> d = to - from;
  return dot(d, d);
}

/// Solves the local problem of a body at x and applies its step.
RUBBLE_HD inline void finishBlock(const SolverData& s, int i, Block6 block, Pose x) {
  const BodyTarget& target = loadUnchanging(s.target[i]);
  if (target.locks != 0) lockAxes(block, target.locks);
  const Pose before = x;
  const Descent how = descend(block, target.mass, s.step->inverseDt * s.step->inverseDt, x);
  if (how != Descent::Newton)
    atomicCount(how == Descent::Failed ? &s.counters->failedSolves : &s.counters->boundedSteps, 1);
  if (how == Descent::Failed) return;
  storeWhole(s.dq[i], x.q);
  storeWhole(s.dx[i],
             {x.p, squaredStep(x.p, before.p), logRotation(x.q), Real(4) * squaredStep(x.q.v, before.q.v)});
}

/// Adds the constraints of a body, incidences [k, end).
template <class L> RUBBLE_HD void addRows(const SolverData& s, int k, int end, Block6& block) {
  if (k < end && constraintType(s.incidence[k].code) == kContactType) {
    PointSums<L> points;
    for (; k < end && constraintType(s.incidence[k].code) == kContactType; ++k) {
      points.add(s, s.incidence[k].code);
      if (s.rolls) addRolling(s, s.incidence[k].code, block);
    }
    points.addTo(block);
  }
  for (; k < end; ++k) addJoint(s, s.incidence[k].code, block);
}

/// The primal update of one body: force [S 5] and Hessian [S 6] of its inertia and its rows; one Newton step
/// [S 3].
template <class L> struct SolveBody {
  static constexpr const char* kStage = "primal";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Block6 block;
    const Pose x = startBlock(s, i, block);
    addRows<L>(s, s.incidenceOffset[i], s.incidenceOffset[i + 1], block);
    finishBlock(s, i, block, x);
  }
};

/// Velocity that gravity and forces gave a stopped body for the part of the step that it did not move [m/s].
/// Their work ended with the motion. Only the share that the body followed counts, because rows cancelled the
/// rest. `start`, `v`: velocities at both ends of the step.
RUBBLE_HD inline Vec3 unusedPush(const SolverData& s, int i, const Vec3& start, const Vec3& v) {
  const StepConstants c = *s.step;
  const Vec3 push = c.inverseDt * s.target[i].y.p - start;
  return fromFloatBits(s.ccdShareBits[i]) * followedShare(v, start, c.inverseDt * push, c.dt) * push;
}

/// Records the displacement of the last sweep over the bounding diameter, a measure of convergence.
RUBBLE_HD inline void noteUnfinished(const SolverData& s, int i, const Displacement& d) {
  const Real radius = s.params[i].radius;
  const int bits = floatBits((std::sqrt(d.step2) / radius + std::sqrt(d.turn2)) / 2);
  // most bodies find a larger value already
  if (bits > atomicLoad(&s.counters->unfinished)) atomicRaise(&s.counters->unfinished, bits);
}

/// Pose and velocities of a dynamic body at the end of a step, as solved. A body stopped by CCD keeps its
/// momenta.
struct BodyEnd {
  Quat q;
  Vec3 move;     ///< displacement since x^t [m]
  Vec3 v, w;     ///< [m/s], [rad/s]
  bool limited;  ///< the angular velocity is at its limit
};
RUBBLE_HD inline BodyEnd endOf(const SolverData& s, int i) {
  const StepConstants c = *s.step;
  const Displacement& d = s.dx[i];
  const bool stopped = s.ccdShareBits[i] != 0;
  const Quat start = s.orientation[i], x = s.dq[i];
  BodyEnd end;
  end.q = normalize((stopped ? expRotation(s.ccdMotion[i].dw) : x) * start);
  end.move = stopped ? s.ccdMotion[i].dp : d.dp;
  end.v = c.inverseDt * d.dp;
  if (stopped) end.v -= unusedPush(s, i, s.velocity[i], end.v);
  if (s.plan.literalRotations) {
    end.w = c.inverseDt * (Real(2) * shortArc(x).v);
    end.limited = limitSpin(end.w, c.dt);
    return end;
  }
  const Vec3 inertia = s.params[i].inertia;
  end.w = c.inverseDt * d.dw;
  // The target is read only if it matters: the two results differ by abs(dw) times the rotation by rows.
  if (dot(d.dw, d.dw) >= kNoRotation2 && (s.target[i].locks >> 3) == 0)
    end.w = spinAfterRows(start, x, d.dw, s.target[i].y.q, inertia, c.dt);
  if (stopped) end.w = spinAt(end.q, x * start, end.w, inertia, c.dt);
  end.limited = limitSpin(end.w, c.dt);
  return end;
}

/// Computes velocities and the new pose. A body whose state is not finite keeps its pose, at rest.
struct FinishBodies {
  static constexpr const char* kStage = "velocity";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const BodyKind kind = s.params[i].kind;
    if (kind == BodyKind::Removed || kind == BodyKind::Static || isAsleep(s, i)) return;
    if (kind == BodyKind::Kinematic) {
      s.position[i] += Vec3d(s.dx[i].dp);
      s.orientation[i] = normalize(s.dq[i] * s.orientation[i]);
      return;
    }
    BodyEnd end = endOf(s, i);
    if (const Vec3 turn = s.dx[i].dw; dot(turn, turn) >= kFarRotation2) {
      const Real kept = keptMotion(s, i, end.q, end.v, end.w);
      end.v *= kept, end.w *= kept;
    }
    if (!isFinite(end.v) || !isFinite(end.w) || !isFinite(end.q.v) || !isFinite(end.q.s)) {
      atomicCount(&s.counters->quarantined, 1);
      s.velocity[i] = s.angularVelocity[i] = s.previousVelocity[i] = {0, 0, 0};
      return;
    }
    if (end.limited) atomicCount(&s.counters->spinLimited, 1);
    s.previousVelocity[i] = s.velocity[i];
    const int column = s.plan.jointTrees ? s.columnLength[i] << kColumnShift : 0;
    s.pushed[i] = (s.pushed[i] & kForced) | (s.ccdShareBits[i] != 0 ? kStopped : 0) | column;
    s.velocity[i] = end.v;
    s.angularVelocity[i] = end.w;
    s.correction[i] = s.nextCorrection[i];
    noteUnfinished(s, i, s.dx[i]);
    s.position[i] += Vec3d(end.move);
    s.orientation[i] = end.q;
  }
};

}  // namespace rubble::RUBBLE_CORE
