#pragma once
/// SIMD versions of kernels: four bodies of one color, four slices, aggregates or joints in the lanes of
/// vector registers. They gather the inputs, evaluate the formulas of the stages with L = Real4 (lanes.h),
/// and leave rare cases to the scalar kernel. Each lane has the bits of the scalar kernel, so results do not
/// depend on the grouping.
#include "backend/cpu/contact_lanes.h"
#include "backend/cpu/gather.h"
#include "platform/prefetch.h"

namespace rubble::RUBBLE_CORE {

/// `Simd4Kernel<Kernel>::run(s, i)` is equivalent to the kernel for four indices. Optional `expect(s, i)` and
/// `prepare(s, i)` prefetch the memory of a later group: kAhead groups and one group ahead. The primary
/// template is empty: no SIMD version. Hardware prefetching fails because elements are accessed in random
/// order.
template <class Kernel> struct Simd4Kernel {};

/// Adds ball joints in rounds, one joint per lane and round, as long as all four lanes have one. Returns the
/// number of rounds. codeOf(lane, k) is incidence k of a lane.
template <class CodeOf, class ShiftOf>
int accumulateRounds(const SolverData& s, int least, CodeOf&& codeOf, ShiftOf&& shiftOf,
                     Block6T<Real4>& block) {
  int k = 0;
  for (; k < least; ++k) {
    std::uint32_t code[kLanes];
    bool plain = true;
    for (int lane = 0; lane < kLanes; ++lane) {
      code[lane] = codeOf(lane, k);
      plain &= isPlainBall(s, code[lane]);
    }
    if (!plain) break;
    accumulateBalls(s, code, block, shiftOf(code));
  }
  return k;
}

/// Prefetch distance in groups of four.
inline constexpr int kAhead = 2;

/// Prefetches the inputs of a constraint.
RUBBLE_NEAR void fetchBall(const SolverData& s, std::uint32_t code) {
  if (constraintType(code) != typeIndex<BallJoint>(JointTypes{}) + 1) return;
  fetch(&s.jointsOf<BallJoint>()[constraintIndex(code)], sizeof(Joint<BallJoint>));
}

RUBBLE_NEAR int leastOf(const Lane4& a) { return min(min(a[0], a[1]), min(a[2], a[3])); }
RUBBLE_NEAR int mostOf(const Lane4& a) { return max(max(a[0], a[1]), max(a[2], a[3])); }

/// Is the rotation of a Newton step one that boundRotation leaves as it is?
RUBBLE_NEAR auto isTrusted(const Vec3T<Real4>& turn) {
  return dot(turn, turn) <= LaneAccess<Real4>::splat(kLargestRotation * kLargestRotation);
}

template <> struct Simd4Kernel<SolveBody<Real4>> {
  static void expect(const SolverData& s, const Lane4& body) {
    for (const int i : body) {
      fetch(&s.target[i], sizeof(BodyTarget));
      // a body without constraints may stand at the end of the table
      fetch(s.incidence + s.incidenceOffset[i], 4 * sizeof(Incidence));
    }
  }
  static void prepare(const SolverData& s, const Lane4& body) {
    for (const int i : body)
      for (int k = s.incidenceOffset[i]; k < s.incidenceOffset[i + 1]; ++k) {
        const std::uint32_t code = s.incidence[k].code;
        if (constraintType(code) == kContactType)
          fetchContact(s, code);
        else
          fetchBall(s, code);
      }
  }
  static void run(const SolverData& s, const Lane4& body) {
    Lane4 count;
    int locks = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      count[lane] = s.incidenceOffset[body[lane] + 1] - s.incidenceOffset[body[lane]];
      locks |= s.target[body[lane]].locks;
    }
    const TargetLanes target = gatherTargets(s, body);
    const PoseT<Real4> x = gatherPoses(s, body);
    Block6T<Real4> block;
    const Real inverseDt2 = s.step->inverseDt * s.step->inverseDt;
    setInertialForce(block, target.mass, x, target.y, inverseDt2);
    setInertialHessian(block, target.mass, inverseDt2);
    const Real4 zero = LaneAccess<Real4>::splat(0);
    const auto codeOf = [&](int lane, int k) { return s.incidence[s.incidenceOffset[body[lane]] + k].code; };
    const int done = accumulateRounds(
        s, leastOf(count), codeOf,
        [&](const auto&) {
          return Vec3T<Real4>{zero, zero, zero};
        },
        block);
    if (done < mostOf(count)) {
      PaddedBlock own[kLanes];
      scatterBlocks(block, own);
      Lane4 next, end;
      for (int lane = 0; lane < kLanes; ++lane)
        next[lane] = s.incidenceOffset[body[lane]] + done, end[lane] = s.incidenceOffset[body[lane] + 1];
#if RUBBLE_EIGHT_LANES
      for (int lane = 0; lane < kLanes && !s.rolls; lane += 2)
        addContactsOfTwo(s, next + lane, {end[lane], end[lane + 1]}, own[lane].block, own[lane + 1].block);
#endif
      for (int lane = 0; lane < kLanes; ++lane) addRows<Real4>(s, next[lane], end[lane], own[lane].block);
      gatherBlocks(own, block);
    }
    if (locks == 0 && descendTogether(s, body, target.mass, block, x)) return;
    PaddedBlock own[kLanes];
    scatterBlocks(block, own);
    for (int lane = 0; lane < kLanes; ++lane)
      finishBlock(s, body[lane], own[lane].block, {s.dx[body[lane]].dp, s.dq[body[lane]]});
  }

 private:
  /// finishBlock for four lanes. Returns false without a write if a lane needs the scalar version: large
  /// rotation, step not finite, or step too long.
  static bool descendTogether(const SolverData& s, const Lane4& body, const MassMatrixT<Real4>& m,
                              const Block6T<Real4>& block, const PoseT<Real4>& x) {
    const auto splat = [](Real a) { return LaneAccess<Real4>::splat(a); };
    const Vec6T<Real4> dx = newtonStep(block);
    if (!areFinite(dx.lin) || !allOf(isTrusted(dx.ang))) return false;
    const Real4 inverseDt2 = splat(s.step->inverseDt * s.step->inverseDt);
    if (!allOf(isWithinWork(block, inverseDt2 * m.mass, inverseDt2 * m.inertia, dx))) return false;
    const PoseT<Real4> then = retract(x, dx);
    if (!allOf(absOf(then.q.s) >= splat(kMostTurned))) return false;
    return placeTogether(s, body, then, squaredStep(then.p, x.p), splat(4) * squaredStep(then.q.v, x.q.v));
  }
};

/// The aggregates of four slices.
struct AggregateLanes {
  const Aggregate* aggregate[kLanes];
  AggregateLanes(const SolverData& s, const Lane4& slice) {
    for (int lane = 0; lane < kLanes; ++lane) aggregate[lane] = &s.aggregate[s.slice[slice[lane]].aggregate];
  }
  /// shiftOf for one body per lane.
  Vec3T<Real4> shiftsOf(const SolverData& s, const Lane4& body) const {
    const auto shift = [&](int lane) { return shiftOf(s, *aggregate[lane], body[lane]); };
    const Vec3 a = shift(0), b = shift(1), c = shift(2), d = shift(3);
    return {Real4{a.x, b.x, c.x, d.x}, Real4{a.y, b.y, c.y, d.y}, Real4{a.z, b.z, c.z, d.z}};
  }
};
RUBBLE_NEAR int nodesOf(const Slice& slice) { return slice.end - slice.begin; }
/// Returns whether an aggregate has soft nodes. These slices use the scalar kernel.
RUBBLE_NEAR bool haveSoftNodes(const SolverData& s, const Lane4& slice) {
  int soft = 0;
  for (const int i : slice) soft |= s.aggregate[s.slice[i].aggregate].soft;
  return soft != 0;
}

template <> struct Simd4Kernel<SumSlice<Real4>> {
  static void expect(const SolverData& s, const Lane4& index) {
    for (const int i : index) {
      prefetch(s.boundary + s.boundaryOffset[i]);
      prefetch(&s.aggregate[s.slice[i].aggregate].center);
    }
  }
  static void prepare(const SolverData& s, const Lane4& index) {
    for (const int i : index) {
      // no prefetch far into the list of a large slice
      const int end = min(s.boundaryOffset[i + 1], s.boundaryOffset[i] + kLanes * kAhead);
      for (int k = s.boundaryOffset[i]; k < end; ++k) fetchBall(s, s.boundary[k].code);
      for (int k = s.slice[i].begin; k < min(s.slice[i].end, s.slice[i].begin + kLanes); ++k)
        if (s.aggregateNode[k] < s.bodies) fetch(&s.target[s.aggregateNode[k]], sizeof(BodyTarget));
    }
  }
  static void run(const SolverData& s, const Lane4& index) {
    if (haveSoftNodes(s, index)) {
      for (const int i : index) SumSlice<Real4>{}(s, i);
      return;
    }
    const AggregateLanes aggregates(s, index);
    Lane4 nodes, boundaryBlocks;
    for (int lane = 0; lane < kLanes; ++lane) {
      nodes[lane] = nodesOf(s.slice[index[lane]]);
      boundaryBlocks[lane] = s.boundaryOffset[index[lane] + 1] - s.boundaryOffset[index[lane]];
    }
    Block6T<Real4> sum;
    const int least = leastOf(nodes);
    for (int k = 0; k < least; ++k) addInertialForces(s, aggregates, index, k, sum);
    const bool even = least == mostOf(nodes);
    if (!even) {
      for (int lane = 0; lane < kLanes; ++lane) addOthers(s, s.slice[index[lane]], least, lane, sum);
    }
    const auto codeOf = [&](int lane, int k) { return s.boundary[s.boundaryOffset[index[lane]] + k].code; };
    const auto shiftOf = [&](const std::uint32_t(&code)[kLanes]) {
      Lane4 body;
      for (int lane = 0; lane < kLanes; ++lane)
        body[lane] = s.jointsOf<BallJoint>()[constraintIndex(code[lane])]
                         .end[constraintSide(code[lane])]
                         .body;
      return aggregates.shiftsOf(s, body);
    };
    const int done = accumulateRounds(s, leastOf(boundaryBlocks), codeOf, shiftOf, sum);
    PaddedBlock own[kLanes];
    scatterBlocks(sum, own);
    const bool pairs = RUBBLE_EIGHT_LANES && !s.rolls;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int i = index[lane];
      if (done < boundaryBlocks[lane])
        SumSlice<Real4>::addBoundary(s, s.slice[i], s.boundaryOffset[i] + done, s.boundaryOffset[i + 1],
                                     own[lane].block, !pairs);
    }
#if RUBBLE_EIGHT_LANES
    for (int lane = 0; lane < kLanes && pairs; lane += 2)
      addBoundaryContactsOfTwo(s, index + lane, own[lane].block, own[lane + 1].block);
#endif
    for (int lane = 0; lane < kLanes; ++lane) s.slice[index[lane]].sum = own[lane].block;
  }

 private:
  /// Adds the inertial forces of the k-th node of each lane.
  static void addInertialForces(const SolverData& s, const AggregateLanes& aggregates, const Lane4& index,
                                int k, Block6T<Real4>& sum) {
    Lane4 body;
    for (int lane = 0; lane < kLanes; ++lane) body[lane] = s.aggregateNode[s.slice[index[lane]].begin + k];
    const TargetLanes target = gatherTargets(s, body);
    Block6T<Real4> own;
    setInertialForce(own, target.mass, gatherPoses(s, body), target.y, s.step->inverseDt * s.step->inverseDt);
    sum.fl += own.fl;
    sum.fa += own.fa + cross(aggregates.shiftsOf(s, body), own.fl);
  }
  /// Adds the inertial forces of the nodes of one lane from the k-th on.
  static void addOthers(const SolverData& s, const Slice& slice, int k, int lane, Block6T<Real4>& sum) {
    Block6 own;
    own.fl = {sum.fl.x[lane], sum.fl.y[lane], sum.fl.z[lane]},
    own.fa = {sum.fa.x[lane], sum.fa.y[lane], sum.fa.z[lane]};
    for (k += slice.begin; k < slice.end; ++k)
      addInertialForce(s, s.aggregate[slice.aggregate], s.aggregateNode[k], own);
    sum.fl.x[lane] = own.fl.x, sum.fl.y[lane] = own.fl.y, sum.fl.z[lane] = own.fl.z;
    sum.fa.x[lane] = own.fa.x, sum.fa.y[lane] = own.fa.y, sum.fa.z[lane] = own.fa.z;
  }
};

template <> struct Simd4Kernel<SolveAggregate> {
  static void run(const SolverData& s, const Lane4& index) {
    PaddedBlock own[kLanes];
    int rare = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      const Aggregate& aggregate = s.aggregate[index[lane]];
      own[lane].block = SolveAggregate::sumOf(s, aggregate);
      rare |= aggregate.locks | aggregate.soft;
    }
    Block6T<Real4> block, inertia;
    gatherBlocks(own, block);
    for (int lane = 0; lane < kLanes; ++lane) own[lane].block = s.aggregate[index[lane]].inertia;
    gatherBlocks(own, inertia);
    const Vec6T<Real4> dx = newtonStep(block);
    if (rare != 0 || !areFinite(dx.lin) || !allOf(isTrusted(dx.ang)) ||
        !allOf(isWithinWork(block, inertia.ll.xx, inertia.aa, dx))) {
      for (int lane = 0; lane < kLanes; ++lane) SolveAggregate{}(s, index[lane]);
      return;
    }
    const Vec6T<Real4> step = LaneAccess<Real4>::splat(kAggregateRelaxation) * dx;
    for (int lane = 0; lane < kLanes; ++lane)
      s.aggregate[index[lane]].step = {{step.lin.x[lane], step.lin.y[lane], step.lin.z[lane]},
                                       {step.ang.x[lane], step.ang.y[lane], step.ang.z[lane]}};
  }
};

template <> struct Simd4Kernel<MoveSlice> {
  static void run(const SolverData& s, const Lane4& index) {
    if (haveSoftNodes(s, index)) {
      for (const int i : index) MoveSlice{}(s, i);
      return;
    }
    const AggregateLanes aggregates(s, index);
    Lane4 nodes;
    for (int lane = 0; lane < kLanes; ++lane) nodes[lane] = nodesOf(s.slice[index[lane]]);
    const Quad<Real4> first = gatherSteps(aggregates, 0), second = gatherSteps(aggregates, 1);
    const Vec6T<Real4> step{{first.x, first.y, first.z}, {first.w, second.x, second.y}};
    const int least = leastOf(nodes);
    const Real4 none = LaneAccess<Real4>::splat(0);
    for (int k = 0; k < least; ++k) {
      Lane4 body;
      for (int lane = 0; lane < kLanes; ++lane) body[lane] = s.aggregateNode[s.slice[index[lane]].begin + k];
      const Vec3T<Real4> move = step.lin + cross(step.ang, aggregates.shiftsOf(s, body));
      if (placeTogether(s, body, retract(gatherPoses(s, body), {move, step.ang}), none, none)) continue;
      for (int lane = 0; lane < kLanes; ++lane) moveWithAggregate(s, *aggregates.aggregate[lane], body[lane]);
    }
    for (int lane = 0; lane < kLanes; ++lane)
      for (int k = s.slice[index[lane]].begin + least; k < s.slice[index[lane]].end; ++k)
        moveWithAggregate(s, *aggregates.aggregate[lane], s.aggregateNode[k]);
  }

 private:
  static Quad<Real4> gatherSteps(const AggregateLanes& aggregates, int k) {
    return gatherNumbers(&aggregates.aggregate[0]->step, &aggregates.aggregate[1]->step,
                         &aggregates.aggregate[2]->step, &aggregates.aggregate[3]->step, k);
  }
};

#if RUBBLE_EIGHT_LANES
template <> struct Simd4Kernel<UpdateContactDuals<Real4>> {
  static void run(const SolverData& s, const Lane4& index) {
    updateTwoDuals(s, index[0], index[1]), updateTwoDuals(s, index[2], index[3]);
  }
};
template <> struct Simd4Kernel<FinishContacts<Real4>> {
  static void run(const SolverData& s, const Lane4& index) {
    Simd4Kernel<UpdateContactDuals<Real4>>::run(s, index);
    for (const int i : index) FinishContacts<Real4>::store(s, i);
  }
};
#endif

template <> struct Simd4Kernel<UpdateJointDuals<BallJoint>> {
  static void run(const SolverData& s, const Lane4& index) {
    bool plain = true;
    for (int lane = 0; lane < kLanes; ++lane) plain &= isPlainBall(s, index[lane]);
    if (!plain || !update(s, index))
      for (int lane = 0; lane < kLanes; ++lane) UpdateJointDuals<BallJoint>{}(s, index[lane]);
  }

 private:
  /// Returns false without a write if the four lanes have stiffness rules of different policies.
  static bool update(const SolverData& s, const Lane4& index) {
    BallLanes j = gatherBalls(s, index);
    const auto stateOf = [&](int lane) -> GroupState& { return j.rows[lane]->state; };
    StiffnessRuleT<Real4> rule;
    rule.policy = stateOf(0).rule.policy;
    Real4 keeps;
    for (int lane = 0; lane < kLanes; ++lane) {
      const GroupState& state = stateOf(lane);
      if (state.rule.policy != rule.policy) return false;
      rule.start[lane] = state.rule.start, rule.limit[lane] = state.rule.limit;
      rule.beta[lane] = state.rule.beta, rule.perLoad[lane] = state.rule.perLoad;
      keeps[lane] = static_cast<Real>(state.keepsMultiplier);
    }
    Real4 error[3];
    heldErrors<AnchorRows>(j.shift, j.levers, NoMemory{}, j.a, j.b, error);
    updateRows<3>(j.law, rule, keeps != LaneAccess<Real4>::splat(0), error, j.lambda, 3);
    const auto at = [&](int lane, int k) { return reinterpret_cast<Real*>(j.rows[lane]) + 4 * k; };
    const auto scatter = [&](int k, const Quad<Real4>& q) {
      LaneAccess<Real4>::scatterQuad(at(0, k), at(1, k), at(2, k), at(3, k), q);
    };
    scatter(0, {j.lambda[0], j.lambda[1], j.lambda[2], j.shift[0]});
    scatter(1, {j.shift[1], j.shift[2], j.law.k, j.law.compliance});
    return true;
  }
};

}  // namespace rubble::RUBBLE_CORE
