#pragma once
/// The coarse correction: block descent whose blocks are rigid motions of whole aggregates. A body-by-body
/// sweep propagates a correction by about one body per iteration; a sweep over aggregates propagates it
/// across a pile.
///
/// For an aggregate with center c the unknowns are dx = (dp, dw). Body i moves by (dp + dw x (p_i - c), dw).
/// The local problem [S 3]-[S 6] sums the inertia of its bodies and its boundary constraints. Constraints
/// inside the aggregate are invariant under a rigid motion. Contacts are linear in displacements from x^t, so
/// for them the positions p_i are those of x^t. Joints rotate, so for them the p_i are the present positions;
/// aggregates with joints inside use these. Aggregates with soft nodes (deformable objects and particles) do
/// not rotate (soft_nodes.h).
///
/// All aggregates of a level move at once, under-relaxed. A row J_a x_a + J_b x_b obeys (J_a x_a + J_b x_b)^2
/// <= 2 ((J_a x_a)^2 + (J_b x_b)^2). Any factor below 1 therefore descends.
#include "stages/bodies/incidence.h"

namespace rubble::RUBBLE_CORE {

/// Under-relaxation of the simultaneous aggregate steps; any factor below 1 guarantees descent [1].
inline constexpr Real kAggregateRelaxation = Real(.8);

/// Vector from the center of an aggregate to the position p_i of a body, which is `shift` at x^t and has
/// moved by dp [m].
RUBBLE_HD inline Vec3 shiftOf(const Aggregate& aggregate, const Vec3& shift, const Vec3& dp) {
  return aggregate.joined ? shift + dp : shift;
}
RUBBLE_HD inline Vec3 shiftOf(const SolverData& s, const Aggregate& aggregate, int body) {
  return shiftOf(aggregate, Vec3(s.position[body] - aggregate.center), s.dx[body].dp);
}

/// Adds a block about one point to a block about another point; `shift` leads from the latter to the former.
/// H' = T^T H T, f' = T^T f, T = [1, -[shift]; 0, 1].
RUBBLE_HD inline void addShifted(Block6& to, const Block6& from, const Vec3& shift) {
  const Vec3 ll[3] = {from.ll.column(0), from.ll.column(1), from.ll.column(2)},
             al[3] = {from.al0, from.al1, from.al2};
  const Vec3 sl[3] = {cross(shift, ll[0]), cross(shift, ll[1]), cross(shift, ll[2])};  // [shift] LL
  to.ll += from.ll;
  to.al0 += al[0] + sl[0], to.al1 += al[1] + sl[1], to.al2 += al[2] + sl[2];
  to.aa += from.aa;
  // [shift] LA + its transpose + [shift] LL [shift]^T; row i of X [shift]^T is shift x (row i of X)
  const auto row = [](const Vec3(&m)[3], int i) { return Vec3{m[0][i], m[1][i], m[2][i]}; };
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

/// Point about which the inertia of an aggregate is summed: its first node.
RUBBLE_HD inline Vec3d originOf(const SolverData& s, const Slice& slice) {
  return placeOf(s, s.aggregateNode[s.aggregateOffset[slice.aggregate]]);
}

/// Adds the inertia of a body at the initial guess, about `origin`. That of soft nodes is summed by vertex.
/// The force and torque of `sum` hold the first moment of all nodes at x^t, and their mass (x of the torque).
RUBBLE_HD inline void addInertia(const SolverData& s, const Aggregate& aggregate, const Vec3d& origin,
                                 int node, Block6& sum) {
  const bool isBody = node < s.bodies;
  const Vec3 place(placeOf(s, node) - origin);
  const Real mass = isBody ? s.target[node].mass.mass : massOf(s, s.softNode[node - s.bodies]);
  sum.fl += mass * place;
  sum.fa.x += mass;
  if (!isBody) return;
  Block6 own;
  setInertialHessian(own, s.target[node].mass, s.step->inverseDt * s.step->inverseDt);
  addAtLever(sum, aggregate.joined ? place + s.dx[node].dp : place, {0, 0, 0}, own.ll.xx);
  sum.aa += own.aa;
}

/// Computes the center of mass of an aggregate and the inertia about it from a sum about `origin`. Both are
/// constant in the step.
RUBBLE_HD inline void placeAggregate(Aggregate& aggregate, const Vec3d& origin, const Block6& sum) {
  const Vec3 center = sum.fl / sum.fa.x;
  Block6 inertia;
  addShifted(inertia, sum, -center);
  inertia.fl = inertia.fa = {0, 0, 0};
  aggregate.center = origin + Vec3d(center);
  aggregate.inertia = inertia;
}

struct SumInertia {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Slice& slice = s.slice[i];
    const Vec3d origin = originOf(s, slice);
    Block6 sum;
    for (int k = slice.begin; k < slice.end; ++k)
      addInertia(s, s.aggregate[slice.aggregate], origin, s.aggregateNode[k], sum);
    slice.sum = sum;
  }
};

struct PlaceAggregates {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int g) const {
    Aggregate& aggregate = s.aggregate[g];
    Block6 sum = s.slice[aggregate.sliceBegin].sum;
    for (int k = aggregate.sliceBegin + 1; k < aggregate.sliceEnd; ++k) sum += s.slice[k].sum;
    placeAggregate(aggregate, originOf(s, s.slice[aggregate.sliceBegin]), sum);
  }
};

/// visit(constraint) for the constraints of a body that cross the boundary of its aggregate at a level. Those
/// of soft nodes are summed by vertex.
template <class Visit>
RUBBLE_HD void visitBoundaryOf(const SolverData& s, const Aggregate& aggregate, int body, Visit&& visit) {
  if (body >= s.bodies) return;
  const Vec3 shift(s.position[body] - aggregate.center);
  visitIncidences(s, body, [&](const Incidence& incidence) {
    if (incidence.depth > aggregate.level) visit(BoundaryConstraint{incidence.code, shift});
  });
}
template <class Visit> RUBBLE_HD void visitBoundary(const SolverData& s, int i, Visit&& visit) {
  const Slice& slice = s.slice[i];
  for (int k = slice.begin; k < slice.end; ++k)
    visitBoundaryOf(s, s.aggregate[slice.aggregate], s.aggregateNode[k], visit);
}

struct CountBoundary {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    int count = 0;
    visitBoundary(s, i, [&](const BoundaryConstraint&) { ++count; });
    s.boundaryCount[i] = count;
  }
};

struct FillBoundary {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    int to = s.boundaryOffset[i];
    visitBoundary(s, i, [&](const BoundaryConstraint& c) { storeWhole(s.boundary[to++], c); });
  }
};

/// What the inertial force of a body depends on.
struct InertialState {
  BodyTarget target;
  Displacement dx;
  Quat dq;
  Vec3d position;
};
RUBBLE_HD inline InertialState inertialState(const SolverData& s, int body) {
  return {loadUnchanging(s.target[body]), loadUnchanging(s.dx[body]), loadUnchanging(s.dq[body]),
          s.position[body]};
}
/// Adds the inertial force of a body about the center of its aggregate.
RUBBLE_HD inline void addInertialForce(const SolverData& s, const Aggregate& aggregate,
                                       const InertialState& body, Block6& sum) {
  Block6 own;
  setInertialForce(own, body.target.mass, {body.dx.dp, body.dq}, body.target.y,
                   s.step->inverseDt * s.step->inverseDt);
  sum.fl += own.fl;
  sum.fa += own.fa + cross(shiftOf(aggregate, Vec3(body.position - aggregate.center), body.dx.dp), own.fl);
}
RUBBLE_HD inline void addInertialForce(const SolverData& s, const Aggregate& aggregate, int node,
                                       Block6& sum) {
  if (node < s.bodies) addInertialForce(s, aggregate, inertialState(s, node), sum);
}

/// Adds points of a boundary contact `r` of bodies a and b.
template <class L>
RUBBLE_HD void addBoundaryContact(const SolverData& s, const Aggregate& aggregate,
                                  const BoundaryConstraint& c, const ContactRows& r, int a, int b, int lane,
                                  Block6T<L>& points) {
  const Displacement &atA = loadUnchanging(s.dx[a]), &atB = loadUnchanging(s.dx[b]);
  const bool onA = constraintSide(c.code) == 0;
  Vec3 moved = atB.dp;  // a choice of references would put both into memory
  if (onA) moved = atA.dp;
  accumulateContact<L>(s.plan.coneHessian, r, onA, atA, atB, lane, points,
                       shiftOf(aggregate, c.shift, moved));
}

/// Adds an attachment to, or a contact with, vertices outside of the aggregate.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline void addBoundarySoftRows(const SolverData& s, int aggregate,
                                                             std::uint32_t code, Block6& sum) {
  const int type = constraintType(code);
  if (type != kBodyAttachmentType && type != kBodyPointContactType) return;
  Block6 own;
  addSoftRows(s, code, own);
  const int body = type == kBodyAttachmentType ? s.attachment[constraintIndex(code)].body
                                               : s.pointContact[constraintIndex(code)].body;
  addShifted(sum, own, shiftOf(s, s.aggregate[aggregate], body));
}

/// Adds a joint of up to four bodies of which several belong to aggregate g. It acts as one row on the motion
/// of the aggregate and is added at the first of these sides, or not at all if all sides belong to g. Returns
/// false if only this body belongs to g.
template <class F>
RUBBLE_HD RUBBLE_OUT_OF_LINE bool addSharedJoint(const SolverData& s, int g, int index, int side,
                                                 Block6& sum) {
  const JointSpec<F>& spec = s.specsOf<F>()[index];
  const Aggregate& aggregate = s.aggregate[g];
  const int own = bodyOf(spec, side);
  unsigned inside = 0;
  bool several = false, all = true, first = true;
  Vec3 shift[kSides<F>]{};
  for (int k = 0; k < kSides<F>; ++k) {
    const int body = bodyOf(spec, k);
    if (body == kWorldBody || s.aggregateOf[atLevel(s, aggregate.level, body)] != g) {
      all = false;
      continue;
    }
    inside |= 1u << k;
    several |= body != own;
    first &= k >= side;
    shift[k] = shiftOf(s, aggregate, body);
  }
  if (!several) return false;
  const Joint<F>& joint = s.jointsOf<F>()[index];
  if (first && !all)
    accumulateJointOfGroup(spec, joint, poseOfA(s, spec, joint), poseOfB(s, spec, joint), inside, shift, sum);
  return true;
}

RUBBLE_HD inline void addBoundaryJoint(const SolverData& s, int aggregate, std::uint32_t code, Block6& sum) {
  forEachType(JointTypes{}, [&]<class F>() {
    if (constraintType(code) != typeIndex<F>(JointTypes{}) + 1 || isLink<F>(code)) return;
    const int side = jointSide<F>(code), index = jointIndex<F>(code);
    const JointSpec<F>& spec = s.specsOf<F>()[index];
    if constexpr (hasFrameBodies<F>())
      if (addSharedJoint<F>(s, aggregate, index, side, sum)) return;
    accumulateJointOfBody<F>(s, index, side, sum, shiftOf(s, s.aggregate[aggregate], bodyOf(spec, side)));
  });
  addBoundarySoftRows(s, aggregate, code, sum);
}
/// An anchored joint, whatever its type.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline void addBoundaryPivot(const SolverData& s, int aggregate,
                                                          const Pivot& pivot, int side, Block6& sum) {
  accumulatePivotOfBody<false>(s, pivot, side, sum,
                               [&](int body) { return shiftOf(s, s.aggregate[aggregate], body); });
}
RUBBLE_HD inline void addBoundaryJointUniform(const SolverData& s, int aggregate, std::uint32_t code,
                                              Block6& sum) {
  if (Pivot pivot; findPivot(s, code, pivot))
    addBoundaryPivot(s, aggregate, pivot, constraintSide(code), sum);
  else
    addBoundaryJoint(s, aggregate, code, sum);
}

/// Adds every `stride`-th soft node of the range [k, end).
RUBBLE_HD RUBBLE_OUT_OF_LINE inline void addSoftNodes(const SolverData& s, int k, int end, int stride,
                                                      Block6& sum) {
  for (; k < end; k += stride) {
    if (s.aggregateNode[k] < s.bodies) continue;
    const Block3& own = s.softNodeSum[s.aggregateNode[k] - s.bodies];
    sum.ll += own.h, sum.fl += own.f;
  }
}

/// Force and constraint Hessian of a slice about the center of its aggregate.
template <class L> struct SumSlice {
  static constexpr const char* kStage = "coarse";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Slice& slice = s.slice[i];
    Block6 sum;
    for (int k = slice.begin; k < slice.end; ++k)
      addInertialForce(s, s.aggregate[slice.aggregate], s.aggregateNode[k], sum);
    if (s.aggregate[slice.aggregate].soft) addSoftNodes(s, slice.begin, slice.end, 1, sum);
    addBoundary(s, slice, s.boundaryOffset[i], s.boundaryOffset[i + 1], sum);
    slice.sum = sum;
  }
  RUBBLE_HD static int aggregateOf(const SolverData& s, int i) { return s.slice[i].aggregate; }
  /// Adds the boundary constraints [k, end) of the slice, with or without contacts.
  RUBBLE_HD static void addBoundary(const SolverData& s, const Slice& slice, int k, int end, Block6& sum,
                                    bool contacts = true) {
    const Aggregate& aggregate = s.aggregate[slice.aggregate];
    PointSums<L> points;
    bool touches = false;
    for (; k < end; ++k) {
      const std::uint32_t code = s.boundary[k].code;
      if (constraintType(code) == kContactType) {
        if (!contacts) continue;
        const ContactRows& r = s.contact[constraintIndex(code)];
        points.each([&](int lane, Block6T<L>& sum) {
          addBoundaryContact<L>(s, aggregate, s.boundary[k], r, r.a, r.b, lane, sum);
        });
        if (s.rolls) addRolling(s, code, sum);
        touches = true;
      } else {
        addBoundaryJoint(s, slice.aggregate, code, sum);
      }
    }
    if (touches) points.addTo(sum);
  }
};

/// The step of an aggregate from its summed force and Hessian: under-relaxed, and zero if it is not finite.
/// `mass`, `inertia` over dt^2. `bounded` is set if the Newton step exceeds the work bound (solver/block.h);
/// the diagonal step replaces it then.
RUBBLE_HD inline Vec6 aggregateStep(const Block6& block, Real mass, const Sym3& inertia, bool& bounded) {
  Vec6 dx = newtonStep(block);
  const Vec6 none{{0, 0, 0}, {0, 0, 0}};
  if (!isFinite(dx.lin) || !isFinite(dx.ang)) return none;
  if (boundRotation(dx.ang)) dx.lin = translationFor(block, dx.ang);
  bounded = !isWithinWork(block, mass, inertia, dx);
  if (bounded) dx = diagonalStep(block);
  return isFinite(dx.lin) && isFinite(dx.ang) ? kAggregateRelaxation * dx : none;
}
/// For an aggregate whose block contains its inertia; the step must only not work against the forces.
RUBBLE_HD inline Vec6 aggregateStep(const Block6& block) {
  bool bounded = false;
  return aggregateStep(block, Real(0), Sym3{}, bounded);
}
RUBBLE_HD inline Vec6 aggregateStep(const SolverData& s, const Aggregate& aggregate, Block6 block) {
  if (aggregate.locks != 0) lockAxes(block, aggregate.locks);
  if (aggregate.soft) {
    const Vec3 dx = solve(Block3{block.ll, block.fl});
    return {isFinite(dx) ? kAggregateRelaxation * dx : Vec3{0, 0, 0}, {0, 0, 0}};
  }
  bool bounded = false;
  const Vec6 dx = aggregateStep(block, aggregate.inertia.ll.xx, aggregate.inertia.aa, bounded);
  if (bounded) atomicCount(&s.counters->boundedSteps, 1);
  return dx;
}

struct SolveAggregate {
  static constexpr const char* kStage = "coarse";
  RUBBLE_HD void operator()(const SolverData& s, int g) const {
    Aggregate& aggregate = s.aggregate[g];
    aggregate.step = aggregateStep(s, aggregate, sumOf(s, aggregate));
  }
  RUBBLE_HD static int aggregateOf(const SolverData&, int g) { return g; }
  /// The local problem: inertia plus the sums of the slices.
  RUBBLE_HD static Block6 sumOf(const SolverData& s, const Aggregate& aggregate) {
    Block6 block = aggregate.inertia;
    for (int k = aggregate.sliceBegin; k < aggregate.sliceEnd; ++k) block += s.slice[k].sum;
    return block;
  }
};

/// Moves a body with its aggregate.
RUBBLE_HD inline void moveWithAggregate(const SolverData& s, const Aggregate& aggregate, int body) {
  if (body >= s.bodies) return;
  const Vec3 move = aggregate.step.lin + cross(aggregate.step.ang, shiftOf(s, aggregate, body));
  const Pose x = retract({s.dx[body].dp, s.dq[body]}, {move, aggregate.step.ang});
  s.dq[body] = x.q;
  s.dx[body] = {x.p, 0, logRotation(x.q), 0};
}

struct MoveSlice {
  static constexpr const char* kStage = "coarse";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Slice& slice = s.slice[i];
    const Aggregate& aggregate = s.aggregate[slice.aggregate];
    for (int k = slice.begin; k < slice.end; ++k) moveWithAggregate(s, aggregate, s.aggregateNode[k]);
  }
  RUBBLE_HD static int aggregateOf(const SolverData& s, int i) { return s.slice[i].aggregate; }
};
/// Runs one of these stages for aggregates with soft nodes only.
template <class Stage> struct WithSoftNodes {
  static constexpr const char* kStage = Stage::kStage;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.aggregate[Stage::aggregateOf(s, i)].soft) Stage{}(s, i);
  }
};

}  // namespace rubble::RUBBLE_CORE
