#pragma once
/// Kernels that treat four elements side by side, in the lanes of vector registers: four bodies of a colour, four chunks, groups or joints. They
/// gather what the stages read, use the same formulas for L = Real4 (lanes.h), and hand on what is rare to the stage itself, one by one. A lane has
/// the bits that the stage would give it, so neighbours in a register have no influence on one another.
#include <cstddef>

#include "stages/coarse.h"

namespace rubble::RUBBLE_CORE {

using Four = int[kLanes];

/// `Together<Kernel>::run(s, i)` does what the kernel does at the four indices. Primary: there is none.
template <class Kernel>
struct Together {};

/// The numbers [4 k, 4 k + 4) of four structs of numbers.
template <class T>
RUBBLE_NEAR Quad<Real4> gatherNumbers(const T* a, const T* b, const T* c, const T* d, int k = 0) {
  const auto at = [&](const T* p) { return reinterpret_cast<const Real*>(p) + 4 * k; };
  return LaneAccess<Real4>::gatherQuad(at(a), at(b), at(c), at(d));
}
template <class T>
RUBBLE_NEAR Quad<Real4> gatherNumbers(const T* table, const Four& i, int k = 0) {
  return gatherNumbers(table + i[0], table + i[1], table + i[2], table + i[3], k);
}
RUBBLE_NEAR Vec3T<Real4> vectorOf(const Quad<Real4>& q) { return {q.x, q.y, q.z}; }
RUBBLE_NEAR QuatT<Real4> quaternionOf(const Quad<Real4>& q) { return {q.x, {q.y, q.z, q.w}}; }

/// A block that is read and written by fours.
struct PaddedBlock {
  Block6 block;
  Real pad = 0;
};
inline constexpr int kBlockQuads = sizeof(PaddedBlock) / (4 * sizeof(Real));
static_assert(sizeof(Block6) == 27 * sizeof(Real) && sizeof(Block6T<Real4>) == 27 * sizeof(Real4));

RUBBLE_NEAR void gatherBlocks(const PaddedBlock (&in)[kLanes], Block6T<Real4>& out) {
  auto* const to = reinterpret_cast<Real4Aliased*>(&out);
  for (int k = 0; k < kBlockQuads; ++k) {
    const Quad<Real4> q = gatherNumbers(&in[0], &in[1], &in[2], &in[3], k);
    to[4 * k] = q.x, to[4 * k + 1] = q.y, to[4 * k + 2] = q.z;
    if (k + 1 < kBlockQuads) to[4 * k + 3] = q.w;
  }
}
RUBBLE_NEAR void scatterBlocks(const Block6T<Real4>& in, PaddedBlock (&out)[kLanes]) {
  const auto* const from = reinterpret_cast<const Real4Aliased*>(&in);
  const auto at = [&](int lane, int k) { return reinterpret_cast<Real*>(&out[lane]) + 4 * k; };
  for (int k = 0; k < kBlockQuads; ++k) {
    const Real4 last = k + 1 < kBlockQuads ? from[4 * k + 3] : from[4 * k];
    LaneAccess<Real4>::scatterQuad(at(0, k), at(1, k), at(2, k), at(3, k), {from[4 * k], from[4 * k + 1], from[4 * k + 2], last});
  }
}

/// Displacement and rotation since x^t of four bodies.
RUBBLE_NEAR PoseT<Real4> gatherPoses(const View& s, const Four& body) {
  return {vectorOf(gatherNumbers(s.moved, body)), quaternionOf(gatherNumbers(s.turned, body))};
}
/// Their inertia and their targets.
struct TargetLanes {
  MassMatrixT<Real4> mass;
  PoseT<Real4> y;
};
RUBBLE_NEAR TargetLanes gatherTargets(const View& s, const Four& body) {
  static_assert(offsetof(BodyTarget, y) == 7 * sizeof(Real) && offsetof(BodyTarget, locks) == 14 * sizeof(Real));
  const Quad<Real4> q[4] = {gatherNumbers(s.target, body, 0), gatherNumbers(s.target, body, 1), gatherNumbers(s.target, body, 2),
                            gatherNumbers(s.target, body, 3)};
  return {{q[0].x, {q[0].y, q[0].z, q[0].w, q[1].x, q[1].y, q[1].z}}, {{q[1].w, q[2].x, q[2].y}, {q[2].z, {q[2].w, q[3].x, q[3].y}}}};
}

/// Puts four bodies at x; false, and nothing is done, where a rotation is large.
RUBBLE_NEAR bool placeTogether(const View& s, const Four& body, const PoseT<Real4>& x) {
  const QuatT<Real4> q = shortArc(x.q);
  const Real4 u2 = dot(q.v, q.v), zero = LaneAccess<Real4>::splat(0);
  if (!allOf(u2 < LaneAccess<Real4>::splat(kSmallTurn2))) return false;
  const Vec3T<Real4> turn = logOfSmall(q, u2);
  const auto scatter = [&](auto* table, int k, const Quad<Real4>& v) {
    const auto at = [&](int lane) { return reinterpret_cast<Real*>(table + body[lane]) + 4 * k; };
    LaneAccess<Real4>::scatterQuad(at(0), at(1), at(2), at(3), v);
  };
  scatter(s.turned, 0, {x.q.s, x.q.v.x, x.q.v.y, x.q.v.z});
  scatter(s.moved, 0, {x.p.x, x.p.y, x.p.z, zero});
  scatter(s.moved, 1, {turn.x, turn.y, turn.z, zero});
  return true;
}

/// Ball joints side by side: what the sweeps read of them.
struct BallLanes {
  BallJoint::DataT<Real4> data;
  PoseT<Real4> a, b;
  Real4 lambda[3], shift[3];
  GroupLaw<Real4> law;
};

/// Is entry or external `code` a ball joint between two bodies that is held?
RUBBLE_NEAR bool isPlainBall(const View& s, std::uint32_t code) {
  if (entryType(code) != typeIndex<BallJoint>(JointTypes{}) + 1) return false;
  const JointSpec<BallJoint>& spec = s.specsOf<BallJoint>()[entryIndex(code)];
  return spec.a != kWorldBody && spec.b != kWorldBody && partOf<0>(spec.parts).mode != GroupMode::Off;
}

RUBBLE_NEAR BallLanes gatherBalls(const View& s, const Four& index) {
  using Rows = GroupRows<AnchorRows::kRows>;
  static_assert(offsetof(Rows, state) == 6 * sizeof(Real) && sizeof(BallJoint::Data) == 6 * sizeof(Real));
  const JointSpec<BallJoint>* const specs = s.specsOf<BallJoint>();
  const Joint<BallJoint>* const joints = s.jointsOf<BallJoint>();
  Four a, b;
  const Rows* rows[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    a[lane] = specs[index[lane]].a, b[lane] = specs[index[lane]].b;
    rows[lane] = &partOf<0>(joints[index[lane]].parts);
  }
  BallLanes j;
  const auto gatherSpecs = [&](int k) {
    return gatherNumbers(&specs[index[0]].data, &specs[index[1]].data, &specs[index[2]].data, &specs[index[3]].data, k);
  };
  const Quad<Real4> anchors = gatherSpecs(0), rest = gatherSpecs(1);
  j.data = {{anchors.x, anchors.y, anchors.z}, {anchors.w, rest.x, rest.y}};
  const auto gatherRows = [&](int k) { return gatherNumbers(rows[0], rows[1], rows[2], rows[3], k); };
  const Quad<Real4> first = gatherRows(0), second = gatherRows(1), third = gatherRows(2);
  j.lambda[0] = first.x, j.lambda[1] = first.y, j.lambda[2] = first.z;
  j.shift[0] = first.w, j.shift[1] = second.x, j.shift[2] = second.y;
  j.law = {second.z, second.w, third.x};
  const auto place = [&](const Four& body, const Vec3T<Real4>& offset) -> PoseT<Real4> {
    const PoseT<Real4> moved = gatherPoses(s, body);
    return {offset + moved.p, moved.q * quaternionOf(gatherNumbers(s.orientation, body))};
  };
  const Real4 zero = LaneAccess<Real4>::splat(0);
  j.a = place(a, vectorOf(gatherNumbers(&joints[index[0]].offset, &joints[index[1]].offset, &joints[index[2]].offset, &joints[index[3]].offset)));
  j.b = place(b, {zero, zero, zero});
  return j;
}

/// Adds four ball joints to the blocks of one of their bodies each, as stampJoint does.
inline void stampBalls(const View& s, const std::uint32_t (&code)[kLanes], Block6T<Real4>& block, const Vec3T<Real4>& shift) {
  Four index;
  Real4 sign;
  for (int lane = 0; lane < kLanes; ++lane) {
    index[lane] = entryIndex(code[lane]);
    sign[lane] = static_cast<Real>(entrySide(code[lane]));
  }
  const BallLanes j = gatherBalls(s, index);
  Real4 error[3], force[3], hessian;
  heldErrors<AnchorRows>(j.shift, j.data, NoMemory{}, j.a, j.b, error);
  cutForce<3>(j.law, error, j.lambda, force, 3, hessian);
  AnchorRows::stamp(j.data, j.a, j.b, sign == LaneAccess<Real4>::splat(0), shift, force, hessian, block);
}

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

RUBBLE_NEAR int leastOf(const Four& a) { return min(min(a[0], a[1]), min(a[2], a[3])); }
RUBBLE_NEAR int mostOf(const Four& a) { return max(max(a[0], a[1]), max(a[2], a[3])); }

template <>
struct Together<SolveBody<Real4>> {
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
    if (locks == 0 && descendTogether(s, body, block, x)) return;
    PaddedBlock own[kLanes];
    scatterBlocks(block, own);
    for (int lane = 0; lane < kLanes; ++lane) finishBlock(s, body[lane], own[lane].block, {s.moved[body[lane]].dp, s.turned[body[lane]]});
  }

 private:
  /// As finishBlock; false, and nothing is done, where one of the four needs its care: a large rotation, a step that is not finite.
  static bool descendTogether(const View& s, const Four& body, const Block6T<Real4>& block, const PoseT<Real4>& x) {
    const auto splat = [](Real a) { return LaneAccess<Real4>::splat(a); };
    const Vec6T<Real4> dx = newtonStep(block);
    if (!areFinite(dx.lin) || !allOf(dot(dx.ang, dx.ang) <= splat(kMostTurn * kMostTurn))) return false;
    const PoseT<Real4> then = retract(x, dx);
    return allOf(absOf(then.q.s) >= splat(kMostTurned)) && placeTogether(s, body, then);
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
    Vec3T<Real4> shift;
    for (int lane = 0; lane < kLanes; ++lane) {
      const Vec3 own = shiftOf(s, *group[lane], body[lane]);
      shift.x[lane] = own.x, shift.y[lane] = own.y, shift.z[lane] = own.z;
    }
    return shift;
  }
};
RUBBLE_NEAR int membersOf(const Chunk& chunk) { return chunk.end - chunk.begin; }

template <>
struct Together<SumChunk<Real4>> {
  static void run(const View& s, const Four& index) {
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
      for (int lane = 0; lane < kLanes; ++lane) body[lane] = bodyOf(s.specsOf<BallJoint>()[entryIndex(code[lane])], entrySide(code[lane]));
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
    int locks = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      const Group& group = s.group[index[lane]];
      own[lane].block = SolveGroup::sumOf(s, group);
      locks |= group.locks;
    }
    Block6T<Real4> block;
    gatherBlocks(own, block);
    const Vec6T<Real4> dx = newtonStep(block);
    if (locks != 0 || !areFinite(dx.lin) || !areFinite(dx.ang)) {
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
    const GroupLanes groups(s, index);
    Four members;
    for (int lane = 0; lane < kLanes; ++lane) members[lane] = membersOf(s.chunk[index[lane]]);
    const Quad<Real4> first = gatherSteps(groups, 0), second = gatherSteps(groups, 1);
    const Vec6T<Real4> step{{first.x, first.y, first.z}, {first.w, second.x, second.y}};
    const int least = leastOf(members);
    for (int k = 0; k < least; ++k) {
      Four body;
      for (int lane = 0; lane < kLanes; ++lane) body[lane] = s.member[s.chunk[index[lane]].begin + k];
      const Vec3T<Real4> move = step.lin + cross(step.ang, groups.shiftsOf(s, body));
      if (placeTogether(s, body, retract(gatherPoses(s, body), {move, step.ang}))) continue;
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

}  // namespace rubble::RUBBLE_CORE
