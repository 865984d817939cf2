#pragma once
/// Scene definitions: bodies, joints and scripted events, in physical units. No field concerns the solver.
#include <any>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rubble/deformables.h>
#include <rubble/error.h>
#include <rubble/material.h>
#include <rubble/math.h>

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

/// Keyword of a shape type in scene files: "height_field".
const char* keyword(ShapeType type);
/// The shape type of a keyword. Types without an enumerator are found by it too. Throws Error if there is
/// none.
ShapeType shapeType(const std::string& keyword);

struct ShapeGeometry;
struct ShapePartDef;

/// Mass [kg] and principal moments of inertia [kg m2] about the center of mass.
struct MassProperties {
  double mass = 0;
  Vec3 inertia;  ///< principal moments
  Vec3 center;   ///< center of mass, in the shape frame [m]
  Quat axes;     ///< principal axes -> shape frame
};

/// A collision shape in its authored frame. Body poses, joint anchors and surface triangles refer to that
/// frame. MassProperties gives the center of mass in it. docs/shapes.md has a picture of each.
struct Shape {
  ShapeType type = ShapeType::Box;
  Vec3 halfExtents{.5, .5, .5};  ///< box: half edge lengths [m]
  double radius = .5;            ///< sphere, capsule, cylinder; cone: of its base [m]
  /// Along local z [m]. Capsule: half the distance of the two centers. Cylinder, cone: half the height.
  double halfLength = .5;
  /// Radius of rounded edges and corners [m]. Box and cylinder: inside the given sizes. Hull: added around
  /// it.
  double rounding = 0;
  /// Of the other types. Bodies with the same geometry share its cooked data.
  std::shared_ptr<const ShapeGeometry> geometry = nullptr;
  /// Of the caller: hits and contact events return it. No effect on results, and no part of hashes.
  std::uint64_t userData = 0;

  static Shape sphere(double radius) { return {ShapeType::Sphere, {}, radius, 0}; }
  static Shape box(const Vec3& halfExtents, double rounding = 0) {
    return {ShapeType::Box, halfExtents, 0, 0, rounding};
  }
  static Shape capsule(double radius, double halfLength) {
    return {ShapeType::Capsule, {}, radius, halfLength};
  }
  /// Half space below the local x-y plane (solid where local z < 0). Static bodies only.
  static Shape plane() { return {ShapeType::Plane, {}, 0, 0}; }
  /// Axis: local z.
  static Shape cylinder(double radius, double halfLength, double rounding = 0) {
    return {ShapeType::Cylinder, {}, radius, halfLength, rounding};
  }
  /// Axis: local z, base at z = -halfLength, tip at +halfLength.
  static Shape cone(double radius, double halfLength) { return {ShapeType::Cone, {}, radius, halfLength}; }
  /// Convex hull of points that do not lie in one plane.
  static Shape hull(std::vector<Vec3> points, double rounding = 0);
  /// Compound of convex shapes (no planes). `mass`: its mass properties, in place of those of the parts.
  static Shape compound(std::vector<ShapePartDef> parts, const std::optional<MassProperties>& mass = {});
  /// Triangle mesh, counter-clockwise seen from outside. Static and kinematic bodies only. A one-sided mesh
  /// has contacts on its outside, a two-sided mesh on both sides.
  static Shape mesh(std::vector<Vec3> vertices, std::vector<std::array<int, 3>> triangles,
                    bool twoSided = false);
  /// Height field over the local x-y plane: countX times countY heights [m], x fastest, `spacing` apart [m].
  /// The first sample lies at the origin. Static and kinematic bodies only.
  static Shape heightField(int countX, int countY, const Vec3& spacing, std::vector<double> heights);
  /// Solid of any form from signed distances [m], negative inside, at the points of a lattice. Counts along
  /// x, y and z, x fastest, `spacing` apart [m]. The first sample lies at `origin`.
  static Shape distanceField(const std::array<int, 3>& counts, const Vec3& origin, double spacing,
                             std::vector<double> distances);
};

/// A part of a compound.
struct ShapePartDef {
  Shape shape;
  Vec3 position;                          ///< of the part in the frame of the compound [m]
  Quat orientation;                       ///< part -> compound
  std::optional<Material> material = {};  ///< overrides the material of the body
  double density = 1;                     ///< relative to the density of the body [1]
};

/// Geometry that bodies may share. The type of the shape decides which members are used.
struct ShapeGeometry {
  std::vector<Vec3> points;                   ///< hull; mesh: vertices [m]
  std::vector<std::array<int, 3>> triangles;  ///< mesh
  bool twoSided = false;                      ///< mesh
  std::vector<ShapePartDef> parts;            ///< compound
  std::array<int, 3> counts{};                ///< height field (x, y), distance field: samples
  Vec3 origin;                                ///< distance field: position of the first sample [m]
  Vec3 spacing{1, 1, 1};                      ///< height field (x, y), distance field: sample distance [m]
  std::vector<double> samples;                ///< heights or distances, x fastest [m]
  /// Compound: in place of the mass properties of its parts at density 1. A body scales them to its mass.
  std::optional<MassProperties> mass = {};
};

/// Collision filter, as in Box2D. Two bodies collide if each has a layer that the mask of the other contains.
/// Bodies that share a non-zero `group` always collide if it is positive and never if it is negative. Queries
/// are filtered as well.
struct CollisionFilter {
  std::uint32_t layers = 1;          ///< layers of the body, a bit set
  std::uint32_t mask = 0xffffffffu;  ///< layers that it collides with, a bit set
  int group = 0;
};

enum class Motion { Static, Kinematic, Dynamic };

struct BodyDef {
  std::string name;  ///< optional; scripted events and verdicts refer to it
  Motion motion = Motion::Dynamic;
  Shape shape;
  Material material;
  /// [kg/m3]. Gives mass and inertia of a dynamic body unless `mass` is set.
  double density = 1000;
  std::optional<double> mass;  ///< [kg]; the inertia is scaled to it
  /// Principal moments about the center of mass along the body axes, instead of those of the shape [kg m2].
  std::optional<Vec3> inertia;
  Vec3 position;            ///< of the shape frame, world [m]
  Quat orientation;         ///< body -> world
  Vec3 velocity;            ///< of the center of mass [m/s]
  Vec3 angularVelocity;     ///< world axes [rad/s]
  double gravityScale = 1;  ///< factor on the scene's gravity [1]
  /// c [1/s]: the velocity of a free body decays as exp(-c t), at any time step.
  double linearDamping = 0;
  double angularDamping = 0;              ///< the same for the angular velocity [1/s]
  std::array<bool, 3> lockTranslation{};  ///< locked translations of a dynamic body, world axes
  std::array<bool, 3> lockRotation{};     ///< locked rotations of a dynamic body, world axes
  CollisionFilter filter;
  bool sensor = false;  ///< reports overlaps and has no contact forces
  /// Of the caller: events and hits return it. No effect on results, and no part of hashes.
  std::uint64_t userData = 0;
};

/// Joint types. docs/joints.md describes each with its axes.
enum class JointType {
  Ball,           ///< the anchors coincide
  Fixed,          ///< a ball joint that also keeps the relative orientation
  Hinge,          ///< A rotates about the x axis of the joint
  Slider,         ///< A translates along the x axis of the joint and does not rotate
  Distance,       ///< keeps the distance of the anchors
  Rope,           ///< limits the distance of the anchors
  Spring,         ///< spring and damper between the anchors
  AngularSpring,  ///< spring and damper toward a relative orientation; the anchors are free
  SwingTwist,     ///< ball joint whose x axis swings within a cone and twists within limits
  Universal,      ///< two shafts (x axes) connected by a cross
  SixDof,         ///< three translations and three rotations, each free, limited or locked
  /// Couples rotations of A and B, each about an axis fixed in its frame body (another body, or the world).
  Gear,
  /// Couples the rotation of A about an axis with the translation of B along a line, both fixed in frame
  /// bodies.
  Rack,
  Pulley,  ///< rope from A over two world points to B
  Drag,    ///< soft drag of the anchor of A to that of B with limited force (mouse joint)
};

/// No limit on this side of an axis.
inline constexpr double kFree = std::numeric_limits<double>::infinity();

/// Limits, drive and friction of one joint axis. The coordinate is a translation or length [m], or an angle
/// [rad]. Forces are in [N] or [N m], stiffnesses in [N/m] or [N m/rad], dampers in [N s/m] or [N m s/rad].
struct JointAxis {
  double min = -kFree, max = kFree;  ///< limits; equal values lock the axis
  double limitStiffness = kHard;     ///< of the limits; may be hard
  double limitDamping = 0;           ///< of limits of finite stiffness
  double targetPosition = 0;         ///< of the drive
  double targetSpeed = 0;            ///< of the drive [m/s], [rad/s]
  double driveStiffness = 0;         ///< toward targetPosition; 0: none; may be hard
  /// Toward targetSpeed. 0: none. Hard: a motor that holds its speed within maxDriveForce.
  double driveDamping = 0;
  double maxDriveForce = kHard;  ///< largest force of the drive
  double friction = 0;           ///< dry friction, largest force
  /// Inertia of the motor, as it acts on the coordinate: rotor inertia times gear ratio squared [kg], [kg
  /// m2].
  double armature = 0;
  double damping = 0;     ///< viscous friction, not bounded by maxDriveForce [N s/m], [N m s/rad]
  double motorForce = 0;  ///< a plain force, positive where it raises the coordinate [N], [N m]
};

/// A joint between two bodies, or between a body and the world. Each body has a joint frame: an anchor and x,
/// y, z axes. Coordinates are those of the frame of A in the frame of B.
/// Scene files list the fields in this order. `axes` by type:
///   hinge {angle}, slider {translation}, distance, rope, spring {length},
///   swing-twist {swing (cone), twist}, six-dof {translation x, y, z, rotation x, y, z},
///   gear {theta_A + ratio theta_B}, rack {ratio theta_A - translation_B},
///   pulley {length of A + ratio length of B}.
struct JointDef {
  std::string name;
  JointType type = JointType::Ball;
  int bodyA = kWorld, bodyB = kWorld;  ///< indices into Scene::bodies; at most one is kWorld
  /// Gear, rack: bodies in which the axes of A and B are fixed (a housing, the arm of planet wheels).
  int frameBodyA = kWorld, frameBodyB = kWorld;
  Vec3 anchorA, anchorB;  ///< in the body frame [m] (world: world coordinates)
  Quat frameA, frameB;    ///< joint axes in the body frame (world: world axes)
  /// Fixed, slider, angular spring: target orientation of A in the frame of B, q_B^-1 q_A.
  Quat orientationAtoB;
  Quat driveOrientation;  ///< swing-twist: target orientation of the frame of A in that of B
  /// Of the anchors [N/m], or hard. Spring, rope, distance, pulley: of the length.
  double stiffness = kHard;
  double damping = 0;  ///< in parallel to a finite stiffness [N s/m]
  /// Alternative to damping: fraction of critical damping, for the two bodies alone [1].
  double dampingRatio = 0;
  double angularStiffness = kHard;  ///< of the orientation [N m/rad], or hard
  double angularDamping = 0;        ///< [N m s/rad]
  double angularDampingRatio = 0;   ///< alternative to angularDamping [1]
  double maxForce = kHard;          ///< ball, fixed, drag: largest force on the anchors [N]
  double maxTorque = kHard;         ///< fixed, angular spring: largest torque [N m]
  /// Distance, rope, spring, pulley [m]. Negative: the length when the joint is made.
  double length = -1;
  double ratio = 1;  ///< gear, pulley [1]; rack: translation of B per rotation of A [m/rad]
  /// Swing-twist: half angles of the cone about y and z [rad], at most pi.
  double swingY = kFree, swingZ = kFree;
  double friction = 0;                ///< ball, swing-twist: torque of dry friction, all rotations [N m]
  double driveStiffness = 0;          ///< swing-twist: toward driveOrientation [N m/rad]
  double driveDamping = 0;            ///< [N m s/rad]
  double maxDriveTorque = kHard;      ///< [N m]
  double breakForce = kUnbreakable;   ///< [N]
  double breakTorque = kUnbreakable;  ///< [N m]
  Vec3 pulleyA, pulleyB;              ///< pulley: world points that the rope runs over [m]
  std::array<JointAxis, 6> axes;      ///< by type, see above
  bool collide = false;               ///< do the two bodies collide with each other?
  std::uint64_t userData = 0;         ///< as BodyDef::userData
  std::any own;                       ///< fields of a joint type that has no members here (docs/extending.md)
};

/// JointDef::own of a joint of type "tendon": its coordinate is a length over points of up to four bodies,
/// plus polynomials c_1 q + c_2 q^2 + c_3 q^3 + c_4 q^4 of coordinates between them. Limits, drive, friction
/// and motor are those of axes[0]. Sides 0 to 3 are body A, body B, and the frame bodies of A and of B.
struct TendonFields {
  /// Five numbers for each point: side, x, y, z in the frame of its body [m], and the weight of the segment
  /// to the next point [1]; a segment of weight 0 does not count.
  std::vector<double> path;
  /// Thirteen numbers for each term: kind, side that moves, side that it moves in, axis and anchor on the
  /// body that moves, c_1 to c_4. q is 0 at first. Kinds: 0 turn, 1 travel, 2 to 4 angle about x, y, z of a
  /// gimbal or six_dof joint, with the rotation vectors of its frames on both for axis and anchor [rad].
  std::vector<double> terms;
  /// Thirteen numbers for each sphere or cylinder that a segment goes around where it would cut it: the index
  /// of the point that the segment begins at, the side, the center in the frame of its body [m], and the
  /// axis, zeros for a sphere. Then the radius [m], 1 with a guide or 0, and the guide as seen from the
  /// center [m]. The segment stays on the side of a guide outside, and touches the surface from within if it
  /// is inside. At most one for each segment and four in all, and at most twelve points.
  std::vector<double> wraps;
  /// Two numbers for each term, tiltB and tiltA of the gimbal that an angle is of [rad]. Empty: zeros.
  std::vector<double> tilts = {};
};

/// JointDef::own of a joint of type "gimbal": how its three axes lie in one another. Without it they are
/// orthogonal and meet in a point.
struct GimbalFields {
  /// With all angles at 0 and in the joint frame of B: from anchor B, a point of the first axis, to a point
  /// of the second one, and from there to anchor A, a point of the third one [m].
  Vec3 offsetB, offsetA;
  /// By how much the first and the second axis, and the second and the third one, are closer than 90 degrees
  /// [rad]. The second axis is y of B turned by tiltB about x. With the second angle at 0 the third axis is x
  /// of B turned by tiltA about z of that frame.
  double tiltB = 0, tiltA = 0;
};

/// Keyword of a joint type in scene files: "swing_twist".
const char* keyword(JointType type);
/// The joint type of a keyword. Types without an enumerator are found by it too. Throws Error if there is
/// none.
JointType jointType(const std::string& keyword);
/// A rotation whose x axis has that direction.
Quat frameAlong(const Vec3& x);
/// A joint at a world point [m] with the axes of `frame` (world), for two bodies of the scene at their
/// authored poses. The constraint error is zero, all angles are 0, and orientationAtoB is the authored one.
JointDef jointAt(const Scene& scene, JointType type, int bodyA, int bodyB, const Vec3& point,
                 const Quat& frame = {});
/// A gear between the wheels of two hinges of the scene (indices into Scene::joints): angle_A + ratio angle_B
/// is constant, with the angles of the hinges. Body A of each hinge is its wheel, body B its frame body,
/// which may move. The world is never a wheel.
JointDef gearBetween(const Scene& scene, int hingeA, int hingeB, double ratio);
/// A rack between the wheel of a hinge and the moving body of a slider: ratio [m] times the hinge angle minus
/// the slider translation is constant.
JointDef rackBetween(const Scene& scene, int hinge, int slider, double ratio);

/// A scripted event. It is applied before the step of that index (step 0 is the first).
struct Event {
  int step = 0;
  std::vector<BodyDef> add;
  std::vector<std::string> remove;        ///< names of bodies; a final '*' matches any suffix
  std::vector<std::string> removeJoints;  ///< names of joints
  struct Push {
    std::string body;
    Vec3 velocity;         ///< new velocity [m/s]
    Vec3 angularVelocity;  ///< new angular velocity [rad/s]
  };
  std::vector<Push> setVelocity;
  /// New drive targets of a joint. Empty fields are unchanged.
  struct Turn {
    std::string joint;
    int axis = 0;
    std::optional<double> targetPosition;   ///< of the drive of the axis [m], [rad]
    std::optional<double> targetSpeed;      ///< [m/s], [rad/s]
    std::optional<double> length;           ///< distance, rope, spring, pulley [m]
    std::optional<Vec3> dragTo;             ///< drag: world [m]
    std::optional<double> motorForce = {};  ///< [N], [N m]
  };
  std::vector<Turn> setJoint;
};

struct Scene {
  std::string name;
  std::string description;
  Vec3 gravity{0, 0, -9.81};                ///< [m/s2]
  std::vector<MaterialPair> materialPairs;  ///< at most one of two names
  std::vector<BodyDef> bodies;
  std::vector<JointDef> joints;
  std::vector<std::pair<int, int>> exclusions;  ///< pairs of body indices that do not collide
  std::vector<Deformable> deformables;
  std::vector<AttachmentDef> attachments;
  std::vector<Event> events;
};

/// Exact for polyhedra and for shapes without `rounding`. The surface of a rounded hull or cylinder is
/// triangulated (relative error 2e-3). A distance field sums the cells inside. Planes, meshes and height
/// fields have no mass.
MassProperties massProperties(const Shape& shape, double density);

/// Throws Error with the path of the first invalid field ("scene.bodies[3].mass").
void validate(const Scene& scene);
void validate(const BodyDef& body, const Path& path);
void validate(const MaterialPair& pair, const Path& path);
/// Checks a shape without cooking it: finite numbers, consistent list sizes. Cooking may still find that a
/// hull is flat.
void validate(const Shape& shape, const Path& path);
/// Checks a joint definition, without its bodies.
void validate(const JointDef& joint, const Path& path);

}  // namespace rubble
