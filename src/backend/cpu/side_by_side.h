#pragma once
/// Kernels that treat four elements side by side, in the lanes of vector registers: four bodies of a colour, four chunks, groups or joints. They
/// gather what the stages read, use the same formulas for L = Real4 (lanes.h), and hand on what is rare to the stage itself, one by one. A lane has
/// the bits that the stage would give it, so neighbours in a register have no influence on one another.
#include "backend/cpu/gather.h"

namespace rubble::RUBBLE_CORE {

/// `Together<Kernel>::run(s, i)` does what the kernel does at the four indices; `expect(s, i)` and `prepare(s, i)`, where they are there, ask for
/// the memory of fours that are kAhead and one before their turn: elements lie in no order that a processor foresees. Primary: there is none.
template <class Kernel>
struct Together {};

/// Adds rounds of ball joints, one of each lane's list a round, while all four lanes have one; returns the number of rounds. codeOf(lane, k): entry
/// k of a list.
template <class CodeOf, class ShiftOf>
int stampRounds(const View& s, int least, CodeOf&& codeOf, ShiftOf&& shiftOf, Block6T<Real4>& block) {
  int k = 0;
  for (; k < least; ++k) {
    std::uint32_t code[kLanes];
    bool plain = true;
    for (int lane = 0; lane < kLanes; ++lane) {
      code[lane] = codeOf(lane, k);
      plain &= isPlainBall(s, code[lane]);
    }
    if (!plain) break;
    stampBalls(s, code, block, shiftOf(code));
  }
  return k;
}

/// A four is expected so many turns ahead, and prepared in the next but one.
inline constexpr int kAhead = 2;

/// Asks for the first and the last byte of [begin, begin + bytes).
RUBBLE_NEAR void fetch(const void* begin, std::size_t bytes) {
  __builtin_prefetch(begin);
  __builtin_prefetch(static_cast<const char*>(begin) + bytes - 1);
}
/// What a sweep reads of a row block.
RUBBLE_NEAR void fetchBall(const View& s, std::uint32_t code) {
  if (entryType(code) != typeIndex<BallJoint>(JointTypes{}) + 1) return;
  fetch(&s.jointsOf<BallJoint>()[entryIndex(code)], sizeof(Joint<BallJoint>));
}

RUBBLE_NEAR int leastOf(const Four& a) { return min(min(a[0], a[1]), min(a[2], a[3])); }
RUBBLE_NEAR int mostOf(const Four& a) { return max(max(a[0], a[1]), max(a[2], a[3])); }

template <>
struct Together<SolveBody<Real4>> {
  static void expect(const View& s, const Four& body) {
    for (const int i : body) {
      fetch(&s.target[i], sizeof(BodyTarget));
      fetch(&s.entry[s.entryOffset[i]], 4 * sizeof(Entry));
    }
  }
  static void prepare(const View& s, const Four& body) {
    for (const int i : body)
      for (int k = s.entryOffset[i]; k < s.entryOffset[i + 1]; ++k) fetchBall(s, s.entry[k].code);
  }
  static void run(const View& s, const Four& body) {
    Four count;
    int locks = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      count[lane] = s.entryOffset[body[lane] + 1] - s.entryOffset[body[lane]];
      locks |= s.target[body[lane]].locks;
    }
    const TargetLanes target = gatherTargets(s, body);
    const PoseT<Real4> x = gatherPoses(s, body);
    Block6T<Real4> block;
    const Real inverseDt2 = s.step.inverseDt * s.step.inverseDt;
    setInertialForce(block, target.mass, x, target.y, inverseDt2);
    setInertialHessian(block, target.mass, inverseDt2);
    const Real4 zero = LaneAccess<Real4>::splat(0);
    const auto codeOf = [&](int lane, int k) { return s.entry[s.entryOffset[body[lane]] + k].code; };
    const int done = stampRounds(s, leastOf(count), codeOf, [&](const auto&) { return Vec3T<Real4>{zero, zero, zero}; }, block);
    if (done < mostOf(count)) {
      PaddedBlock own[kLanes];
      scatterBlocks(block, own);
      for (int lane = 0; lane < kLanes; ++lane)
        addRows<Real4>(s, s.entryOffset[body[lane]] + done, s.entryOffset[body[lane] + 1], own[lane].block);
      gatherBlocks(own, block);
    }
    if (locks == 0 && descendTogether(s, body, target.mass, block, x)) return;
    PaddedBlock own[kLanes];
    scatterBlocks(block, own);
    for (int lane = 0; lane < kLanes; ++lane) finishBlock(s, body[lane], own[lane].block, {s.moved[body[lane]].dp, s.turned[body[lane]]});
  }

 private:
  /// As finishBlock; false, and nothing is done, where one of the four needs its care: a large rotation, a step that is not finite or too long.
  static bool descendTogether(const View& s, const Four& body, const MassMatrixT<Real4>& m, const Block6T<Real4>& block, const PoseT<Real4>& x) {
    const auto splat = [](Real a) { return LaneAccess<Real4>::splat(a); };
    const Vec6T<Real4> dx = newtonStep(block);
    if (!areFinite(dx.lin) || !allOf(dot(dx.ang, dx.ang) <= splat(kMostTurn * kMostTurn))) return false;
    const Real4 inverseDt2 = splat(s.step.inverseDt * s.step.inverseDt);
    if (!allOf(isWithinWork(block, inverseDt2 * m.mass, inverseDt2 * m.inertia, dx))) return false;
    const PoseT<Real4> then = retract(x, dx);
    if (!allOf(absOf(then.q.s) >= splat(kMostTurned))) return false;
    return placeTogether(s, body, then, squaredStep(then.p, x.p), splat(4) * squaredStep(then.q.v, x.q.v));
  }
};

/// The groups of four chunks, as their bodies see them.
struct GroupLanes {
  const Group* group[kLanes];
  GroupLanes(const View& s, const Four& chunk) {
    for (int lane = 0; lane < kLanes; ++lane) group[lane] = &s.group[s.chunk[chunk[lane]].group];
  }
  /// shiftOf, of one body in each.
  Vec3T<Real4> shiftsOf(const View& s, const Four& body) const {
    const auto shift = [&](int lane) { return shiftOf(s, *group[lane], body[lane]); };
    const Vec3 a = shift(0), b = shift(1), c = shift(2), d = shift(3);
    return {Real4{a.x, b.x, c.x, d.x}, Real4{a.y, b.y, c.y, d.y}, Real4{a.z, b.z, c.z, d.z}};
  }
};
RUBBLE_NEAR int membersOf(const Chunk& chunk) { return chunk.end - chunk.begin; }
/// Is one of them of a group with lumps? These are treated one by one.
RUBBLE_NEAR bool haveLumps(const View& s, const Four& chunk) {
  int soft = 0;
  for (const int i : chunk) soft |= s.group[s.chunk[i].group].soft;
  return soft != 0;
}

template <>
struct Together<SumChunk<Real4>> {
  static void expect(const View& s, const Four& index) {
    for (const int i : index) {
      __builtin_prefetch(&s.external[s.externalOffset[i]]);
      __builtin_prefetch(&s.group[s.chunk[i].group].centre);
    }
  }
  static void prepare(const View& s, const Four& index) {
    for (const int i : index) {
      // those of large chunks are many turns away
      const int end = min(s.externalOffset[i + 1], s.externalOffset[i] + kLanes * kAhead);
      for (int k = s.externalOffset[i]; k < end; ++k) fetchBall(s, s.external[k]);
      for (int k = s.chunk[i].begin; k < min(s.chunk[i].end, s.chunk[i].begin + kLanes); ++k)
        if (s.member[k] < s.bodies) fetch(&s.target[s.member[k]], sizeof(BodyTarget));
    }
  }
  static void run(const View& s, const Four& index) {
    if (haveLumps(s, index)) {
      for (const int i : index) SumChunk<Real4>{}(s, i);
      return;
    }
    const GroupLanes groups(s, index);
    Four members, externals;
    for (int lane = 0; lane < kLanes; ++lane) {
      members[lane] = membersOf(s.chunk[index[lane]]);
      externals[lane] = s.externalOffset[index[lane] + 1] - s.externalOffset[index[lane]];
    }
    Block6T<Real4> sum;
    const int least = leastOf(members);
    for (int k = 0; k < least; ++k) addInertialForces(s, groups, index, k, sum);
    const bool even = least == mostOf(members);
    if (!even) {
      for (int lane = 0; lane < kLanes; ++lane) addOthers(s, s.chunk[index[lane]], least, lane, sum);
    }
    const auto codeOf = [&](int lane, int k) { return s.external[s.externalOffset[index[lane]] + k]; };
    const auto shiftOf = [&](const std::uint32_t(&code)[kLanes]) {
      Four body;
      for (int lane = 0; lane < kLanes; ++lane) body[lane] = s.jointsOf<BallJoint>()[entryIndex(code[lane])].end[entrySide(code[lane])].body;
      return groups.shiftsOf(s, body);
    };
    const int done = stampRounds(s, leastOf(externals), codeOf, shiftOf, sum);
    PaddedBlock own[kLanes];
    scatterBlocks(sum, own);
    for (int lane = 0; lane < kLanes; ++lane) {
      const int i = index[lane];
      if (done < externals[lane]) SumChunk<Real4>::addExternals(s, s.chunk[i], s.externalOffset[i] + done, s.externalOffset[i + 1], own[lane].block);
      s.chunk[i].sum = own[lane].block;
    }
  }

 private:
  /// Inertial forces of the k-th member of each.
  static void addInertialForces(const View& s, const GroupLanes& groups, const Four& index, int k, Block6T<Real4>& sum) {
    Four body;
    for (int lane = 0; lane < kLanes; ++lane) body[lane] = s.member[s.chunk[index[lane]].begin + k];
    const TargetLanes target = gatherTargets(s, body);
    Block6T<Real4> own;
    setInertialForce(own, target.mass, gatherPoses(s, body), target.y, s.step.inverseDt * s.step.inverseDt);
    sum.fl += own.fl;
    sum.fa += own.fa + cross(groups.shiftsOf(s, body), own.fl);
  }
  /// Those of the members of one lane from the k-th on.
  static void addOthers(const View& s, const Chunk& chunk, int k, int lane, Block6T<Real4>& sum) {
    Block6 own;
    own.fl = {sum.fl.x[lane], sum.fl.y[lane], sum.fl.z[lane]}, own.fa = {sum.fa.x[lane], sum.fa.y[lane], sum.fa.z[lane]};
    for (k += chunk.begin; k < chunk.end; ++k) addInertialForce(s, s.group[chunk.group], s.member[k], own);
    sum.fl.x[lane] = own.fl.x, sum.fl.y[lane] = own.fl.y, sum.fl.z[lane] = own.fl.z;
    sum.fa.x[lane] = own.fa.x, sum.fa.y[lane] = own.fa.y, sum.fa.z[lane] = own.fa.z;
  }
};

template <>
struct Together<SolveGroup> {
  static void run(const View& s, const Four& index) {
    PaddedBlock own[kLanes];
    int rare = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      const Group& group = s.group[index[lane]];
      own[lane].block = SolveGroup::sumOf(s, group);
      rare |= group.locks | group.soft;
    }
    Block6T<Real4> block, inertia;
    gatherBlocks(own, block);
    for (int lane = 0; lane < kLanes; ++lane) own[lane].block = s.group[index[lane]].inertia;
    gatherBlocks(own, inertia);
    const Vec6T<Real4> dx = newtonStep(block);
    if (rare != 0 || !areFinite(dx.lin) || !areFinite(dx.ang) || !allOf(isWithinWork(block, inertia.ll.xx, inertia.aa, dx))) {
      for (int lane = 0; lane < kLanes; ++lane) SolveGroup{}(s, index[lane]);
      return;
    }
    const Vec6T<Real4> step = LaneAccess<Real4>::splat(kGroupRelaxation) * dx;
    for (int lane = 0; lane < kLanes; ++lane)
      s.group[index[lane]].step = {{step.lin.x[lane], step.lin.y[lane], step.lin.z[lane]}, {step.ang.x[lane], step.ang.y[lane], step.ang.z[lane]}};
  }
};

template <>
struct Together<MoveChunk> {
  static void run(const View& s, const Four& index) {
    if (haveLumps(s, index)) {
      for (const int i : index) MoveChunk{}(s, i);
      return;
    }
    const GroupLanes groups(s, index);
    Four members;
    for (int lane = 0; lane < kLanes; ++lane) members[lane] = membersOf(s.chunk[index[lane]]);
    const Quad<Real4> first = gatherSteps(groups, 0), second = gatherSteps(groups, 1);
    const Vec6T<Real4> step{{first.x, first.y, first.z}, {first.w, second.x, second.y}};
    const int least = leastOf(members);
    const Real4 none = LaneAccess<Real4>::splat(0);
    for (int k = 0; k < least; ++k) {
      Four body;
      for (int lane = 0; lane < kLanes; ++lane) body[lane] = s.member[s.chunk[index[lane]].begin + k];
      const Vec3T<Real4> move = step.lin + cross(step.ang, groups.shiftsOf(s, body));
      if (placeTogether(s, body, retract(gatherPoses(s, body), {move, step.ang}), none, none)) continue;
      for (int lane = 0; lane < kLanes; ++lane) moveWithGroup(s, *groups.group[lane], body[lane]);
    }
    for (int lane = 0; lane < kLanes; ++lane)
      for (int k = s.chunk[index[lane]].begin + least; k < s.chunk[index[lane]].end; ++k) moveWithGroup(s, *groups.group[lane], s.member[k]);
  }

 private:
  static Quad<Real4> gatherSteps(const GroupLanes& groups, int k) {
    return gatherNumbers(&groups.group[0]->step, &groups.group[1]->step, &groups.group[2]->step, &groups.group[3]->step, k);
  }
};

template <>
struct Together<UpdateJointDuals<BallJoint>> {
  static void run(const View& s, const Four& index) {
    bool plain = true;
    for (int lane = 0; lane < kLanes; ++lane) plain &= isPlainBall(s, index[lane]);
    if (!plain || !update(s, index))
      for (int lane = 0; lane < kLanes; ++lane) UpdateJointDuals<BallJoint>{}(s, index[lane]);
  }

 private:
  /// False, and nothing is done, where the four have rules of different kinds.
  static bool update(const View& s, const Four& index) {
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
    const auto scatter = [&](int k, const Quad<Real4>& q) { LaneAccess<Real4>::scatterQuad(at(0, k), at(1, k), at(2, k), at(3, k), q); };
    scatter(0, {j.lambda[0], j.lambda[1], j.lambda[2], j.shift[0]});
    scatter(1, {j.shift[1], j.shift[2], j.law.k, j.law.compliance});
    return true;
  }
};

}  // namespace rubble::RUBBLE_CORE
