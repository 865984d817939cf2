#pragma once
/// The coarse correction: block descent whose blocks are rigid motions of whole groups. A body-by-body sweep carries news one body at a
/// time; a sweep over groups carries it across a pile. For a group with centre c the unknowns are dx = (dp, dw), body i moves by
/// (dp + dw x (p_i - c), dw), and the local problem [S 3]-[S 6] sums the inertia of its bodies and the rows that leave the group: rows inside do
/// not see a rigid motion. For contacts, linear in displacements from x^t, that is one about the places p_i of x^t; for joints, which turn, one
/// about the present places. Groups with joints inside take the latter. Those with lumps, deformable objects and particles, do not turn (lumps.h).
/// All groups of a level move at once, under-relaxed: a row J_a x_a + J_b x_b obeys (J_a x_a + J_b x_b)^2 <= 2 ((J_a x_a)^2 + (J_b x_b)^2), so any
/// factor below 1 descends.
#include "stages/bodies/incidence.h"

namespace rubble::RUBBLE_CORE {

/// Under-relaxation of the simultaneous group steps: below 1, where descent is certain.
inline constexpr Real kGroupRelaxation = Real(.8);

/// Vector from the centre of a group to the place p_i that a body moves about.
RUBBLE_HD inline Vec3 shiftOf(const View& s, const Group& group, int body) {
  const Vec3 shift(s.position[body] - group.centre);
  return group.joined ? shift + s.moved[body].dp : shift;
}

/// Adds a block about a point into one about another from which the point lies `shift` away: H' = T^T H T, f' = T^T f, T = [1, -[shift]; 0, 1].
RUBBLE_HD inline void addShifted(Block6& to, const Block6& from, const Vec3& shift) {
  const Vec3 ll[3] = {from.ll.column(0), from.ll.column(1), from.ll.column(2)}, al[3] = {from.al0, from.al1, from.al2};
  const Vec3 sl[3] = {cross(shift, ll[0]), cross(shift, ll[1]), cross(shift, ll[2])};  // [shift] LL
  to.ll += from.ll;
  to.al0 += al[0] + sl[0], to.al1 += al[1] + sl[1], to.al2 += al[2] + sl[2];
  to.aa += from.aa;
  // [shift] LA + its transpose + [shift] LL [shift]^T; row i of X [shift]^T is shift x (row i of X)
  const auto row = [](const Vec3 (&m)[3], int i) { return Vec3{m[0][i], m[1][i], m[2][i]}; };
  Vec3 p[3], q[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = cross(shift, row(al, i));
    q[i] = cross(shift, row(sl, i));
  }
  to.aa.xx += 2 * p[0].x + q[0].x;
  to.aa.xy += p[0].y + p[1].x + q[0].y;
  to.aa.xz += p[0].z + p[2].x + q[0].z;
  to.aa.yy += 2 * p[1].y + q[1].y;
  to.aa.yz += p[1].z + p[2].y + q[1].z;
  to.aa.zz += 2 * p[2].z + q[2].z;
  to.fl += from.fl;
  to.fa += from.fa + cross(shift, from.fl);
}

/// Where the inertia of a group is summed about: its first member.
RUBBLE_HD inline Vec3d originOf(const View& s, const Chunk& chunk) { return placeOf(s, s.member[s.memberOffset[chunk.group]]); }

/// Adds the inertia of a body at the initial guess, about `origin`; that of lumps is summed by vertex. In the place of a force: the first moment of
/// all members at x^t, and their mass (x of the torque).
RUBBLE_HD inline void addInertia(const View& s, const Group& group, const Vec3d& origin, int member, Block6& sum) {
  const bool isBody = member < s.bodies;
  const Vec3 place(placeOf(s, member) - origin);
  const Real mass = isBody ? s.target[member].mass.mass : massOf(s, s.lump[member - s.bodies]);
  sum.fl += mass * place;
  sum.fa.x += mass;
  if (!isBody) return;
  Block6 own;
  setInertialHessian(own, s.target[member].mass, s.step.inverseDt * s.step.inverseDt);
  addAtLever(sum, group.joined ? place + s.moved[member].dp : place, {0, 0, 0}, own.ll.xx);
  sum.aa += own.aa;
}

/// Centre of mass, and inertia about it, of a group whose members are summed about `origin`: constant in the step.
RUBBLE_HD inline void placeGroup(Group& group, const Vec3d& origin, const Block6& sum) {
  const Vec3 centre = sum.fl / sum.fa.x;
  group.centre = origin + Vec3d(centre);
  group.inertia = {};
  addShifted(group.inertia, sum, -centre);
  group.inertia.fl = group.inertia.fa = {0, 0, 0};
}

struct SumInertia {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const {
    Chunk& chunk = s.chunk[i];
    const Vec3d origin = originOf(s, chunk);
    Block6 sum;
    for (int k = chunk.begin; k < chunk.end; ++k) addInertia(s, s.group[chunk.group], origin, s.member[k], sum);
    chunk.sum = sum;
  }
};

struct PlaceGroups {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int g) const {
    Group& group = s.group[g];
    Block6 sum = s.chunk[group.chunkBegin].sum;
    for (int k = group.chunkBegin + 1; k < group.chunkEnd; ++k) sum += s.chunk[k].sum;
    placeGroup(group, originOf(s, s.chunk[group.chunkBegin]), sum);
  }
};

/// visit(code) for the row blocks of a body that leave its group at a level. Those of lumps are summed by vertex.
template <class Visit>
RUBBLE_HD void visitExternalsOf(const View& s, int body, int level, Visit&& visit) {
  if (body >= s.bodies) return;
  for (int e = s.entryOffset[body]; e < s.entryOffset[body + 1]; ++e)
    if (s.entry[e].depth > level) visit(s.entry[e].code);
}
template <class Visit>
RUBBLE_HD void visitExternals(const View& s, int i, Visit&& visit) {
  const Chunk& chunk = s.chunk[i];
  const int level = s.group[chunk.group].level;
  for (int k = chunk.begin; k < chunk.end; ++k) visitExternalsOf(s, s.member[k], level, visit);
}

struct CountExternals {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const {
    int count = 0;
    visitExternals(s, i, [&](std::uint32_t) { ++count; });
    s.externalCount[i] = count;
  }
};

struct FillExternals {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const {
    int to = s.externalOffset[i];
    visitExternals(s, i, [&](std::uint32_t code) { s.external[to++] = code; });
  }
};

/// Adds the inertial force of a body about the centre of its group.
RUBBLE_HD inline void addInertialForce(const View& s, const Group& group, int body, Block6& sum) {
  if (body >= s.bodies) return;
  const BodyTarget& target = s.target[body];
  Block6 own;
  setInertialForce(own, target.mass, {s.moved[body].dp, s.turned[body]}, target.y, s.step.inverseDt * s.step.inverseDt);
  sum.fl += own.fl;
  sum.fa += own.fa + cross(shiftOf(s, group, body), own.fl);
}

/// Adds points of a contact `r` that leaves the group, on its bodies' side.
template <class L>
RUBBLE_HD void addExternalContact(const View& s, const Group& group, const ContactRows& r, int side, int lane, Block6T<L>& points) {
  stampContact<L>(s.step, r, side == 0, s.moved[r.a], s.moved[r.b], lane, points, shiftOf(s, group, side == 0 ? r.a : r.b));
}

/// Adds an attachment or contact of vertices that are not in the group.
RUBBLE_HD RUBBLE_APART inline void addExternalSoftRows(const View& s, int group, std::uint32_t code, Block6& sum) {
  const int type = entryType(code);
  if (type != kBodyAttachmentType && type != kBodyPointContactType) return;
  Block6 own;
  addSoftRows(s, code, own);
  const int body = type == kBodyAttachmentType ? s.attachment[entryIndex(code)].body : s.pointContact[entryIndex(code)].body;
  addShifted(sum, own, shiftOf(s, s.group[group], body));
}

/// A joint of up to four bodies, of which several may move with the group: one row of the motion of the group then, summed where the first of
/// them is met, and none if all do. False: just that one does.
template <class F>
RUBBLE_HD RUBBLE_APART bool addSharedJoint(const View& s, int g, int index, int side, Block6& sum) {
  const JointSpec<F>& spec = s.specsOf<F>()[index];
  const Group& group = s.group[g];
  const int own = bodyOf(spec, side);
  unsigned inside = 0;
  bool several = false, all = true, first = true;
  Vec3 shift[kSides<F>]{};
  for (int k = 0; k < kSides<F>; ++k) {
    const int body = bodyOf(spec, k);
    if (body == kWorldBody || s.groupOf[atLevel(s, group.level, body)] != g) {
      all = false;
      continue;
    }
    inside |= 1u << k;
    several |= body != own;
    first &= k >= side;
    shift[k] = shiftOf(s, group, body);
  }
  if (!several) return false;
  const Joint<F>& joint = s.jointsOf<F>()[index];
  if (first && !all) stampJointOfGroup(spec, joint, poseOfA(s, spec, joint), poseOfB(s, spec, joint), inside, shift, sum);
  return true;
}

RUBBLE_HD inline void addExternalJoint(const View& s, int group, std::uint32_t code, Block6& sum) {
  forEachType(JointTypes{}, [&]<class F>() {
    if (entryType(code) != typeIndex<F>(JointTypes{}) + 1 || isLink<F>(code)) return;
    const int side = jointSide<F>(code), index = jointIndex<F>(code);
    const JointSpec<F>& spec = s.specsOf<F>()[index];
    if constexpr (isCarried<F>())
      if (addSharedJoint<F>(s, group, index, side, sum)) return;
    stampJointOfBody<F>(s, index, side, sum, shiftOf(s, s.group[group], bodyOf(spec, side)));
  });
  addExternalSoftRows(s, group, code, sum);
}
/// The same as addJointAlike.
RUBBLE_HD RUBBLE_APART inline void addExternalPivot(const View& s, int group, const Pivot& pivot, int side, Block6& sum) {
  stampPivotOfBody<false>(s, pivot, side, sum, [&](int body) { return shiftOf(s, s.group[group], body); });
}
RUBBLE_HD inline void addExternalJointAlike(const View& s, int group, std::uint32_t code, Block6& sum) {
  if (Pivot pivot; findPivot(s, code, pivot)) addExternalPivot(s, group, pivot, entrySide(code), sum);
  else addExternalJoint(s, group, code, sum);
}

/// Adds every `stride`-th of the lumps among members [k, end).
RUBBLE_HD RUBBLE_APART inline void addLumps(const View& s, int k, int end, int stride, Block6& sum) {
  for (; k < end; k += stride) {
    if (s.member[k] < s.bodies) continue;
    const Block3& own = s.lumpSum[s.member[k] - s.bodies];
    sum.ll += own.h, sum.fl += own.f;
  }
}

/// Force and row Hessians of a chunk about the centre of its group.
template <class L>
struct SumChunk {
  static constexpr const char* kName = "coarse";
  RUBBLE_HD void operator()(const View& s, int i) const {
    Chunk& chunk = s.chunk[i];
    Block6 sum;
    for (int k = chunk.begin; k < chunk.end; ++k) addInertialForce(s, s.group[chunk.group], s.member[k], sum);
    if (s.group[chunk.group].soft) addLumps(s, chunk.begin, chunk.end, 1, sum);
    addExternals(s, chunk, s.externalOffset[i], s.externalOffset[i + 1], sum);
    chunk.sum = sum;
  }
  RUBBLE_HD static int groupOf(const View& s, int i) { return s.chunk[i].group; }
  /// Adds the row blocks [k, end) that leave the group.
  RUBBLE_HD static void addExternals(const View& s, const Chunk& chunk, int k, int end, Block6& sum) {
    const Group& group = s.group[chunk.group];
    PointSums<L> points;
    bool touches = false;
    for (; k < end; ++k) {
      const std::uint32_t code = s.external[k];
      if (entryType(code) == kContactType) {
        const ContactRows& r = s.contact[entryIndex(code)];
        points.each([&](int lane, Block6T<L>& sum) { addExternalContact<L>(s, group, r, entrySide(code), lane, sum); });
        if (s.rolls) addRolling(s, code, sum);
        touches = true;
      } else {
        addExternalJoint(s, chunk.group, code, sum);
      }
    }
    if (touches) points.addTo(sum);
  }
};

/// The step of a group whose rows and forces are summed: under-relaxed, and none if it is not finite. `mass`, `inertia` over dt^2; `bounded`: it would have
/// gone further than forces and inertia allow (solver/block.h).
RUBBLE_HD inline Vec6 groupStep(const Block6& block, Real mass, const Sym3& inertia, bool& bounded) {
  Vec6 dx = newtonStep(block);
  const Vec6 none{{0, 0, 0}, {0, 0, 0}};
  if (!isFinite(dx.lin) || !isFinite(dx.ang)) return none;
  bounded = !isWithinWork(block, mass, inertia, dx);
  if (bounded) dx = diagonalStep(block);
  return isFinite(dx.lin) && isFinite(dx.ang) ? kGroupRelaxation * dx : none;
}
/// That of a group whose inertia is in the block: it goes along its forces.
RUBBLE_HD inline Vec6 groupStep(const Block6& block) {
  bool bounded = false;
  return groupStep(block, Real(0), Sym3{}, bounded);
}
RUBBLE_HD inline Vec6 groupStep(const View& s, const Group& group, Block6 block) {
  if (group.locks != 0) lockAxes(block, group.locks);
  if (group.soft) {
    const Vec3 dx = solve(Block3{block.ll, block.fl});
    return {isFinite(dx) ? kGroupRelaxation * dx : Vec3{0, 0, 0}, {0, 0, 0}};
  }
  bool bounded = false;
  const Vec6 dx = groupStep(block, group.inertia.ll.xx, group.inertia.aa, bounded);
  if (bounded) atomicCount(&s.counters->boundedSteps, 1);
  return dx;
}

struct SolveGroup {
  static constexpr const char* kName = "coarse";
  RUBBLE_HD void operator()(const View& s, int g) const {
    Group& group = s.group[g];
    group.step = groupStep(s, group, sumOf(s, group));
  }
  RUBBLE_HD static int groupOf(const View&, int g) { return g; }
  /// Its local problem: inertia and the sums of its chunks.
  RUBBLE_HD static Block6 sumOf(const View& s, const Group& group) {
    Block6 block = group.inertia;
    for (int k = group.chunkBegin; k < group.chunkEnd; ++k) block += s.chunk[k].sum;
    return block;
  }
};

/// Moves a body with its group.
RUBBLE_HD inline void moveWithGroup(const View& s, const Group& group, int body) {
  if (body >= s.bodies) return;
  const Vec3 move = group.step.lin + cross(group.step.ang, shiftOf(s, group, body));
  const Pose x = retract({s.moved[body].dp, s.turned[body]}, {move, group.step.ang});
  s.turned[body] = x.q;
  s.moved[body] = {x.p, 0, logRotation(x.q), 0};
}

struct MoveChunk {
  static constexpr const char* kName = "coarse";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const Chunk& chunk = s.chunk[i];
    const Group& group = s.group[chunk.group];
    for (int k = chunk.begin; k < chunk.end; ++k) moveWithGroup(s, group, s.member[k]);
  }
  RUBBLE_HD static int groupOf(const View& s, int i) { return s.chunk[i].group; }
};
/// One of these stages for groups with lumps alone.
template <class Stage>
struct WithLumps {
  static constexpr const char* kName = Stage::kName;
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.group[Stage::groupOf(s, i)].soft) Stage{}(s, i);
  }
};

}  // namespace rubble::RUBBLE_CORE
