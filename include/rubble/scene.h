#pragma once
/// What an author writes: bodies, joints and what happens to them, in physical units only. Nothing here is about the solver.
#include <optional>
#include <string>
#include <vector>

#include <rubble/material.h>
#include <rubble/math.h>
#include <rubble/soft.h>

namespace rubble {

enum class ShapeType { Sphere, Box, Capsule, Plane };

/// A shape about its body's origin, which is its centre of mass.
struct Shape {
  ShapeType type = ShapeType::Box;
  Vec3 halfExtents{.5, .5, .5};  ///< box: half edge lengths [m]
  double radius = .5;            ///< sphere, capsule [m]
  double halfLength = .5;        ///< capsule: half the distance of its two centres, along local z [m]

  static Shape sphere(double radius) { return {ShapeType::Sphere, {}, radius, 0}; }
  static Shape box(const Vec3& halfExtents) { return {ShapeType::Box, halfExtents, 0, 0}; }
  static Shape capsule(double radius, double halfLength) { return {ShapeType::Capsule, {}, radius, halfLength}; }
  /// Half space below the body's local x-y plane (solid where local z < 0). Static bodies only.
  static Shape plane() { return {ShapeType::Plane, {}, 0, 0}; }
};

enum class Motion { Static, Kinematic, Dynamic };

struct BodyDef {
  std::string name;  ///< optional; events and verdicts refer to it
  Motion motion = Motion::Dynamic;
  Shape shape;
  Material material;
  double density = 1000;        ///< [kg/m3], gives mass and inertia of a dynamic body unless `mass` is set
  std::optional<double> mass;   ///< [kg]; inertia scales with it
  Vec3 position;                ///< centre of mass, world [m]
  Quat orientation;             ///< body -> world
  Vec3 velocity;                ///< [m/s]
  Vec3 angularVelocity;         ///< world axes [rad/s]
  double gravityScale = 1;      ///< factor on the scene's gravity [1]
};

enum class JointType { Ball, Fixed };

/// Ball: the two anchors coincide (3 rows). Fixed: in addition the relative orientation is kept (3 + 3 rows).
struct JointDef {
  std::string name;
  JointType type = JointType::Ball;
  int bodyA = kWorld, bodyB = kWorld;  ///< indices into Scene::bodies; one of them may be kWorld
  Vec3 anchorA, anchorB;               ///< in the frame of its body [m] (world: world coordinates)
  Quat orientationAtoB;                ///< fixed: wanted orientation of A seen from B, q_B^-1 q_A
  double stiffness = kHard;            ///< of the anchors [N/m], or hard
  double angularStiffness = kHard;     ///< of the orientation [N m/rad], or hard
  double breakForce = kUnbreakable;    ///< [N]
  double breakTorque = kUnbreakable;   ///< [N m]
  bool collide = false;                ///< do the two bodies collide with one another?
};

/// Something that happens before the step of that index is taken (step 0 is the first).
struct Event {
  int step = 0;
  std::vector<BodyDef> add;
  std::vector<std::string> remove;           ///< bodies by name, or by prefix with a final '*'
  std::vector<std::string> removeJoints;     ///< joints by name
  struct Push {
    std::string body;
    Vec3 velocity;                           ///< new velocity [m/s]
    Vec3 angularVelocity;                    ///< new angular velocity [rad/s]
  };
  std::vector<Push> setVelocity;
};

struct Scene {
  std::string name;
  std::string description;
  Vec3 gravity{0, 0, -9.81};  ///< [m/s2]
  std::vector<BodyDef> bodies;
  std::vector<JointDef> joints;
  std::vector<Deformable> deformables;
  std::vector<AttachmentDef> attachments;
  std::vector<Event> events;
};

/// Mass [kg] and principal moments of inertia [kg m2] about the centre of mass, body axes.
struct MassProperties {
  double mass = 0;
  Vec3 inertia;
};
/// Exact for every shape; a plane has none.
MassProperties massProperties(const Shape& shape, double density);

/// Throws Error with the path of the first thing that is wrong ("scene.bodies[3].mass").
void validate(const Scene& scene);
void validate(const BodyDef& body, const std::string& path);

}  // namespace rubble
