/// Chains with a heavy end. Source: the AVBD paper, Figure 7 (y up, g 9.81; our dimensions).
#include <cmath>

#include "build.h"
#include "families.h"
#include "motion_probes.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr double kLink = .5;       // length of a link [m]
constexpr double kHalfWidth = .1;  // half the width of a link [m]
constexpr double kHalfCube = 1;    // half the edge of the heavy cube [m]

/// links - 1 links and a heavy cube along `along`, hanging from the origin.
Scene chain(const Arguments& arguments, const Vec3& along) {
  const int links = whole(arguments, "links");
  const Scale scale = scaleOf(arguments);
  const double mass = 4 * kHalfWidth * kHalfWidth * kLink * scale.density * scale.length * scale.length *
                      scale.length;
  const Vec3 halfLink = kHalfWidth * Vec3{1, 1, 1} + (kLink / 2 - kHalfWidth) * abs(along);
  Scene scene = emptyScene(kUpY, 9.81);
  double hung = 0;
  for (int i = 0; i < links; ++i) {
    const bool last = i + 1 == links;
    const double half = last ? kHalfCube : kLink / 2;
    BodyDef body = block(scale.length * (last ? Vec3{kHalfCube, kHalfCube, kHalfCube} : halfLink),
                         scale.length * (hung + half) * along, scale.density);
    body.name = last ? "heavy" : "link" + std::to_string(i);
    if (last) body.mass = value(arguments, "ratio") * mass;
    const Vec3 upper = i == 0 ? Vec3{} : scale.length * (kLink / 2) * along;
    scene.joints.push_back(ballJoint(i == 0 ? kWorld : i - 1, upper, i, -scale.length * half * along,
                                     "joint" + std::to_string(i)));
    scene.bodies.push_back(body);
    hung += 2 * half;
  }
  return scene;
}

Scene buildHanging(const Arguments& arguments) { return chain(arguments, {0, -1, 0}); }
Scene buildSwing(const Arguments& arguments) { return chain(arguments, {1, 0, 0}); }

/// From the anchor to the heavy cube [m].
double chainLength(const Arguments& arguments) {
  return (whole(arguments, "links") - 1) * kLink * scaleOf(arguments).length;
}

/// m g L: what a fall of all bodies by the length would give [J].
double energyScale(const Arguments& arguments, const Scene& scene) {
  double mass = 0;
  for (const BodyDef& body : scene.bodies)
    mass += body.mass ? *body.mass
                      : 8 * body.density * body.shape.halfExtents.x * body.shape.halfExtents.y *
                            body.shape.halfExtents.z;
  return mass * length(scene.gravity) * (chainLength(arguments) + kHalfCube * scaleOf(arguments).length);
}

Probes probes(const Arguments& arguments, const Scene& scene) {
  Probes result;
  result.push_back(chainProbe(scene, chainLength(arguments)));
  result.push_back(energyProbe(energyScale(arguments, scene)));
  return result;
}

Probes swingProbes(const Arguments& arguments, const Scene& scene) {
  Probes result = probes(arguments, scene);
  result.push_back(swingProbe("heavy", {1, 0, 0}));
  return result;
}

const Claim& keepsEnergy() {
  // Rounding in float, summed over the run.
  static const Claim claim = atMost("energy_gain_ratio", 1e-3, "it never gains energy");
  return claim;
}

std::vector<Claim> claims(const Arguments&) {
  return {atMost("stretch", .001, "under a thousandth of the length"), keepsEnergy(),
          atMost("quarantined", 0, "every state stays finite")};
}

constexpr int kPendulumLinks = 50;
constexpr double kPendulumRatio = 50000;
constexpr double kPendulumSwing = 5.887;  // first swing at 1600 iterations of sweeps in double precision [s]

std::vector<Claim> pendulumClaims(const Arguments& arguments) {
  const Scale scale = scaleOf(arguments);
  std::vector<Claim> result{
      atMost("joint_gap_mean_m", .0002 * kLink * scale.length, "mean joint gap under 0.02 % of a link"),
      keepsEnergy(), atMost("quarantined", 0, "every state stays finite")};
  if (whole(arguments, "links") == kPendulumLinks && value(arguments, "ratio") == kPendulumRatio) {
    const double swing = kPendulumSwing * std::sqrt(scale.length);
    result.push_back(within("swing_time_s", .995 * swing, 1.005 * swing,
                            "it swings with the period of a converged run, within 0.5 %"));
  }
  return result;
}

}  // namespace

std::vector<Spec> chainSpecs() {
  Spec chain;
  chain.name = "chain";
  chain.doc = "A chain of links with a heavy cube as the last, hanging from a point.";
  chain.arguments = stackArguments(
      {count("links", 20, 2, 5000, "bodies, the cube included"),
       quantity("ratio", 100, .1, 1e6, "1", "mass of the cube over that of a link")});
  chain.build = buildHanging;
  chain.probes = probes;
  chain.claims = claims;
  chain.camera = overview;
  chain.steps = 600;
  chain.iterations = 4;
  chain.testArguments = {{"links", 20}, {"ratio", 1000}};
  chain.tags = {"joint", "mass-ratio"};

  Spec swing = chain;
  swing.name = "swing";
  swing.doc = "The chain let go from horizontal.";
  swing.build = buildSwing;
  swing.probes = swingProbes;
  swing.testSteps = 300;

  Spec pendulum = variant(swing, "pendulum-50-50000",
                          "Fifty bodies, the last 50,000 times as heavy as a link, let go from horizontal "
                          "(AVBD paper, Figure 7).",
                          {{"links", kPendulumLinks}, {"ratio", kPendulumRatio}});
  pendulum.claims = pendulumClaims;

  const Spec chain100 = variant(chain, "chain-100-1000",
                                "A hundred bodies, the last 1,000 times as heavy as a link, hanging.",
                                {{"links", 100}, {"ratio", 1000}});
  const Spec swing100 = variant(swing, "swing-100-1000",
                                "The chain of a hundred bodies with 1,000:1 let go from horizontal.",
                                {{"links", 100}, {"ratio", 1000}});
  Spec chain1000 = testedInFull(variant(
      chain, "chain-1000-1000", "A thousand bodies, the last 1,000 times as heavy as a link, hanging.",
      {{"links", 1000}, {"ratio", 1000}}));
  chain1000.testSteps = 120;
  return {chain, testedInFull(chain100), chain1000, swing, testedInFull(swing100), testedInFull(pendulum)};
}

}  // namespace rubble::scenes
