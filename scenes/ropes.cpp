/// Ropes of bricks, a bridge, a grid: many ball joints. Sources: avbd-demo3d (z up, g 10, density 1, friction
/// 0.5); the joint grid of the Box2D benchmarks (y up, g 9.81).
#include "build.h"
#include "families.h"
#include "motion_probes.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr int kRopeLinks = 20;
constexpr double kHalfLink = .5;    // [m]
constexpr double kRopeHeight = 10;  // of a rope's first link [m]
constexpr double kGroundHeight = -20;

/// `links` bricks from "link0", which is static, along `along`; a last one with an edge of `end` metres
/// instead, if that is not 0.
Scene rope(const Arguments& arguments, int links, const Vec3& along, double end) {
  Scene scene = emptyScene(kUpZ, 10);
  const double density = value(arguments, "density");
  const Vec3 halfBrick = .25 * Vec3{1, 1, 1} + (kHalfLink - .25) * abs(along);
  double place = -kHalfLink;
  for (int i = 0; i < links; ++i) {
    const bool last = i + 1 == links && end > 0;
    const double half = last ? end / 2 : kHalfLink;
    BodyDef body = block(last ? Vec3{half, half, half} : halfBrick,
                         Vec3{0, 0, kRopeHeight} + (place + half) * along, density);
    body.name = "link" + std::to_string(i);
    if (i == 0) body.motion = Motion::Static;
    if (i > 0)
      scene.joints.push_back(
          ballJoint(i - 1, kHalfLink * along, i, -half * along, "joint" + std::to_string(i)));
    scene.bodies.push_back(body);
    place += 2 * half;
  }
  scene.bodies.push_back(ground(kUpZ, kGroundHeight));
  setFriction(scene, .5);
  return scene;
}

Scene buildRope(const Arguments& arguments) {
  return rope(arguments, whole(arguments, "links"), {1, 0, 0}, value(arguments, "end"));
}

Scene buildCut(const Arguments& arguments) {
  Scene scene = rope(arguments, kRopeLinks, {0, 0, -1}, 0);
  Event event;
  event.step = kSettleSteps;
  event.removeJoints = {"joint1"};
  scene.events.push_back(event);
  return scene;
}

Scene buildPhase(const Arguments& arguments) { return rope(arguments, kRopeLinks, {1, 0, 0}, 0); }

Probes ropeProbes(const Arguments& arguments, const Scene& scene) {
  Probes probes;
  probes.push_back(chainProbe(scene, whole(arguments, "links") - 1));
  return probes;
}

std::vector<Claim> ropeClaims(const Arguments&) {
  return {atMost("joint_gap_max_m", 1e-4,
                 "largest gap of a joint at the end: a tenth of a millimetre on links of a metre"),
          atMost("quarantined", 0, "every state stays finite")};
}

Probes cutProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(fallProbe(scene, kSettleSeconds, kFallSeconds));
  probes.push_back(lengthProbe("link1", "link" + std::to_string(kRopeLinks - 1), kSettleSeconds));
  return probes;
}

std::vector<Claim> cutClaims(const Arguments&) {
  // Free fall of 30 steps: 1.2917 m.
  return {within("fall_ratio", .998, 1.002, "the top link falls as a free body does"),
          within("fall_ratio_bottom", .998, 1.002, "and so does the bottom link"),
          within("length_m", 17.999, 18.001, "the hanging chain is 18 m long, within 1 mm")};
}

// Kinetic energy of the swinging rope at 200 iterations [J], and when its first swing ends [s].
constexpr double kReferenceFirst = 330, kReferenceLast = 240, kReferenceSwing = 4.052;

Probes phaseProbes(const Arguments& arguments, const Scene&) {
  const double density = value(arguments, "density");
  Probes probes;
  probes.push_back(kineticProbe(150 / 60.0, "kinetic_first_ratio", kReferenceFirst * density));
  probes.push_back(kineticProbe(600 / 60.0, "kinetic_last_ratio", kReferenceLast * density));
  probes.push_back(swingProbe("link" + std::to_string(kRopeLinks - 1), {1, 0, 0}));
  return probes;
}

std::vector<Claim> phaseClaims(const Arguments&) {
  return {
      within("kinetic_first_ratio", .98, 1.02, "kinetic energy after 2.5 s within 2 % of a converged run"),
      within("kinetic_last_ratio", .95, 1.05, "and within 5 % after 10 s"),
      atMost("swing_time_s", kReferenceSwing + 5 / 60.0, "the first swing ends at most 5 steps late"),
      atMost("quarantined", 0, "every state stays finite")};
}

// Bridge.

constexpr int kPlanks = 40;

Scene buildBridge(const Arguments& arguments) {
  const double density = value(arguments, "density");
  Scene scene = emptyScene(kUpZ, 10);
  for (int i = 0; i < kPlanks; ++i) {
    BodyDef plank = block({.5, 2, .25}, {i - .5 * (kPlanks - 1), 0, 10}, density);
    plank.name = "plank" + std::to_string(i);
    if (i == 0 || i + 1 == kPlanks) plank.motion = Motion::Static;
    scene.bodies.push_back(plank);
    for (const double side : {-2.0, 2.0})
      if (i > 0)
        scene.joints.push_back(ballJoint(i - 1, {.5, side, 0}, i, {-.5, side, 0},
                                         "seam" + std::to_string(i) + (side < 0 ? "a" : "b")));
  }
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 5; ++j) scene.bodies.push_back(block({.5, .5, .5}, {i - 4.5, 0, 12.0 + j}, density));
  scene.bodies.push_back(ground(kUpZ));
  setFriction(scene, .5);
  return scene;
}

Probes bridgeProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(stackProbe(scene, kNoBound));
  return probes;
}

std::vector<Claim> bridgeClaims(const Arguments&) {
  return {atMost("joint_gap_max_m", .014,
                 "largest gap of a joint at the end, no more than in the reference at 10 iterations"),
          atLeast("lowest_m", 1, "nothing falls through"),
          atMost("quarantined", 0, "every state stays finite")};
}

// Joint grid.

Scene buildGrid(const Arguments& arguments) {
  const int size = whole(arguments, "size");
  Scene scene = emptyScene(kUpY, 9.81);
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      BodyDef sphere;
      sphere.shape = Shape::sphere(.4);
      sphere.density = value(arguments, "density");
      sphere.position = {column - .5 * (size - 1), double(-row), 0};
      if (row == 0) sphere.motion = Motion::Static;
      const int index = int(scene.bodies.size());
      // A joint between two static spheres would do nothing.
      if (column > 0 && row > 0) scene.joints.push_back(ballJoint(index - 1, {.5, 0, 0}, index, {-.5, 0, 0}));
      if (row > 0) scene.joints.push_back(ballJoint(index - size, {0, -.5, 0}, index, {0, .5, 0}));
      scene.bodies.push_back(sphere);
    }
  return scene;
}

Probes gridProbes(const Arguments&, const Scene&) { return {}; }

std::vector<Claim> gridClaims(const Arguments&) {
  return {atMost("joint_gap_mean_m", .003, "mean gap of a joint under 3 mm"),
          atMost("quarantined", 0, "every state stays finite")};
}

}  // namespace

std::vector<Spec> ropeSpecs() {
  const Argument density = quantity("density", 1, 1e-3, 1e7, "kg/m3", "density of all bodies");
  Spec rope;
  rope.name = "rope";
  rope.doc = "Twenty bricks on ball joints, the first static, let go from horizontal (avbd-demo3d).";
  rope.arguments = {count("links", kRopeLinks, 2, 2000, "bricks, the static one included"),
                    quantity("end", 0, 0, 20, "m", "edge of a cube in place of the last brick; 0: a brick"),
                    density};
  rope.build = buildRope;
  rope.probes = ropeProbes;
  rope.claims = ropeClaims;
  rope.camera = overview;
  rope.steps = 600;
  rope.iterations = 10;
  rope.tags = {"joint"};

  Spec heavy = variant(
      rope, "heavy-rope",
      "The rope with a cube of 5 m as its last link: 125 kg on links of 0.25 kg (avbd-demo3d).",
      {{"end", 5}});
  heavy.tags.push_back("mass-ratio");

  Spec cut = rope;
  cut.name = "chain-cut";
  cut.doc = "A hanging chain of twenty bricks whose top joint goes after 2 s: it must fall and not hover.";
  cut.arguments = {density};
  cut.build = buildCut;
  cut.probes = cutProbes;
  cut.claims = cutClaims;
  cut.steps = kSettleSteps + int(kFallSeconds * 60);
  cut.iterations = 4;
  cut.tags = {"joint", "removal"};

  Spec phase = cut;
  phase.name = "rope-phase";
  phase
      .doc = "Kinetic energy of the swinging rope against a converged run: it must not swing in slow motion.";
  phase.build = buildPhase;
  phase.probes = phaseProbes;
  phase.claims = phaseClaims;
  phase.steps = 600;
  phase.tags = {"joint"};

  Spec bridge = rope;
  bridge.name = "bridge";
  bridge.doc = "Forty planks with two ball joints between neighbors, fifty cubes fall on them (avbd-demo3d).";
  bridge.arguments = {density};
  bridge.build = buildBridge;
  bridge.probes = bridgeProbes;
  bridge.claims = bridgeClaims;

  Spec grid = rope;
  grid.name = "joint-grid";
  grid.doc =
      "A curtain of spheres on ball joints to the left and up, the first row static (Box2D benchmark, with "
      "spheres).";
  grid.arguments = {count("size", 100, 2, 1000, "spheres in a row and in a column"),
                    quantity("density", 1000, 1e-3, 1e7, "kg/m3", "density of a sphere")};
  grid.build = buildGrid;
  grid.probes = gridProbes;
  grid.claims = gridClaims;
  grid.iterations = 4;
  grid.testArguments = {{"size", 12}};
  grid.tags = {"joint", "scale"};

  return {rope, heavy, cut, phase, bridge, grid};
}

}  // namespace rubble::scenes
