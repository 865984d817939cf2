#pragma once
/// A robot model as its file describes it: a tree of links with their geometry and degrees of freedom.
/// Readers of formats fill it, assemble() makes a scene of it.
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rubble/actuators.h>
#include <rubble/scene.h>
#include <rubble/sensors.h>

#include "convert/report.h"
#include "cook/solid_mass.h"

namespace rubble::convert {

/// A frame in another one: x -> p + R(q) x.
struct Pose {
  Vec3 p;  ///< [m]
  Quat q;
};
inline Pose operator*(const Pose& a, const Pose& b) { return {a.p + rotate(a.q, b.p), normalize(a.q * b.q)}; }
inline Pose inverse(const Pose& a) { return {-rotateInverse(a.q, a.p), conjugate(a.q)}; }
inline Vec3 operator*(const Pose& a, const Vec3& x) { return a.p + rotate(a.q, x); }

/// Collision masks of a geom. Two geoms collide if the `type` of one shares a bit with the `affinity` of the
/// other (MuJoCo).
struct Contact {
  std::uint32_t type = 1, affinity = 1;
  std::uint64_t pairs = 0;  ///< bit i: it is one of Model::pairs[i]

  bool any() const { return type != 0 || affinity != 0 || pairs != 0; }
  auto operator<=>(const Contact&) const = default;
};

struct Geom {
  std::string name;
  Place place;
  Shape shape;
  Pose pose;  ///< of the shape, in the frame of its link
  Material material;
  Contact contact;
};

/// A shape of a link in pictures.
struct DrawnShape {
  Shape shape;                ///< of any type
  Pose pose;                  ///< of the shape, in the frame of its link
  std::optional<Vec3> color;  ///< red, green, blue, 0 to 1 (sRGB)
  int geom = -1;              ///< index of the geom that it shows; -1: none
};

/// A drive and passive spring of a coordinate, as sums over springs and actuators.
struct DofDrive {
  double stiffness = 0;        ///< [N/m], [N m/rad]
  double stiffnessTarget = 0;  ///< sum of stiffness times rest coordinate, and of constant forces [N], [N m]
  double damping = 0;          ///< [N s/m], [N m s/rad]
  double dampingSpeed = 0;     ///< sum of damping times target speed [N], [N m]
  double maxForce = kHard;     ///< [N], [N m]
};

/// A constraint that is not hard, for the mass m that it moves: stiffness m times `stiffness`, and damping of
/// `ratio` times the critical one.
struct Softness {
  double stiffness;  ///< [1/s2]
  double ratio;      ///< [1]

  double damping(double mass) const { return 2 * ratio * mass * std::sqrt(stiffness); }
};

/// What acts on a coordinate: of a joint, or of a tendon.
struct Coordinate {
  /// Coordinates at most; ball: {0, largest angle} [m], [rad].
  std::optional<std::array<double, 2>> range;
  double limitStiffness = kHard;  ///< of the range [N/m], [N m/rad]
  double limitDamping = 0;        ///< the same, of a finite stiffness [N s/m], [N m s/rad]
  double friction = 0;            ///< [N], [N m]
  DofDrive drive;
  double armature = 0;    ///< [kg], [kg m2]
  double damping = 0;     ///< viscous friction [N s/m], [N m s/rad]
  double motorForce = 0;  ///< [N], [N m]
};

enum class DofType { Hinge, Slide, Ball };

/// Springs of a ball joint about the axes of its link.
struct BallSpring {
  Vec3 stiffness;  ///< [N m/rad]
  Quat rest;       ///< turn of the joint at rest
};

/// A joint of a link toward its parent. Several of one link act in their order, the first one next to the
/// parent.
struct Dof : Coordinate {
  DofType type = DofType::Hinge;
  std::string name;
  Place place;
  Vec3 axis{0, 0, 1};                ///< in the frame of the link; hinge, slide
  Vec3 anchor;                       ///< in the frame of the link [m]; hinge, ball
  double reference = 0;              ///< coordinate of the pose in the file [m], [rad]
  double start = 0;                  ///< coordinate at the beginning, relative to `reference` [m], [rad]
  Quat startTurn;                    ///< the same of a ball
  std::optional<BallSpring> spring;  ///< of a ball, besides its drive
  Vec3 startSpeed;  ///< its rate: x of a hinge or slide, of a ball in the frame of the link [m/s], [rad/s]
};

struct Link {
  std::string name;
  Place place;
  int parent = -1;  ///< index of a link before this one, or -1: the world
  Pose pose;        ///< in the frame of its parent
  /// Pose in the world at the beginning, in place of the one by its parent; free links.
  std::optional<Pose> start;
  bool free = false;       ///< moves freely
  bool kinematic = false;  ///< moves as told
  SolidSums mass;          ///< about the origin of its frame; `volume` is the mass [kg]
  std::vector<Geom> geoms;
  std::vector<DrawnShape> drawn;  ///< empty: its geoms, in colors of the renderer
  std::vector<Dof> dofs;
  double gravityScale = 1;
  double linearDamping = 0, angularDamping = 0;  ///< as BodyDef [1/s]
  Vec3 velocity;                  ///< at the beginning, of the center of mass of a free link [m/s]
  Vec3 angularVelocity;           ///< the same, world axes [rad/s]
  bool velocityOfOrigin = false;  ///< `velocity` is that of the origin of its frame

  bool moves() const { return free || kinematic || !dofs.empty(); }
};

/// A joint that closes a loop of links.
struct Loop {
  std::string name;
  Place place;
  bool keepsOrientation = false;  ///< weld; otherwise a ball joint
  int linkA = -1, linkB = -1;     ///< -1: the world
  Vec3 anchorA, anchorB;          ///< in the frames of the links [m]
  Quat orientationAtoB;           ///< weld: orientation of A seen from B
  std::optional<Softness> soft;   ///< for the reduced mass of its bodies
};

/// A joint between links that are placed by themselves. Anchors, frames, axes and the path of a tendon are
/// those of `joint`, in the frames of the links; body A is the one that moves in body B.
struct FreeJoint {
  Place place;
  int linkA = -1, linkB = -1;  ///< -1: the world
  JointDef joint;
};

/// Two geoms that collide whatever their masks, joints and exclusions say.
struct GeomPair {
  std::string name;
  Place place;
  std::pair<int, int> geomA, geomB;  ///< link, index in its geoms
};

/// dofA = c_0 + c_1 q + c_2 q^2 + c_3 q^3 + c_4 q^4, q = dofB, both measured from the pose in the file.
struct Coupling {
  std::string name;
  Place place;
  std::pair<int, int> dofA, dofB;  ///< link, index in its dofs
  std::array<double, 5> terms{0, 1, 0, 0, 0};
  double stiffness = kHard, damping = 0;  ///< of the error of dofA
};

/// A length along a path, or a sum of coordinates.
struct Tendon : Coordinate {
  struct Point {
    int link = -1;      ///< -1: the world
    Vec3 at;            ///< in the frame of the link [m]
    double weight = 1;  ///< of the segment to the next point; 0: none
  };
  struct Term {
    std::pair<int, int> dof;  ///< link, index in its dofs
    double coefficient = 1;
  };
  /// Travel of a point, or turn, of a link along or about an axis that is fixed in another one.
  struct Motion {
    int link = -1, frame = -1;  ///< -1: the world
    bool turns = false;
    int axisLink = -1;            ///< the axis is given in the frame of this link
    Vec3 axis;                    ///< unit
    Vec3 anchor, origin;          ///< of a travel: from `origin` in `frame` to `anchor` in `link` [m]
    std::optional<double> start;  ///< at the beginning; none: by the poses there [m], [rad]
    double coefficient = 1;
  };
  /// A sphere or cylinder that the segment from a point to the next one goes around.
  struct Wrap {
    std::size_t point = 0;      ///< index in `path`
    int link = -1;              ///< -1: the world
    Vec3 center, axis;          ///< in the frame of the link [m]; axis 0: a sphere
    double radius = 0;          ///< [m]
    std::optional<Vec3> guide;  ///< from the center, in the axes of the link [m]
  };
  std::string name;
  Place place;
  std::vector<Point> path;
  std::vector<Term> terms;
  std::vector<Motion> motions;
  std::vector<Wrap> wraps;
};

/// A deformable object, with its vertices in the world.
struct SoftObject {
  Place place;
  int link = 0;  ///< that it is written in; 0: the world of MJCF
  Deformable object;
  std::vector<std::pair<int, int>> pins;  ///< a vertex, and the link that holds it
};

/// A sensor. Frames are those of its links; bodies and joints are left to assemble().
struct ModelSensor {
  Place place;
  std::string what;  ///< "gyro 'imu'"
  SensorDef sensor;
  int link = -1, reference = -1;    ///< -1: the world
  std::pair<int, int> dof{-1, -1};  ///< link, index in its dofs; of a joint axis
  int tendon = -1;                  ///< index of a tendon; of a joint axis
};

/// An actuator. Its length is `gear` times its coordinate plus `offset`; body, joint and signs are left to
/// assemble(). Position and Speed have as `gain` and `included` the force for the drive that they move.
struct ModelActuator {
  Place place;
  std::string what;  ///< "muscle 'biceps'"
  ActuatorDef actuator;
  std::pair<int, int> dof{-1, -1};  ///< link, index in its dofs
  int tendon = -1;                  ///< index of a tendon
  int link = -1;                    ///< of a wrench or adhesion
};

struct ModelCamera {
  std::string name;
  Pose pose;                          ///< in the world; it looks along its -z
  std::optional<double> fieldOfView;  ///< vertical [rad]
};

struct Model {
  std::string name;
  Vec3 gravity{0, 0, -9.81};  ///< [m/s2]
  std::vector<Link> links;    ///< parents before children
  std::vector<Loop> loops;
  std::vector<Coupling> couplings;
  std::vector<Tendon> tendons;
  std::vector<FreeJoint> joints;
  std::vector<SoftObject> objects;
  std::vector<ModelSensor> sensors;
  std::vector<ModelActuator> actuators;
  std::vector<ModelCamera> cameras;             ///< the first one is that of the scene
  std::optional<Vec3> toSun;                    ///< unit, world
  std::optional<double> timeStep;               ///< that the model asks for [s]
  std::vector<std::pair<int, int>> exclusions;  ///< pairs of links (-1: the world)
  std::vector<GeomPair> pairs;                  ///< at most 64
  bool parentsCollide = false;                  ///< do links collide with their parents?
  bool staticParentsCollide = true;             ///< and with static ones?
};

}  // namespace rubble::convert
