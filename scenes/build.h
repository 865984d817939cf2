#pragma once
/// Shared by the builders of the scene families: arguments, ground, bricks, claims and cameras.
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "registry.h"

namespace rubble::scenes {

inline constexpr Vec3 kUpY{0, 1, 0};
inline constexpr Vec3 kUpZ{0, 0, 1};
/// Settled phase of smash and removal scenes: 2 s, 120 steps of 1/60 s.
inline constexpr int kSettleSteps = 120;
inline constexpr double kSettleSeconds = 2;
/// Support-removal scenes measure the fall of half a second: 30 steps of 1/60 s.
inline constexpr double kFallSeconds = .5;
inline constexpr double kNoBound = std::numeric_limits<double>::infinity();

// Arguments.
Argument count(const std::string& name, int value, int min, int max, const std::string& doc);
Argument quantity(const std::string& name, double value, double min, double max, const std::string& unit,
                  const std::string& doc);
/// 0 or 1.
Argument flag(const std::string& name, bool value, const std::string& doc);
/// `own` and the two arguments of every stack: density [kg/m3] and length_scale [1].
std::vector<Argument> stackArguments(std::vector<Argument> own, double density = 1000);
double value(const Arguments& arguments, const std::string& name);
int whole(const Arguments& arguments, const std::string& name);
/// A scene of the registry at another size: the same spec with other defaults.
Spec variant(const Spec& base, const std::string& name, const std::string& doc, const Arguments& defaults,
             int steps = 0);

/// The same scene, run in tests at its own size and length.
Spec testedInFull(Spec spec);

/// Scale of a stack. Speeds go with the square root of lengths, so that the motion is similar under the same
/// gravity.
struct Scale {
  double length = 1;      ///< [1]
  double density = 1000;  ///< of a brick [kg/m3]
  double speed = 1;       ///< [1]
};
Scale scaleOf(const Arguments& arguments);

// Bodies.
/// An empty scene with gravity against `up`.
Scene emptyScene(const Vec3& up, double gravity);
/// Static half space "ground" with its surface at `height` above the origin.
BodyDef ground(const Vec3& up, double height = 0, double friction = .6);
/// A dynamic box with friction 0.6 and no name.
BodyDef block(const Vec3& halfExtents, const Vec3& position, double density);
/// Shuffles the bodies from `first` on with a fixed seed. No joint may name one of
/// them yet.
void shuffleBodies(Scene& scene, std::size_t first);
/// Sets static and dynamic friction of all bodies to this coefficient.
void setFriction(Scene& scene, double friction);
/// A ball joint between bodies by index; kWorld: the anchor is in world coordinates.
JointDef ballJoint(int a, const Vec3& anchorA, int b, const Vec3& anchorB, const std::string& name = "");
/// Adds `bodies` before the step of that index.
void addAt(Scene& scene, int step, std::vector<BodyDef> bodies);
/// Opposite of gravity, unit; z without gravity.
Vec3 upOf(const Scene& scene);

// Claims.
Claim within(const std::string& metric, double min, double max, const std::string& why);
Claim atMost(const std::string& metric, double max, const std::string& why);
Claim atLeast(const std::string& metric, double min, const std::string& why);
/// Every brick stays and the top layer moves by `drop` metres at most.
std::vector<Claim> standsClaims(double drop, const std::string& why);
/// After the smash (see smashProbes): something gives way, nothing sinks into the ground. `lengthScale` is a
/// factor on bounds in metres.
std::vector<Claim> smashClaims(double lengthScale);
std::vector<Claim> operator+(std::vector<Claim> a, const std::vector<Claim>& b);

/// A three-quarter view that shows every body, also those that come later; half spaces are left out.
Camera overview(const Arguments& arguments, const Scene& scene);

}  // namespace rubble::scenes
