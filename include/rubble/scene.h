#pragma once
/// What an author writes: bodies, joints and what happens to them, in physical units only. Nothing here is
/// about the solver.
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rubble/material.h>
#include <rubble/math.h>
#include <rubble/soft.h>

namespace rubble {

struct Scene;

enum class ShapeType {
  Sphere,
  Box,
  Capsule,
  Plane,
  Cylinder,
  Cone,
  Hull,
  Compound,
  Mesh,
  HeightField,
  DistanceField
};

struct ShapeGeometry;
struct ShapePartDef;

/// A shape in the frame that its author gives it in. Poses of bodies, anchors of joints and triangles of
/// pictures are all about that frame; where the centre of mass lies in it is said by MassProperties.
/// docs/shapes.md has a picture of each.
struct Shape {
  ShapeType type = ShapeType::Box;
  Vec3 halfExtents{.5, .5, .5};  ///< box: half edge lengths [m]
  double radius = .5;            ///< sphere, capsule, cylinder; cone: of the base [m]
  double halfLength = .5;  ///< along local z; capsule: half the distance of its two centres; cylinder, cone:
                           ///< half the height [m]
  double rounding = 0;     ///< radius of edges and corners; box and cylinder: within the given sizes; hull:
                           ///< around it [m]
  std::shared_ptr<const ShapeGeometry>
      geometry = nullptr;  ///< of the other types; bodies that share it share what is made of it

  static Shape sphere(double radius) { return {ShapeType::Sphere, {}, radius, 0}; }
  static Shape box(const Vec3& halfExtents, double rounding = 0) {
    return {ShapeType::Box, halfExtents, 0, 0, rounding};
  }
  static Shape capsule(double radius, double halfLength) {
    return {ShapeType::Capsule, {}, radius, halfLength};
  }
  /// Half space below the body's local x-y plane (solid where local z < 0). Static bodies only.
  static Shape plane() { return {ShapeType::Plane, {}, 0, 0}; }
  /// About local z.
  static Shape cylinder(double radius, double halfLength, double rounding = 0) {
    return {ShapeType::Cylinder, {}, radius, halfLength, rounding};
  }
  /// About local z: the base at z = -halfLength, the tip at +halfLength.
  static Shape cone(double radius, double halfLength) { return {ShapeType::Cone, {}, radius, halfLength}; }
  /// The convex hull of points that do not lie in one plane.
  static Shape hull(std::vector<Vec3> points, double rounding = 0);
  /// Several convex shapes that move as one (no planes among them).
  static Shape compound(std::vector<ShapePartDef> parts);
  /// A surface of triangles, counter-clockwise seen from outside. Static and kinematic bodies only. A
  /// one-sided mesh holds what is outside of it, a two-sided one holds things on either side.
  static Shape mesh(std::vector<Vec3> vertices, std::vector<std::array<int, 3>> triangles,
                    bool twoSided = false);
  /// Ground over the local x-y plane: countX times countY heights [m], x fastest, the first one at the
  /// origin, `spacing` apart [m]. Static and kinematic bodies only.
  static Shape heightField(int countX, int countY, const Vec3& spacing, std::vector<double> heights);
  /// A solid of any form, by its signed distance [m] (negative inside) at the points of a lattice: counts
  /// along x, y and z, x fastest, the first one at `origin`, `spacing` apart [m].
  static Shape distanceField(const std::array<int, 3>& counts, const Vec3& origin, double spacing,
                             std::vector<double> distances);
};

/// A part of a compound.
struct ShapePartDef {
  Shape shape;
  Vec3 position;                          ///< of the part's frame in that of the compound [m]
  Quat orientation;                       ///< part -> compound
  std::optional<Material> material = {};  ///< in place of that of the body
  double density = 1;                     ///< over that of the body [1]
};

/// Geometry that many bodies may share. Which members count depends on the type of the shape.
struct ShapeGeometry {
  std::vector<Vec3> points;                   ///< hull; mesh: vertices [m]
  std::vector<std::array<int, 3>> triangles;  ///< mesh
  bool twoSided = false;                      ///< mesh
  std::vector<ShapePartDef> parts;            ///< compound
  std::array<int, 3> counts{};                ///< height field (x, y), distance field: samples
  Vec3 origin;                                ///< distance field: of the first sample [m]
  Vec3 spacing{1, 1, 1};                      ///< height field (x, y), distance field: of samples [m]
  std::vector<double> samples;                ///< heights or distances, x fastest [m]
};

/// What a body collides with. Two bodies meet if each has a layer that the other's mask names; two of one
/// group other than 0 always meet if its number is positive, and never if it is negative. Queries have a
/// filter too.
struct CollisionFilter {
  std::uint32_t layers = 1;          ///< bit set of the layers that the body is in
  std::uint32_t mask = 0xffffffffu;  ///< bit set of the layers that it meets
  int group = 0;
};

enum class Motion { Static, Kinematic, Dynamic };

struct BodyDef {
  std::string name;  ///< optional; events and verdicts refer to it
  Motion motion = Motion::Dynamic;
  Shape shape;
  Material material;
  double density = 1000;        ///< [kg/m3], gives mass and inertia of a dynamic body unless `mass` is set
  std::optional<double> mass;   ///< [kg]; inertia scales with it
  std::optional<Vec3> inertia;  ///< principal moments about the centre of mass along the axes of the body, in
                                ///< place of those of the shape [kg m2]
  Vec3 position;                ///< of the shape's frame, world [m]
  Quat orientation;             ///< body -> world
  Vec3 velocity;                ///< of the centre of mass [m/s]
  Vec3 angularVelocity;         ///< world axes [rad/s]
  double gravityScale = 1;      ///< factor on the scene's gravity [1]
  double
      linearDamping = 0;  ///< c [1/s]: a free body's velocity goes with exp(-c t), exactly at any time step
  double angularDamping = 0;              ///< likewise of the spin [1/s]
  std::array<bool, 3> lockTranslation{};  ///< along these world axes a dynamic body does not move
  std::array<bool, 3> lockRotation{};     ///< about these world axes it does not turn
  CollisionFilter filter;
  bool sensor = false;  ///< overlaps are reported, and nothing is pushed
};

/// docs/joints.md describes each with its axes.
enum class JointType {
  Ball,           ///< the anchors coincide
  Fixed,          ///< and the relative orientation is kept
  Hinge,          ///< A turns about the x axis of the joint
  Slider,         ///< A travels along the x axis of the joint and does not turn
  Distance,       ///< the anchors keep a distance
  Rope,           ///< or a largest one
  Spring,         ///< a spring and damper between the anchors
  AngularSpring,  ///< a spring and damper towards a relative orientation; the anchors are free
  SwingTwist,     ///< ball joint whose x axis swings in a cone and twists within limits
  Universal,      ///< two shafts (x axes) joined by a cross
  SixDof,         ///< three travels and three turns, each free, limited or locked
  Gear,    ///< turns of A and B go together, each about an axis that a carrier (another body, or the world)
           ///< keeps
  Rack,    ///< turn of A about an axis and travel of B along a line that carriers keep
  Pulley,  ///< a rope from A over two points of the world to B
  Grab,    ///< soft drag of A's anchor to B's, with a largest force: a mouse
};

/// No limit on that side of a free axis.
inline constexpr double kFree = std::numeric_limits<double>::infinity();

/// What acts along one axis of a joint: a travel or a length [m], or an angle [rad]. Forces are [N] or [N m],
/// stiffnesses [N/m] or [N m/rad], dampers [N s/m] or [N m s/rad].
struct JointAxis {
  double min = -kFree, max = kFree;  ///< limits; equal ones lock the axis
  double limitStiffness = kHard;     ///< of the limits, or hard
  double limitDamping = 0;           ///< of limits with a stiffness
  double targetPosition = 0;         ///< of the drive
  double targetSpeed = 0;            ///< of the drive [m/s], [rad/s]
  double driveStiffness = 0;         ///< towards targetPosition; 0: none; may be hard
  double driveDamping = 0;  ///< towards targetSpeed; 0: none; hard: a motor that keeps its speed as far as
                            ///< maxDriveForce lets it
  double maxDriveForce = kHard;  ///< largest force of the drive
  double friction = 0;           ///< resists any motion, up to this force
};

/// A joint of two bodies, or of a body and the world. The joint's frame is anchor and x, y, z axes on each
/// body; coordinates are those of the frame of A seen from the frame of B. `axes` by type: hinge {turn},
/// slider {travel}, distance, rope, spring {length}, swing-twist {swing (cone), twist}, six-dof {travel x, y,
/// z, turn x, y, z}, gear {theta_A + ratio theta_B}, rack {ratio theta_A - travel_B}, pulley {length of A +
/// ratio length of B}.
struct JointDef {
  std::string name;
  JointType type = JointType::Ball;
  int bodyA = kWorld, bodyB = kWorld;        ///< indices into Scene::bodies; one of them may be kWorld
  int carrierA = kWorld, carrierB = kWorld;  ///< gear, rack: bodies in which the axes of A and B lie as they
                                             ///< are placed (a housing, the arm of planets)
  Vec3 anchorA, anchorB;                     ///< in the frame of its body [m] (world: world coordinates)
  Quat frameA, frameB;   ///< axes of the joint in the frame of its body (world: world axes)
  Quat orientationAtoB;  ///< fixed, slider, angular spring: wanted orientation of A seen from B, q_B^-1 q_A
  double stiffness = kHard;  ///< of the anchors [N/m], or hard; spring, rope, distance, pulley: of the length
  double damping = 0;        ///< beside a stiffness [N s/m]
  double dampingRatio = 0;   ///< in place of damping: of critical, for the two bodies alone [1]
  double angularStiffness = kHard;  ///< of the orientation [N m/rad], or hard
  double angularDamping = 0;        ///< [N m s/rad]
  double angularDampingRatio = 0;   ///< in place of angularDamping [1]
  double maxForce = kHard;          ///< ball, fixed, grab: the anchors are held with this force at most [N]
  double
      maxTorque = kHard;  ///< fixed, angular spring: the orientation is held with this torque at most [N m]
  std::array<JointAxis, 6> axes;  ///< see above
  double length = -1;     ///< distance, rope, spring, pulley [m]; below 0: as it is when the joint is made
  double ratio = 1;       ///< gear, pulley [1]; rack: travel of B for a radian of A [m]
  Vec3 pulleyA, pulleyB;  ///< pulley: points of the world that the rope runs over [m]
  double swingY = kFree,
         swingZ = kFree;              ///< swing-twist: half angles of the cone about y and z [rad], up to pi
  double friction = 0;                ///< ball, swing-twist: torque that resists any turn [N m]
  Quat driveOrientation;              ///< swing-twist: wanted orientation of A's frame seen from B's
  double driveStiffness = 0;          ///< swing-twist: towards it [N m/rad]
  double driveDamping = 0;            ///< [N m s/rad]
  double maxDriveTorque = kHard;      ///< [N m]
  double breakForce = kUnbreakable;   ///< [N]
  double breakTorque = kUnbreakable;  ///< [N m]
  bool collide = false;               ///< do the two bodies collide with one another?
};

/// Keyword of a type in scene files, "swing_twist".
const char* keyword(JointType type);
/// Rotation whose x axis is that direction.
Quat frameAlong(const Vec3& x);
/// A joint at a point of the world [m] whose axes are those of `frame` (world), for two bodies of the scene
/// as they are placed in it. It has no error and its angles are 0; orientationAtoB is as placed.
JointDef jointAt(const Scene& scene, JointType type, int bodyA, int bodyB, const Vec3& point,
                 const Quat& frame = {});
/// A gear between the wheels of two hinges of the scene (indices into Scene::joints), on moving frames too:
/// angle_A + ratio angle_B is kept, with the angles of the hinges. Each hinge's A is its wheel and its B what
/// carries it; the world is never a wheel.
JointDef gearBetween(const Scene& scene, int hingeA, int hingeB, double ratio);
/// A rack of the wheel of a hinge and what slides on a slider: ratio [m] times the angle of the hinge minus
/// the travel of the slider is kept.
JointDef rackBetween(const Scene& scene, int hinge, int slider, double ratio);

/// Something that happens before the step of that index is taken (step 0 is the first).
struct Event {
  int step = 0;
  std::vector<BodyDef> add;
  std::vector<std::string> remove;        ///< bodies by name, or by prefix with a final '*'
  std::vector<std::string> removeJoints;  ///< joints by name
  struct Push {
    std::string body;
    Vec3 velocity;         ///< new velocity [m/s]
    Vec3 angularVelocity;  ///< new angular velocity [rad/s]
  };
  std::vector<Push> setVelocity;
  /// A joint has another target from then on; what is not given stays.
  struct Turn {
    std::string joint;
    int axis = 0;
    std::optional<double> targetPosition;  ///< of the axis's drive [m], [rad]
    std::optional<double> targetSpeed;     ///< [m/s], [rad/s]
    std::optional<double> length;          ///< distance, rope, spring, pulley [m]
    std::optional<Vec3> grabTo;            ///< grab: world [m]
  };
  std::vector<Turn> setJoint;
};

struct Scene {
  std::string name;
  std::string description;
  Vec3 gravity{0, 0, -9.81};  ///< [m/s2]
  std::vector<BodyDef> bodies;
  std::vector<JointDef> joints;
  std::vector<std::pair<int, int>> exclusions;  ///< bodies by index that do not collide with one another
  std::vector<Deformable> deformables;
  std::vector<AttachmentDef> attachments;
  std::vector<Event> events;
};

/// Mass [kg] and principal moments of inertia [kg m2] about the centre of mass.
struct MassProperties {
  double mass = 0;
  Vec3 inertia;  ///< about the principal axes
  Vec3 centre;   ///< of mass, in the frame of the shape [m]
  Quat axes;     ///< principal axes -> frame of the shape
};
/// Exact for every polyhedron and every shape without `rounding` of a hull or cylinder, of which the surface
/// is taken as triangles (2e-3); a distance field counts the cells inside. Planes, meshes and height fields
/// have no mass.
MassProperties massProperties(const Shape& shape, double density);

/// Throws Error with the path of the first thing that is wrong ("scene.bodies[3].mass").
void validate(const Scene& scene);
void validate(const BodyDef& body, const std::string& path);
/// What can be said of a shape without cooking it: numbers are finite, lists fit to one another. A hull may
/// still turn out to be flat.
void validate(const Shape& shape, const std::string& path);
/// Bodies are not looked at.
void validate(const JointDef& joint, const std::string& path);

}  // namespace rubble
