#pragma once
/// State of an MJCF import, and its sections. Each section of the format is one source file.
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "convert/geometry.h"
#include "convert/mass_matrix.h"
#include "convert/mjcf.h"
#include "convert/mjcf_flex_mesh.h"
#include "convert/tag.h"

namespace rubble::convert {

/// Settings of <compiler> and <option> (mjcf_compiler.cpp).
struct MjcfCompiler {
  bool degrees = true;
  bool autolimits = true;
  std::string eulerSequence = "xyz";
  std::size_t inertiaFromGeoms = 2;  ///< false, true, auto
  std::array<double, 2> inertiaGroups{0, 5};
  bool balanceInertia = false;
  double boundMass = 0, boundInertia = 0;  ///< [kg], [kg m2]
  double totalMass = -1;                   ///< not positive: as it is [kg]
  bool stripPath = false;
  std::string meshFolder, textureFolder, assetFolder;
  MeshMass meshMass = MeshMass::Legacy;  ///< of meshes that do not say
  std::vector<double> actuatorsOff;      ///< groups of actuators that are disabled
  bool clampsControls = true;
  bool contacts = true, limits = true, springs = true, dampers = true, friction = true, actuation = true,
       equality = true;
};

/// Default classes (mjcf_defaults.cpp).
struct MjcfDefaults {
  std::map<std::string, std::string> parent;                 ///< "" for the main class
  std::map<std::string, std::vector<pugi::xml_node>> nodes;  ///< elements of each class
  std::string main = "main";
};

struct MjcfMesh {
  TriangleMesh mesh;
  MeshMass mass = MeshMass::Legacy;
  Place place;
  std::optional<Shape> drawn;
  std::string material;  ///< of geoms that have none; "": none
};

/// Color and texture of a surface (mjcf_looks.cpp).
struct MjcfMaterial {
  std::array<double, 4> color{1, 1, 1, 1};  ///< red, green, blue, opacity
  std::string texture;                      ///< "": none
};

struct MjcfHeightField {
  int rows = 0, columns = 0;
  double radiusX = 0, radiusY = 0, height = 0;  ///< [m]
  std::vector<double> samples;                  ///< 0 to 1, x fastest
};

struct MjcfSite {
  int link;
  Pose pose;
  std::optional<Shape> volume = {};  ///< for touch sensors
};

/// Bodies that a plugin makes a cable of.
struct MjcfCable {
  double twist = 0, bend = 0;  ///< moduli [Pa]
  bool isFlat = false;         ///< straight at rest
  std::vector<int> links;
};

/// The coordinate that an actuator acts on, and its gear.
struct MjcfActuator {
  std::pair<int, int> dof{-1, -1};
  int tendon = -1;
  double gear = 1;
};

/// A camera, which looks along its -z, or at the origin of a link.
struct MjcfCamera {
  std::string name;
  int link;
  Pose pose;
  double fieldOfView;   ///< vertical [rad]
  std::string target;   ///< name of a body; "": none
  int targetLink = -1;  ///< its link, when all are read
  Place place;
};

/// The first light that comes from one direction.
struct MjcfSun {
  int link;
  Pose pose;
  Vec3 direction;  ///< of its rays, in the frame of `pose`
  Place place;
  std::string what;  ///< "light 'sun'"
};

/// A loop. Where bodies are is known when all models are read: until then it has the numbers of the file.
struct MjcfLoop : Loop {
  /// Of a loop between bodies, in the frame of A, or of B for a weld [m]; that between sites has its anchors.
  std::optional<Vec3> anchor;
  std::optional<Pose> inA;  ///< of a weld: pose of B in A; none: as in the file
};

/// A sphere or cylinder that tendons may wrap.
struct MjcfRound {
  int link;
  Pose pose;
  double radius;
  bool isCylinder;
};

/// The coordinate or body that an actuator acts on.
struct MjcfTarget {
  Coordinate* coordinate = nullptr;
  Moments moments;        ///< of the actuator, with its gear
  double gear = 1;        ///< of the coordinate
  bool hasLength = true;  ///< false: its length is always 0
  double most = kHard;    ///< largest force of all actuators of the joint
  std::string what;       ///< "joint 'knee'"
  std::pair<int, int> dof{-1, -1};
  int tendon = -1;        ///< that the coordinate is of
  bool isOfModel = true;  ///< false: a tendon that is made for this actuator
  int link = -1;          ///< of a wrench: force and torque in the frame of this link
  Vec3 position, force, torque;
};

/// What surrounds an element of the tree of bodies.
struct MjcfScope {
  int link = 0;
  Pose pose;               ///< of the enclosing frames, in the link
  std::string childClass;  ///< "": none
  std::string suffix;      ///< of names in <replicate>
  int depth = 0;
};

class MjcfReader {
 public:
  MjcfReader(Source& source, const ImportOptions& options, Report& report)
      : source_(source), options_(options), report_(report) {}
  Model read(pugi::xml_node root);

 private:
  // mjcf_compiler.cpp
  void readCompiler(pugi::xml_node node);
  void readOption(pugi::xml_node node);
  void readFlags(pugi::xml_node node);
  double angle(double value) const;
  /// Orientation by quat, axisangle, euler, xyaxes or zaxis; and a frame by pos and orientation.
  Quat orientationOf(const Tag& tag) const;
  Pose poseOf(const Tag& tag) const;
  std::optional<Quat> quaternionOf(const Tag& tag, const char* key) const;

  // mjcf_defaults.cpp
  void readDefaults(pugi::xml_node node, const std::string& parent, int depth);
  /// An element with the defaults of its class, or of `childClass`.
  Tag tagOf(pugi::xml_node node, const std::string& childClass = "");
  /// The same for types that share the defaults of their kind: "tendon", "equality".
  Tag tagOfKind(pugi::xml_node node, const char* kind);
  /// The same for actuators, whose types share their defaults.
  Tag actuatorOf(pugi::xml_node node);
  std::vector<pugi::xml_node> defaultsOf(const std::string& className,
                                         const std::vector<std::string>& types) const;
  std::string classOf(const pugi::xml_node& node, const std::string& childClass) const;

  // mjcf_assets.cpp
  void readAssets(pugi::xml_node node);
  void readMesh(const Tag& tag);
  void readHeightField(const Tag& tag);
  void readModel(const Tag& tag);
  std::filesystem::path assetFile(const Tag& tag, const std::string& folder);

  // mjcf_bodies.cpp
  void readWorld(pugi::xml_node node);
  void readChildren(pugi::xml_node node, const MjcfScope& scope);
  void readBody(const Tag& tag, const MjcfScope& scope);
  void readFrame(const Tag& tag, const MjcfScope& scope);
  void readReplicate(const Tag& tag, const MjcfScope& scope);
  void readInertial(const Tag& tag, const MjcfScope& scope);
  void finishMass(Link& link, bool hasInertial, const SolidSums& ofGeoms);
  void scaleTotalMass();

  // mjcf_looks.cpp
  void readTexture(const Tag& tag);
  void readMaterial(const Tag& tag);
  /// Adds what is seen of a geom, in its color.
  void addDrawn(const Tag& tag, const MjcfScope& scope, DrawnShape drawn);
  void readCamera(const Tag& tag, const MjcfScope& scope);
  void readLight(const Tag& tag, const MjcfScope& scope);
  /// Finds what cameras look at, and makes them those of the scene if this model is not attached to another.
  void finishViews();

  // mjcf_attach.cpp
  void readAttach(const Tag& tag, const MjcfScope& scope);

  // mjcf_geoms.cpp
  void readGeom(const Tag& tag, const MjcfScope& scope);
  /// Integrals at density 1 in the frame of the shape; false if the geom has no shape that can be used.
  /// `drawn`: in pictures, where that is another one.
  bool shapeOf(const Tag& tag, const std::string& type, Geom& geom, SolidSums& solid,
               std::optional<Shape>& drawn);
  const MjcfMesh* meshOf(const Tag& tag) const;
  bool meshShape(const Tag& tag, Geom& geom, SolidSums& solid);
  /// Size of the primitive that MuJoCo fits to a mesh, and `pose` moved to it; empty if that is not possible.
  std::vector<double> fittedSize(const Tag& tag, const std::string& type, Pose& pose);
  bool fieldShape(const Tag& tag, Geom& geom);
  Material materialOf(const Tag& tag);

  // mjcf_flex.cpp
  /// Points and elements in the frame of the object; nothing for types that are not known.
  std::optional<FlexMesh> flexMeshOf(const Tag& tag);
  void readFlexcomp(const Tag& tag, const MjcfScope& scope);

  // mjcf_cable.cpp
  /// Is this a composite or plugin of a cable? Others are left, and so reported.
  bool isCable(pugi::xml_node node) const;
  void readComposite(const Tag& tag, const MjcfScope& scope);
  void expandCable(const Tag& tag, const std::string& childClass);
  void readExtension(pugi::xml_node node);
  void readCableConfig(pugi::xml_node node, MjcfCable& cable);
  /// Of a body.
  void readPlugin(const Tag& tag, const MjcfScope& scope);
  void finishCables();

  // mjcf_joints.cpp
  void readJoint(const Tag& tag, const MjcfScope& scope);
  std::optional<std::array<double, 2>> limitOf(const Tag& tag, const char* range, const char* limited);

  // mjcf_relations.cpp
  /// Pose of a link in the world as the file gives it.
  Pose referencePose(int link) const;
  /// The same with all hinges and slides at the rest of their springs.
  Pose restPose(int link) const;
  void readContact(pugi::xml_node node);
  void readPair(const Tag& tag);
  /// The bits of pairs of geoms in the geoms.
  void finishPairs();
  void readEquality(pugi::xml_node node);
  void readLoop(const Tag& tag);
  void finishLoops();
  void readCoupling(const Tag& tag);
  /// A tendon that keeps its length.
  void readTendonLock(const Tag& tag);
  /// Two tendons, the lengths of which have a linear relation.
  void readTendonRelation(const Tag& tag, std::size_t first, const std::vector<double>& terms);
  int linkOf(const Tag& tag, const char* key) const;

  /// The same with hinges and slides moved from there, by a function of (link, index in its dofs).
  template <class Change> Pose poseWith(int link, Change&& change) const;

  // mjcf_tendons.cpp
  void readTendon(const Tag& tag);
  void readPath(const Tag& tag, Tendon& tendon);
  void readWrap(const Tag& tag, Tendon& tendon);
  const MjcfSite& siteOf(const Tag& tag, const char* key) const;
  void readSum(const Tag& tag, Tendon& tendon);
  double lengthInFile(const Tendon& tendon) const;
  /// Least and largest length within the limits of all hinges and slides; nothing if one of them moves
  /// freely.
  std::optional<std::array<double, 2>> lengthRange(const Tendon& tendon) const;
  /// Rates of the length by those of all hinges and slides, in the pose of the file.
  Moments momentsOf(const Tendon& tendon) const;
  /// The length with all joints at the rest of their springs.
  double lengthAtRest(const Tendon& tendon) const;
  template <class PoseOf, class At> double lengthOf(const Tendon& tendon, PoseOf&& poseOf, At&& at) const;

  // mjcf_inertia.cpp
  /// Mass that a force along a length accelerates in the pose of the file, 1 / (J M^-1 J^T) [kg], [kg m2].
  double massSeen(const Moments& moments);
  /// Norm of the rates of all degrees of freedom by a unit force along a length, |M^-1 J^T|.
  double responseTo(const Moments& moments);
  const MassMatrix& massMatrix(int link);
  /// Springs, dampers and limits that are given by time constant and damping ratio.
  void finishSpringDampers();

  // mjcf_softness.cpp
  /// Of a constraint that is softer than one of MuJoCo by default.
  std::optional<Softness> softnessOf(const Tag& tag, const char* reference, const char* impedance);

  // mjcf_actuators.cpp
  void readActuator(const Tag& tag);
  void readAdhesion(const Tag& tag, ModelActuator actuator);
  /// Name, bounds, and control and activation at the beginning.
  ModelActuator actuatorAtStart(const Tag& tag);
  /// What an actuator acts on; nothing if that is not possible, which is reported.
  std::optional<MjcfTarget> targetOf(const Tag& tag);
  /// Gain, bias and dynamics; false for a law that is not known here.
  bool readLaw(const Tag& tag, const MjcfTarget& target, ActuatorDef& out);
  /// Damping of a drive by its ratio to the critical one.
  double dampingOf(const Tag& tag, const MjcfTarget& target, double stiffness, double ratio);
  bool readGeneral(const Tag& tag, const MjcfTarget& target, ActuatorDef& out);
  /// Adds an actuator whose force is one of the scene at its control and activation at the beginning: a drive
  /// or a motor.
  void addToCoordinate(const Tag& tag, const MjcfTarget& target, ModelActuator& own);

  // mjcf_muscle.cpp
  bool readMuscle(const Tag& tag, const MjcfTarget& target, ActuatorDef& out);

  // mjcf_targets.cpp
  /// `isPlain`: the force depends on the input alone.
  MjcfTarget targetOfSite(const Tag& tag, bool isPlain);
  /// Of a free or ball joint, whose link is given.
  MjcfTarget targetOfTurns(const Tag& tag, int link, bool inParent, bool isPlain);
  /// A new tendon.
  MjcfTarget targetOf(Tendon tendon, const Tag& tag, const std::string& what);
  /// Three numbers of a gear from one on.
  Vec3 gearOf(const Tag& tag, std::size_t first) const;

  // mjcf_sensors.cpp
  void readSensor(const Tag& tag);
  /// Of a site, which touch sensors measure in; nothing for shapes that they do not know.
  static std::optional<Shape> siteVolume(const Tag& site);
  /// The frame of an object; nothing for types that have none here.
  std::optional<MjcfSite> frameOf(const Tag& tag, const char* typeKey, const char* nameKey) const;
  /// What a sensor of a joint, tendon or actuator reads; false if its actuator has no coordinate.
  bool readCoordinate(const Tag& tag, ModelSensor& out);
  /// Leaves sensors of the force of an actuator out where it is not alone.
  void finishSensors();

  // mjcf_keyframes.cpp
  void readKeyframes(pugi::xml_node node);
  void applyKey(const Tag& tag);
  void readSpeeds(const Tag& tag);
  /// Those of the keyframe beyond the actuators of this file.
  void noteFurtherControls();

  Link& link(int i) { return model_.links[static_cast<std::size_t>(i)]; }
  Dof& dof(const std::pair<int, int>& at) { return link(at.first).dofs[static_cast<std::size_t>(at.second)]; }

  Source& source_;
  const ImportOptions& options_;
  Report& report_;
  Model model_;
  MjcfCompiler compiler_;
  MjcfDefaults defaults_;
  std::map<std::string, MjcfMesh> meshes_;
  std::map<std::string, MjcfHeightField> fields_;
  std::map<std::string, int> linkByName_;
  std::map<std::string, std::pair<int, int>> dofByName_;
  std::map<std::string, MjcfSite> sites_;
  std::map<std::string, MjcfRound> rounds_;  ///< geoms that are spheres and cylinders
  std::vector<SolidSums> geomMass_;          ///< of each link: sum of its geoms, in the frame of the link
  std::vector<bool> hasInertial_;            ///< of each link
  std::map<std::pair<int, int>, double> actuatorForce_;  ///< limits by actuatorfrcrange [N], [N m]
  /// Time constant and damping ratio of joints [s], [1].
  std::map<std::pair<int, int>, std::array<double, 2>> springDampers_;
  std::map<std::pair<int, int>, Softness> softLimits_;
  std::map<std::pair<int, int>, double> springRest_;  ///< springref of hinges and slides [m], [rad]
  std::map<std::string, std::size_t> tendonByName_;
  std::map<std::string, int> freeByName_;       ///< links of free joints
  std::map<int, MassMatrix> massMatrices_;      ///< by the first link of their tree that moves
  std::vector<double> controls_, activations_;  ///< of the keyframe
  Place keyPlace_;                              ///< its place
  std::size_t actuators_ = 0, activated_ = 0;   ///< read so far, and those with an activation
  std::size_t elements_ = 0;                    ///< of the tree of bodies, with repetitions
  /// Link and index in its geoms.
  std::map<std::string, std::pair<int, int>> geoms_;
  std::map<std::string, std::filesystem::path> attached_;  ///< files of <model>
  std::vector<MjcfLoop> loops_;
  std::vector<MjcfCamera> cameras_;
  std::map<std::string, MjcfCable> cables_;  ///< by the instances of their plugins
  std::optional<MjcfSun> sun_;
  std::map<std::string, MjcfActuator> actuatorByName_;
  /// Degrees of freedom and tendons that an actuator acts on, and those of them that something else acts on.
  std::set<std::pair<std::pair<int, int>, int>> drivenCoordinates_, sharedCoordinates_;
  std::map<std::string, MjcfMaterial> materials_;
  std::map<std::string, Vec3> textures_;  ///< their mean colors
  int level_ = 0;                         ///< of attached models
  Pose frame_;                            ///< of this model in the one that it is attached to
  bool foundKey_ = false;
};

/// Notes every element and attribute of an MJCF import that was not used (mjcf_unused.cpp).
void noteUnusedMjcf(const Source& source, Report& report);

}  // namespace rubble::convert
