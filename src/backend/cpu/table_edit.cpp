#include "backend/cpu/table_edit.h"

#include <algorithm>
#include <bit>

#include "backend/cpu/soft_edit.h"
#include "backend/state_rows.h"
#include "stages/joints.h"

namespace rubble::RUBBLE_CORE {

namespace {

ShapeData shapeData(const Shape& shape) {
  ShapeData s{{0, 0, 0}, 0, ShapeKind::Plane};
  switch (shape.type) {
    case ShapeType::Sphere: return {{0, 0, 0}, static_cast<Real>(shape.radius), ShapeKind::Sphere};
    case ShapeType::Box: return {Vec3(shape.halfExtents), 0, ShapeKind::Box};
    case ShapeType::Capsule: return {{0, 0, static_cast<Real>(shape.halfLength)}, static_cast<Real>(shape.radius), ShapeKind::Capsule};
    case ShapeType::Plane: break;
  }
  return s;
}

template <class F>
void setJointOf(HostTables& tables, int slot, const EngineJoint& in) {
  Joint<F>& joint = tables.view().jointsOf<F>()[slot];
  joint = {};
  joint.data.anchorA = Vec3(in.anchorA);
  joint.data.anchorB = Vec3(in.anchorB);
  if constexpr (requires { joint.data.aToB; }) joint.data.aToB = Quat(in.aToB);
  joint.a = in.a, joint.b = in.b;
  joint.alive = in.alive;
  for (int g = 0; g < F::kGroupCount; ++g) {
    joint.bound[g] = static_cast<Real>(std::min(in.bound[g], 1e18));
    joint.compliance[g] = static_cast<Real>(in.compliance[g]);
  }
}

/// f.operator()<F>() for the joint type of that index.
template <class Function>
void withJointType(int type, Function&& f) {
  forEachType(JointTypes{}, [&]<class F>() {
    if (typeIndex<F>(JointTypes{}) == type) f.template operator()<F>();
  });
}

Pose worldPose(const View& s, int body, const Vec3d& origin) {
  if (body == kWorldBody) return {Vec3(Vec3d{} - origin), Quat{}};
  return {Vec3(s.position[body] - origin), s.orientation[body]};
}

Distribution distribution(std::vector<double>& values) {
  Distribution d;
  if (values.empty()) return d;
  std::sort(values.begin(), values.end());
  for (const double v : values) d.mean += v;
  d.mean /= static_cast<double>(values.size());
  d.p99 = values[static_cast<std::size_t>(.99 * static_cast<double>(values.size() - 1))];
  d.max = values.back();
  return d;
}

}  // namespace

void setBodyCount(HostTables& tables, int slots) {
  if (slots <= tables.view().bodies) return;
  tables.reserve(Per::Body, slots);
  tables.reserve(Per::BodySlot, tables.capacity(Per::Body) * kPairSlots);
  tables.reserve(Per::BodyLevel, tables.capacity(Per::Body) * kCoarseLevels);
  tables.reserve(Per::Node, tables.capacity(Per::Body) + tables.capacity(Per::Vertex));
  tables.reserve(Per::Level, kCoarseLevels);
  const int cells = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(64, 2 * slots))));
  tables.reserve(Per::Cell, cells);
  View& s = tables.view();
  s.cells = cells;
  for (int i = s.bodies; i < slots; ++i) {
    s.params[i] = {};
    s.orientation[i] = Quat{};
    // a new slot owns no pairs
    s.oldPairOffset[i + 1] = s.oldPairOffset[i];
    s.exclusionOffset[i + 1] = s.exclusionOffset[i];
  }
  s.bodies = slots;
}

void setBody(HostTables& tables, int slot, const EngineBody& body) {
  View& s = tables.view();
  BodyParams& p = s.params[slot];
  p.shape = shapeData(body.shape);
  p.kind = static_cast<BodyKind>(body.kind);
  const bool dynamic = p.kind == BodyKind::Dynamic;
  p.mass = dynamic ? static_cast<Real>(body.mass.mass) : Real(0);
  p.inertia = dynamic ? Vec3(body.mass.inertia) : Vec3{0, 0, 0};
  p.radius = boundingRadius(p.shape);
  p.muStatic = static_cast<Real>(body.material.staticFriction);
  p.muDynamic = static_cast<Real>(body.material.dynamicFriction);
  p.restitution = static_cast<Real>(body.material.restitution);
  p.gravityScale = static_cast<Real>(body.gravityScale);
  s.color[slot] = 0;
  s.force[slot] = s.torque[slot] = {0, 0, 0};
  setBodyState(tables, slot, body.state);
}

BodyState bodyState(const HostTables& tables, int slot) {
  const View& s = tables.view();
  using rubble::Quat;
  using rubble::Vec3;
  return {s.position[slot], Quat(s.orientation[slot]), Vec3(s.velocity[slot]), Vec3(s.spin[slot])};
}

void setBodyState(HostTables& tables, int slot, const BodyState& state) {
  View& s = tables.view();
  s.position[slot] = state.position;
  s.orientation[slot] = normalize(Quat(state.orientation));
  s.velocity[slot] = s.previousVelocity[slot] = Vec3(state.velocity);
  s.spin[slot] = Vec3(state.angularVelocity);
}

void forgetContacts(HostTables& tables, int slot) {
  View& s = tables.view();
  for (int i = 0; i < s.bodies; ++i)
    for (int k = s.oldPairOffset[i]; k < s.oldPairOffset[i + 1]; ++k)
      if (s.oldPair[k].owner == slot || s.oldPair[k].other == slot) {
        s.oldPair[k].other = -1;
        s.oldManifold[k].count = 0;
      }
  forgetVertexContacts(tables, slot);
}

void forgetContactsOf(HostTables& tables, std::span<const int> slots) {
  View& s = tables.view();
  std::vector<char> gone(static_cast<std::size_t>(s.bodies), 0);
  for (const int slot : slots) gone[static_cast<std::size_t>(slot)] = 1;
  for (int k = 0; k < s.oldPairOffset[s.bodies]; ++k) {
    const Pair& p = s.oldPair[k];
    if (!gone[static_cast<std::size_t>(p.owner)] && !(p.other >= 0 && gone[static_cast<std::size_t>(p.other)])) continue;
    s.oldPair[k].other = -1;
    s.oldManifold[k].count = 0;
  }
  for (const int slot : slots) forgetVertexContacts(tables, slot);
}

void addVelocity(HostTables& tables, int slot, const rubble::Vec3& change) {
  View& s = tables.view();
  s.velocity[slot] = s.previousVelocity[slot] = changedVelocity(s.velocity[slot], change);
}

ArrayView arrayOf(const HostTables& tables, StateArray which) {
  const View& s = tables.view();
  return withStateArray(which, [&](auto member) { return rowsOf(s.*member, s.bodies); });
}

void scatterRows(HostTables& tables, StateArray which, const ArrayView& rows, const ArrayView& values) {
  const ScatterRows scatter(which, rows, values);
  for (int k = 0; k < static_cast<int>(rows.shape[0]); ++k) scatter(tables.view(), k);
}

void setPlanes(HostTables& tables, const std::vector<int>& slots) {
  tables.reserve(Per::Plane, static_cast<int>(slots.size()));
  std::copy(slots.begin(), slots.end(), tables.view().planeBody);
  tables.view().planes = static_cast<int>(slots.size());
}

void setJointCount(HostTables& tables, int type, int slots) {
  tables.reserve(static_cast<Per>(static_cast<int>(Per::Ball) + type), slots);
  tables.view().joints[type] = slots;
}

void setJoint(HostTables& tables, int slot, const EngineJoint& joint) {
  withJointType(joint.type, [&]<class F>() { setJointOf<F>(tables, slot, joint); });
}

void setExclusions(HostTables& tables, const std::vector<std::pair<int, int>>& pairs) {
  tables.reserve(Per::Exclusion, static_cast<int>(pairs.size()));
  View& s = tables.view();
  std::size_t k = 0;
  for (int i = 0; i < s.bodies; ++i) {
    s.exclusionOffset[i] = static_cast<int>(k);
    for (; k < pairs.size() && pairs[k].first == i; ++k) s.exclusionBody[k] = pairs[k].second;
  }
  s.exclusionOffset[s.bodies] = static_cast<int>(k);
}

std::vector<EngineContact> contactsOf(const HostTables& tables) {
  const View& s = tables.view();
  std::vector<EngineContact> out;
  for (int i = 0; i < s.bodies; ++i) {
    for (int k = s.oldPairOffset[i]; k < s.oldPairOffset[i + 1]; ++k) {
      const Manifold& m = s.oldManifold[k];
      if (m.count == 0 || m.row < 0) continue;
      const ContactRows& r = s.contact[m.row];
      for (int point = 0; point < m.count; ++point) {
        const Vec3 onA = rotate(s.orientation[r.a], pointOnA(m, point));
        const Vec3 onB = centreDistance(s, r.a, r.b) + rotate(s.orientation[r.b], pointOnB(m, point));
        Vec3 t1, t2;
        tangentBasis(r.n, t1, t2);
        const Vec3 force = r.n * r.lambdaN[point] + t1 * r.lambda1[point] + t2 * r.lambda2[point];
        out.push_back({r.a, r.b, s.position[r.a] + Vec3d((onA + onB) * Real(.5)), Vec3d(r.n), Vec3d(force),
                       static_cast<double>(dot(r.n, onA - onB))});
      }
    }
  }
  return out;
}

JointState jointStateOf(const HostTables& tables, int type, int slot) {
  const View& s = tables.view();
  JointState state;
  withJointType(type, [&]<class F>() {
    const Joint<F>& joint = s.jointsOf<F>()[slot];
    const Vec3d origin = jointOrigin(s, joint.b);
    Real error[F::kRows];
    F::constraint(joint.data, worldPose(s, joint.a, origin), worldPose(s, joint.b, origin), error);
    state.broken = joint.broken;
    state.gap = length(Vec3{error[0], error[1], error[2]});
    state.force = {joint.lambda[0], joint.lambda[1], joint.lambda[2]};
    if constexpr (F::kRows == 6) {
      state.angle = length(Vec3{error[3], error[4], error[5]});
      const Vec3 torque = rotate(joint.b == kWorldBody ? Quat{} : s.orientation[joint.b], Vec3{joint.lambda[3], joint.lambda[4], joint.lambda[5]});
      state.torque = Vec3d(torque);
    }
  });
  return state;
}

Quality qualityOf(const HostTables& tables) {
  const View& s = tables.view();
  Quality q;
  std::vector<double> depths;
  for (const EngineContact& c : contactsOf(tables)) depths.push_back(std::max(0.0, c.depth));
  int joints = 0;
  addSoftQuality(tables, q, depths, joints);
  q.penetration = distribution(depths);
  forEachType(JointTypes{}, [&]<class F>() {
    const int type = typeIndex<F>(JointTypes{});
    for (int i = 0; i < s.joints[type]; ++i) {
      const Joint<F>& joint = s.jointsOf<F>()[i];
      if (!active(s, joint)) continue;
      const double gap = jointStateOf(tables, type, i).gap;
      q.jointGapMean += gap;
      q.jointGapMax = std::max(q.jointGapMax, gap);
      ++joints;
    }
  });
  if (joints > 0) q.jointGapMean /= joints;

  for (int i = 0; i < s.bodies; ++i) {
    const BodyParams& p = s.params[i];
    if (p.kind != BodyKind::Dynamic) continue;
    const Vec3 w = rotateInverse(s.orientation[i], s.spin[i]);
    const double v2 = dot(Vec3d(s.velocity[i]), Vec3d(s.velocity[i]));
    q.kineticEnergy += .5 * (static_cast<double>(p.mass) * v2 + static_cast<double>(dot(w, mul(p.inertia, w))));
    q.potentialEnergy -= static_cast<double>(p.mass * p.gravityScale) * dot(Vec3d(s.step.gravity), s.position[i]);
    q.maxSpeed = std::max(q.maxSpeed, std::sqrt(v2));
  }
  return q;
}

}  // namespace rubble::RUBBLE_CORE
