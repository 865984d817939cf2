/// Nets, cables and what hangs on them.
#include <cmath>
#include <numbers>

#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"

namespace rubble::scenes {
namespace {

constexpr double kG = 10;
constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

/// Heights of bodies by index at the end: lowest_m.
std::unique_ptr<Probe> lowestProbe(std::vector<int> bodies) {
  return atEnd([bodies = std::move(bodies)](const World& world, Metrics& metrics) {
    double lowest = 1e30;
    for (const int i : bodies) lowest = std::min(lowest, world.state(world.bodyAt(i)).position.z);
    metrics["lowest_m"] = lowest;
  });
}

// Mail: small balls on rods of 0.5 m to their neighbors, the border held, and a ball of a thousand times
// their mass.
constexpr double kMesh = .5, kBead = .12;
Scene buildMail(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  const int n = whole(arguments, "size");
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const BodyDef bead = ball(kBead, {kMesh * (x - (n - 1) / 2.), kMesh * (y - (n - 1) / 2.), 0}, 1);
      put(scene, x == 0 || y == 0 || x == n - 1 || y == n - 1 ? held(bead) : bead);
    }
  const auto dynamic = [&](int i) {
    return scene.bodies[static_cast<std::size_t>(i)].motion == Motion::Dynamic;
  };
  const auto connect = [&](int a, int b) {
    if (!dynamic(a) && !dynamic(b)) return;
    JointDef rod = link(JointType::Rope, a, b);
    // a little slack, as mail has
    rod.length = 1.1 * kMesh;
    scene.joints.push_back(rod);
  };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      if (x + 1 < n) connect(y * n + x, y * n + x + 1);
      if (y + 1 < n) connect(y * n + x, y * n + x + n);
    }
  put(scene, ball(1, {.1, .07, 1.6}, value(arguments, "ball")), "ball");
  return scene;
}
Probes mailProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    if (world.time() < 5) return;
    for (const JointId id : world.joints()) raise(metrics, "stretch", world.state(id).gap / (1.1 * kMesh));
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    metrics["ball_height_m"] = bodyOf(world, "ball").position.z;
  }));
  return probes;
}
std::vector<Claim> mailClaims(const Arguments&) {
  return {atMost("stretch", .02, "no link longer than its rope by 2 %"),
          atLeast("ball_height_m", -4, "the ball lies in the mail"),
          atMost("max_speed_m_s", 1.5, "and comes to rest"),
          atMost("quarantined", 0, "every state stays finite")};
}

// A deck of planks on hinges between two abutments, hung from two cables of rods over the towers.
constexpr int kPanels = 24;
constexpr double kPanel = 1, kDip = 3, kClear = .6;
Scene buildSuspension(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  const double half = kPanels * kPanel / 2;
  const int west = put(scene, held(box({1, 1.5, .1}, {-half - 1, 0, 0}, 1)), "west");
  const int east = put(scene, held(box({1, 1.5, .1}, {half + 1, 0, 0}, 1)), "east");
  std::vector<int> deck;
  for (int i = 0; i < kPanels; ++i) {
    deck.push_back(put(scene, box({kPanel / 2, 1.5, .1}, {-half + kPanel * (i + .5), 0, 0}, 300),
                       "panel" + std::to_string(i)));
    join(scene, JointType::Hinge, deck.back(), i == 0 ? west : deck[static_cast<std::size_t>(i - 1)],
         {-half + kPanel * i, 0, 0}, kY);
  }
  // the far end can slide: a deck is not to carry the load as a tight rope
  JointDef& roller = join(scene, JointType::SixDof, deck.back(), east, {half, 0, 0}, kX);
  roller.axes[1].min = roller.axes[1].max = roller.axes[2].min = roller.axes[2].max = 0;
  roller.axes[3].min = roller.axes[3].max = roller.axes[5].min = roller.axes[5].max = 0;
  for (const double side : {-1., 1.}) {
    const double y = 1.4 * side;
    const auto cable = [&](int i) {
      const double x = -half + kPanel * i, u = x / half;
      return Vec3{x, y, kClear + kDip * u * u};
    };
    int before = kWorld;
    for (int i = 0; i < kPanels; ++i) {
      const int piece = put(scene, rod(cable(i), cable(i + 1), .04, 8), "");
      join(scene, JointType::Ball, piece, before, cable(i));
      if (i > 0) {
        JointDef hanger = link(JointType::Rope, piece, deck[static_cast<std::size_t>(i)]);
        const BodyDef& cableBody = scene.bodies[static_cast<std::size_t>(piece)];
        hanger.anchorA = rotateInverse(cableBody.orientation, cable(i) - cableBody.position);
        hanger.anchorB = {-kPanel / 2, y, 0};
        scene.joints.push_back(hanger);
      }
      before = piece;
    }
    join(scene, JointType::Ball, before, kWorld, cable(kPanels));
  }
  const int boxes = whole(arguments, "boxes");
  for (int i = 0; i < boxes; ++i)
    put(scene, box({.3, .3, .3}, {-half + 2 + (2 * half - 4) * (i + .5) / boxes, .3 * (i % 3 - 1), 1}, 100),
        "box" + std::to_string(i));
  return scene;
}
Probes suspensionProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  std::vector<int> all;
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i)
    if (scene.bodies[static_cast<std::size_t>(i)].motion == Motion::Dynamic) all.push_back(i);
  probes.push_back(lowestProbe(all));
  probes.push_back(jointErrorProbe(5));
  return probes;
}
std::vector<Claim> suspensionClaims(const Arguments&) {
  return {atLeast("lowest_m", -1.2, "the deck hangs, with its boxes"),
          atMost("joint_gap_peak_m", .02, "no joint or hanger gives by 2 cm"),
          atMost("max_speed_m_s", .5, "and comes to rest"),
          atMost("quarantined", 0, "every state stays finite")};
}

// A trebuchet: a beam of 1 : 4 on a hinge, a counterweight on its short arm, a stone in a sling that is let
// go of.
constexpr double kShort = 1.2, kLong = 4.8, kPivot = 4, kCounter = 1500, kStone = 15, kSling = 3.4;
constexpr int kRelease = 58;
Scene buildTrebuchet(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, ground(kUpZ, 0, .6));
  const double tilt = .8, c = portable::cos(tilt), s = portable::sin(tilt);
  // long arm down at -x, short arm up at +x
  const Vec3 pivot{0, 0, kPivot}, tip = pivot + kLong * Vec3{-c, 0, -s},
                                  root = pivot + kShort * Vec3{c, 0, s};
  const int beam = put(scene, rod(tip, root, .08, 60), "beam");
  join(scene, JointType::Hinge, beam, kWorld, pivot, kY, "pivot");
  const int weight = put(scene, box({.5, .5, .5}, root - .9 * kZ, kCounter), "weight");
  join(scene, JointType::Hinge, weight, beam, root, kY, "hanger");
  BodyDef stone = ball(.15, {tip.x + std::sqrt(kSling * kSling - (tip.z - .15) * (tip.z - .15)), 0, .15},
                       kStone);
  const int shot = put(scene, stone, "stone");
  JointDef sling = jointAt(scene, JointType::Rope, beam, shot, tip);
  sling.name = "sling";
  sling.anchorB = {};
  sling.length = kSling;
  scene.joints.push_back(sling);
  Event event;
  event.step = kRelease;
  event.removeJoints = {"sling"};
  scene.events.push_back(event);
  return scene;
}
Probes trebuchetProbes(const Arguments&, const Scene&) {
  Probes probes;
  struct Track {
    double energy = 0;
    bool known = false;
  };
  const auto track = std::make_shared<Track>();
  probes.push_back(everyStep([track](const World& world, const StepReport&, Metrics& metrics) {
    const Quality q = world.quality();
    const double energy = q.kineticEnergy + q.potentialEnergy;
    if (!track->known) track->energy = energy, track->known = true;
    raise(metrics, "energy_gain_ratio", (energy - track->energy) / (kCounter * kG * 2 * kShort));
    const BodyState stone = bodyOf(world, "stone");
    if (world.stepCount() == kRelease + 1) {
      metrics["release_speed_m_s"] = length(stone.velocity);
      metrics["release_height_m"] = stone.position.z;
    }
    metrics["range_m"] = std::max(metrics["range_m"], std::fabs(stone.position.x));
  }));
  probes.push_back(jointErrorProbe());
  return probes;
}

// A ball of 500 times a link's mass on a chain swings into a wall.
constexpr int kLinks = 12;
Scene buildWrecking(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, ground(kUpZ));
  const Vec3 top{0, 0, 9}, way = normalize(Vec3{-1, 0, -.25});
  int before = kWorld;
  Vec3 at = top;
  for (int i = 0; i < kLinks; ++i) {
    const Vec3 next = at + .5 * way;
    const int piece = put(scene, rod(at, next, .06, 4), "link" + std::to_string(i));
    join(scene, JointType::Ball, piece, before, at);
    before = piece, at = next;
  }
  const int heavy = put(scene, ball(.8, at + .8 * way, 4 * value(arguments, "ratio")), "ball");
  join(scene, JointType::Ball, heavy, before, at, kX, "shackle");
  for (int row = 0; row < 8; ++row)
    for (int i = 0; i < 8; ++i) {
      const double y = -4 + i + .5 * (row % 2);
      put(scene, box({.25, .49, .25}, {1.8, y, .25 + .5 * row}, 150),
          "brick" + std::to_string(row) + "." + std::to_string(i));
    }
  return scene;
}
Probes wreckingProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(jointErrorProbe());
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    // the wall is whole until the ball comes
    const double x = bodyOf(world, "ball").position.x;
    if (x < 0 && world.time() < 1)
      raise(metrics, "early_move_m", std::fabs(bodyOf(world, "brick7.4").position.x - 1.8));
    raise(metrics, "ball_reach_m", x);
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    int moved = 0;
    for (int row = 0; row < 8; ++row)
      for (int i = 0; i < 8; ++i)
        moved += std::fabs(bodyOf(world, "brick" + std::to_string(row) + "." + std::to_string(i)).position.x -
                           1.8) > .5;
    metrics["moved_ratio"] = moved / 64.;
  }));
  return probes;
}

}  // namespace

std::vector<Spec> cableSpecs() {
  Spec mail = jointSpec("chain-mail",
                        "A heavy ball falls into a net of beads on short ropes, held at its border.",
                        buildMail, mailProbes, {}, 360,
                        {count("size", 20, 3, 400, "beads along an edge"),
                         quantity("ball", 1000, 1, 1e5, "kg", "mass of the ball; a bead has 1 kg")});
  mail.claims = mailClaims;
  Spec bridge = jointSpec("suspension-bridge", "A hinged deck on hangers from two cables, with boxes on it.",
                          buildSuspension, suspensionProbes, {}, 600,
                          {count("boxes", 12, 0, 100, "on the deck")});
  bridge.claims = suspensionClaims;
  return {
      mail,
      bridge,
      jointSpec("trebuchet", "A counterweight of 1500 kg throws a stone of 15 kg.", buildTrebuchet,
                trebuchetProbes,
                {atMost("energy_gain_ratio", .01, "it never gains energy"),
                 within("range_m", 160, 170, "165.3 m in a converged run"),
                 atMost("joint_gap_peak_m", .03, "its joints stay closed: half a percent of the beam")},
                360),
      jointSpec("wrecking-ball", "A ball of 500 times a link's mass on a chain swings into a wall.",
                buildWrecking, wreckingProbes,
                {atMost("joint_gap_peak_m", .03, "the chain holds"),
                 atLeast("moved_ratio", .1, "the wall gives way"), atMost("early_move_m", .02, "not before"),
                 atLeast("ball_reach_m", 1, "the ball gets there")},
                360, {quantity("ratio", 500, 1, 1e4, "1", "mass of the ball over that of a link")}),
  };
}

}  // namespace rubble::scenes
