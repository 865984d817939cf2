#pragma once
/// What a World tells the tables of bodies, joints and queries, and what they tell of contacts and hits; free
/// of the precision of the solver.
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <rubble/world.h>

#include "collision/cooked_shape.h"
#include "forces/soft_model.h"

namespace rubble {

/// A body with its state, in the frame of the engine: about the centre of mass, along the principal axes.
/// `kind`: 0 removed, 1 static, 2 kinematic, 3 dynamic.
struct EngineBody {
  int kind = 0;
  CookedData shape;   ///< `data` counts from the beginning of the engine's tables
  double radius = 0;  ///< of the sphere about the origin that holds it [m]
  Material material;
  int surface = -1;  ///< place among the materials of setSurfaces, -1: one of two frictions and a restitution
                     ///< with the usual rules
  MassProperties mass;
  double gravityScale = 1;
  double linearDamping = 0, angularDamping = 0;
  int locks = 0;  ///< bits 0-2: translation along x, y, z; bits 3-5: rotation about them
  CollisionFilter filter;
  bool sensor = false;
  BodyState state;
};

/// Joint types of the engine, in the order of JointTypes. Several types of an author may be one of them.
enum class EngineJointType {
  Ball,
  Fixed,
  Hinge,
  Slider,
  Distance,
  Universal,
  SwingTwist,
  SixDof,
  Gear,
  Rack,
  Pulley
};
inline constexpr int kEngineJointTypes = 11;

/// Rows that are held together: off, held, friction towards the start of the step, or held where a length has
/// no direction (forces/distance.h).
struct EngineGroup {
  enum class Mode { Off, Hold, Friction, Point };
  Mode mode = Mode::Hold;
  double stiffness = kHard, damping = 0, bound = kHard;
};

/// A joint between body slots (kWorld: none). Groups and axes are those of its parts, in their order.
struct EngineJoint {
  EngineJointType type = EngineJointType::Ball;
  int a = kWorld, b = kWorld;
  int carrierA = kWorld, carrierB = kWorld;  ///< gears, racks: bodies in which the axes lie
  bool alive = false;
  bool isRigid = true;  ///< the bodies hang together
  Vec3 anchorA, anchorB;
  Quat frameA, frameB, aToB;
  Quat baseA, baseB;               ///< gears, racks: the axes in their carriers
  Vec3 pointA, pointB, direction;  ///< pulleys: in the world; racks: in the carrier
  double ratio = 1;
  Quat driveTarget;
  double coneY = 1, coneZ = 1;
  std::vector<EngineGroup> groups;
  std::vector<JointAxis> axes;
  double breakForce = kUnbreakable, breakTorque = kUnbreakable;
  int turned = 0;  ///< six-dof: the author's axis i + turned (modulo 3) is axis i here
};

struct EngineContact {
  int a, b;
  Vec3 position, normal, force;
  double depth;
};

/// Contact of a vertex with a body, or with another vertex (body -1).
struct EngineVertexContact {
  int vertex, body, otherVertex;
  Vec3 normal;  ///< towards the vertex, or to the other one
  Vec3 force;   ///< on the vertex, or on the other one [N]
  double depth;
};

/// Two bodies that touch, a < b.
struct EngineTouch {
  int a, b;
  bool sensor;
};

/// A query (rubble/query.h); body slots.
struct EngineQuery {
  enum Kind { Ray, Cast, Overlap, Closest };
  Kind kind = Ray;
  std::shared_ptr<const CookedShape> shape;  ///< of a cast and an overlap
  Vec3 position;                             ///< of its frame in the engine
  Quat orientation;
  Vec3 move;
  double reach = 0;
  std::uint32_t layers = 0, mask = 0;
  bool sensors = false;
  int ignore = -1;
};
struct EngineHit {
  int body;         ///< -1: none
  double fraction;  ///< of the move; closest point: distance [m]
  Vec3 position, normal;
};

struct EngineSettings {
  Params params;
  Vec3 gravity;
  bool wakeAll = false;  ///< for the next step: nothing sleeps on
};

/// Slots of ids (BodyId::index), and ids of slots.
struct BodyOrder {
  std::span<const int> slotOf, idOf;
};

}  // namespace rubble
