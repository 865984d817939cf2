#pragma once
/// The tables and the executor of the core without a World, for tests of single stages.
#include <backend/cpu/cpu_engine.h>
#include <cook/cook.h>

#include <set>
#include <utility>
#include <vector>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {

/// An executor with bodies in its tables; runs single parts of a step.
class CoreWorld {
 public:
  explicit CoreWorld(int threads = 1) : executor_(threads) { settings_.gravity = {0, 0, -10}; }

  CpuExecutor& executor() { return executor_; }
  SolverData& view() { return executor_.view(); }
  EngineSettings& settings() { return settings_; }

  int add(const BodyDef& def) {
    const int slot = executor_.tables().bodyIds;
    setBodyCount(executor_.tables(), slot + 1);
    EngineBody body;
    body.kind = def.motion == Motion::Static ? 1 : def.motion == Motion::Kinematic ? 2 : 3;
    const CookedShape cooked = cook(def.shape);
    body.shape = cooked.shape;
    if (body.shape.data >= 0) {
      body.shape.data += executor_.tables().shapeIndices;
      addShape(executor_.tables(), cooked, std::vector<int>(cooked.parts.size(), -1),
               endOfShapes(executor_.tables()));
    }
    body.radius = cooked.radius;
    body.staticFriction = def.material.staticFriction, body.dynamicFriction = def.material.dynamicFriction;
    body.restitution = def.material.restitution;
    const MassProperties mass = massProperties(def.shape, def.density);
    body.mass = mass.mass, body.inertia = mass.inertia;
    body.state = {def.position, def.orientation, def.velocity, def.angularVelocity};
    setBody(executor_.tables(), slot, body);
    if (def.shape.type == ShapeType::Plane) planes_.push_back(slot);
    return slot;
  }
  /// After the last body and before the first step.
  void finish(const std::vector<std::pair<int, int>>& exclusions = {}) {
    setPlanes(executor_.tables(), planes_);
    for (const auto& [a, b] : exclusions) apply(executor_.tables(), SetExcluded{a, b, true});
  }
  /// A ball joint of two slots, as engines have them.
  void addBall(int slot, int a, int b, const rubble::Vec3& anchorA = {}, const rubble::Vec3& anchorB = {}) {
    EngineJoint joint;
    joint.a = a, joint.b = b;
    joint.anchorA = anchorA, joint.anchorB = anchorB;
    addJoint(slot, joint);
  }
  /// A joint of its type's slot.
  void addJoint(int slot, EngineJoint joint) {
    joint.alive = true;
    apply(executor_.tables(), SetJoint{slot, joint});
  }
  /// Counters and counts at zero, constants of the next step.
  void begin() {
    beginStep(view(), settings_, 0);
    clear(executor_);
  }

  /// Pairs (low, high) of the broad phase.
  std::set<std::pair<int, int>> pairs() {
    begin();
    pairs::find(executor_);
    std::set<std::pair<int, int>> out;
    for (int k = 0; k < view().counters->pairs; ++k) {
      const OrderedPair o = ordered(view().pair[k]);
      out.emplace(o.a, o.b);
    }
    return out;
  }

 private:
  CpuExecutor executor_;
  EngineSettings settings_;
  std::vector<int> planes_;
};

/// Do two boxes touch at some time of the step if both follow their paths? By the times at which they overlap
/// along each axis. With `reach` between them they count as touching [m].
inline bool touchOnPaths(const Bounds& a, const Bounds& b, double reach) {
  double from = 0, until = 1;
  for (int k = 0; k < 3; ++k) {
    const double half = a.half[k] - std::fabs(a.path[k]) / 2 + b.half[k] - std::fabs(b.path[k]) / 2 + reach;
    const double start = (b.center[k] - b.path[k] / 2) - (a.center[k] - a.path[k] / 2),
                 way = b.path[k] - a.path[k];
    if (way == 0) {
      if (std::fabs(start) > half) return false;
      continue;
    }
    const double in = (-half - start) / way, out = (half - start) / way;
    from = std::max(from, std::min(in, out)), until = std::min(until, std::max(in, out));
  }
  return from <= until;
}

/// Every pair whose swept boxes meet and, with a path longer than a diameter, come within the diameter of the
/// larger body of one another; or whose box meets a half space. At least one body of it is dynamic.
inline std::set<std::pair<int, int>> allPairs(const SolverData& s) {
  std::set<std::pair<int, int>> out;
  const auto isPlane = [&](int i) { return s.params[i].shape.kind == ShapeKind::Plane; };
  for (int i = 0; i < s.bodies; ++i)
    for (int j = i + 1; j < s.bodies; ++j) {
      const BodyKind first = s.params[i].kind, second = s.params[j].kind;
      if (first == BodyKind::Removed || second == BodyKind::Removed) continue;
      if (first != BodyKind::Dynamic && second != BodyKind::Dynamic) continue;
      if (isPlane(i) && isPlane(j)) continue;
      bool meet = true;
      if (isPlane(i) || isPlane(j)) {
        const int p = isPlane(i) ? i : j;
        const Bounds& b = s.bounds[isPlane(i) ? j : i];
        const Vec3 up = rotate(s.orientation[p], Vec3{0, 0, 1});
        meet = dot(up, b.center - Vec3(s.position[p])) <= dot(abs(up), b.half);
      } else {
        for (int k = 0; k < 3; ++k)
          meet &= std::fabs(s.bounds[i].center[k] - s.bounds[j].center[k]) <=
                  s.bounds[i].half[k] + s.bounds[j].half[k];
        const double ri = s.params[i].radius, rj = s.params[j].radius;
        const auto isLong = [&](int body, double radius) {
          const Vec3 path = abs(s.bounds[body].path);
          return std::max({path.x, path.y, path.z}) > 2 * radius;
        };
        if (isLong(i, ri) || isLong(j, rj))
          meet &= touchOnPaths(s.bounds[i], s.bounds[j], 2 * std::max(ri, rj));
      }
      if (meet) out.emplace(i, j);
    }
  return out;
}

}  // namespace rubble::RUBBLE_CORE
