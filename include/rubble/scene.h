#pragma once
/// What an author writes: bodies, joints and what happens to them, in physical units only. Nothing here is about the solver.
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rubble/math.h>

namespace rubble {

/// "hard": a constraint of infinite stiffness.
inline constexpr double kHard = std::numeric_limits<double>::infinity();
/// "never": a threshold that is not reached.
inline constexpr double kUnbreakable = std::numeric_limits<double>::infinity();
/// In place of a body index of a joint: the fixed world.
inline constexpr int kWorld = -1;

enum class ShapeType { Sphere, Box, Capsule, Plane, Cylinder, Cone, Hull, Compound, Mesh, HeightField, DistanceField };

struct ShapeGeometry;
struct ShapePartDef;

/// A shape in the frame that its author gives it in. Poses of bodies, anchors of joints and triangles of pictures are all about that frame;
/// where the centre of mass lies in it is said by MassProperties. docs/shapes.md has a picture of each.
struct Shape {
  ShapeType type = ShapeType::Box;
  Vec3 halfExtents{.5, .5, .5};  ///< box: half edge lengths [m]
  double radius = .5;            ///< sphere, capsule, cylinder; cone: of the base [m]
  double halfLength = .5;        ///< along local z; capsule: half the distance of its two centres; cylinder, cone: half the height [m]
  double rounding = 0;           ///< radius of edges and corners; box and cylinder: within the given sizes; hull: around it [m]
  std::shared_ptr<const ShapeGeometry> geometry = nullptr;  ///< of the other types; bodies that share it share what is made of it

  static Shape sphere(double radius) { return {ShapeType::Sphere, {}, radius, 0}; }
  static Shape box(const Vec3& halfExtents, double rounding = 0) { return {ShapeType::Box, halfExtents, 0, 0, rounding}; }
  static Shape capsule(double radius, double halfLength) { return {ShapeType::Capsule, {}, radius, halfLength}; }
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
  /// A surface of triangles, counter-clockwise seen from outside. Static and kinematic bodies only. A one-sided mesh holds what is outside
  /// of it, a two-sided one holds things on either side.
  static Shape mesh(std::vector<Vec3> vertices, std::vector<std::array<int, 3>> triangles, bool twoSided = false);
  /// Ground over the local x-y plane: countX times countY heights [m], x fastest, the first one at the origin, `spacing` apart [m]. Static
  /// and kinematic bodies only.
  static Shape heightField(int countX, int countY, const Vec3& spacing, std::vector<double> heights);
  /// A solid of any form, by its signed distance [m] (negative inside) at the points of a lattice: counts along x, y and z, x fastest, the
  /// first one at `origin`, `spacing` apart [m].
  static Shape distanceField(const std::array<int, 3>& counts, const Vec3& origin, double spacing, std::vector<double> distances);
};

/// How the coefficients of two materials make that of their contact. Of two different rules the one that stands later here is taken.
enum class Combine {
  Usual,          ///< friction: geometric mean; restitution: the larger
  Average,
  Minimum,
  Multiply,
  Maximum,
  GeometricMean,
};

/// Surface of a body.
struct Material {
  double staticFriction = .6;   ///< mu_s [1]
  double dynamicFriction = .6;  ///< mu_d [1], at most mu_s
  double restitution = 0;       ///< e [1], for closing speeds above 1 m/s
  Combine frictionCombine = Combine::Usual;
  Combine restitutionCombine = Combine::Usual;
  double rollingFriction = 0;    ///< lever: the moment that resists rolling is at most this times the normal force [m]; a pair takes the larger
  double torsionalFriction = 0;  ///< lever of the moment that resists spinning about the normal [m]; a pair takes the larger
  Vec3 surfaceVelocity{};        ///< of a belt: what lies on the surface is carried along at this velocity, body axes [m/s]
};

/// A part of a compound.
struct ShapePartDef {
  Shape shape;
  Vec3 position;      ///< of the part's frame in that of the compound [m]
  Quat orientation;   ///< part -> compound
  std::optional<Material> material = {};  ///< in place of that of the body
  double density = 1; ///< over that of the body [1]
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

enum class Motion { Static, Kinematic, Dynamic };

struct BodyDef {
  std::string name;  ///< optional; events and verdicts refer to it
  Motion motion = Motion::Dynamic;
  Shape shape;
  Material material;
  double density = 1000;        ///< [kg/m3], gives mass and inertia of a dynamic body unless `mass` is set
  std::optional<double> mass;   ///< [kg]; inertia scales with it
  Vec3 position;                ///< of the shape's frame, world [m]
  Quat orientation;             ///< body -> world
  Vec3 velocity;                ///< of the centre of mass [m/s]
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
  std::vector<Event> events;
};

/// Mass [kg] and principal moments of inertia [kg m2] about the centre of mass.
struct MassProperties {
  double mass = 0;
  Vec3 inertia;  ///< about the principal axes
  Vec3 centre;   ///< of mass, in the frame of the shape [m]
  Quat axes;     ///< principal axes -> frame of the shape
};
/// Exact for every polyhedron and every shape without `rounding` of a hull or cylinder, of which the surface is taken as triangles (2e-3);
/// a distance field counts the cells inside. Planes, meshes and height fields have no mass.
MassProperties massProperties(const Shape& shape, double density);

/// Throws Error with the path of the first thing that is wrong ("scene.bodies[3].mass").
void validate(const Scene& scene);
void validate(const BodyDef& body, const std::string& path);

}  // namespace rubble
