/// Scenes of the AVBD paper that no other family has: two balls on a chain (Figure 9) and a wall that breaks
/// (Figure 13). Dimensions are ours; y up, g 9.81 m/s2 for the wall, none for the balls.
#include <cmath>

#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"

namespace rubble::scenes {
namespace {

// Two heavy balls on a chain whirl about one another.

constexpr double kLink = .5, kLinkMass = 20, kBallRadius = 1;  // [m], [kg]

Scene buildWhirl(const Arguments& arguments) {
  const int links = whole(arguments, "links");
  const double speed = value(arguments, "spin"), mass = value(arguments, "ratio") * kLinkMass;
  Scene scene = emptyScene(kUpY, 0);
  const double half = links * kLink / 2 + kBallRadius;
  const auto add = [&](BodyDef body, const std::string& name) {
    body.velocity = cross(Vec3{0, speed, 0}, body.position);
    body.angularVelocity = {0, speed, 0};
    return put(scene, std::move(body), name);
  };
  add(ball(kBallRadius, {-half, 0, 0}, mass), "ball0");
  for (int i = 0; i < links; ++i) {
    const double x = (i + .5) * kLink - links * kLink / 2;
    const int link = add(box({kLink / 2, .1, .1}, {x, 0, 0}, kLinkMass), "link" + std::to_string(i));
    join(scene, JointType::Ball, link - 1, link, {x - kLink / 2, 0, 0});
  }
  const int last = add(ball(kBallRadius, {half, 0, 0}, mass), "ball1");
  join(scene, JointType::Ball, last - 1, last, {half - kBallRadius, 0, 0});
  return scene;
}

Probes whirlProbes(const Arguments& arguments, const Scene&) {
  const double whole = scenes::whole(arguments, "links") * kLink + 2 * kBallRadius;
  Probes probes;
  probes.push_back(jointErrorProbe());
  probes.push_back(everyStep([whole](const World& world, const StepReport&, Metrics& metrics) {
    const double now = length(bodyOf(world, "ball1").position - bodyOf(world, "ball0").position);
    raise(metrics, "length_error_peak", std::fabs(now / whole - 1));
  }));
  return probes;
}

// A wall of bricks on hard joints that break, and three fast balls.

constexpr Vec3 kBrickHalf{.5, .25, .25};
constexpr double kBrickMass = 250, kShotRadius = .4, kShotMass = 100, kShotDistance = 6;
constexpr Vec3 kShots[] = {{-3, 3.6, 0}, {0, 1.6, 0}, {3, 2.9, 0}};

Scene buildWall(const Arguments& arguments) {
  const int columns = whole(arguments, "columns"), courses = whole(arguments, "courses");
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.push_back(ground(kUpY));
  const int first = static_cast<int>(scene.bodies.size());
  const auto place = [&](int x, int y) {
    return Vec3{2 * kBrickHalf.x * (x - .5 * (columns - 1)) + (y % 2 ? .5 : -.5) * kBrickHalf.x,
                kBrickHalf.y * (2 * y + 1), 0};
  };
  for (int y = 0; y < courses; ++y)
    for (int x = 0; x < columns; ++x) {
      const BodyDef brick = box(kBrickHalf, place(x, y), kBrickMass);
      put(scene, y == 0 ? held(brick) : brick, "brick" + std::to_string(y * columns + x));
    }
  const auto bond = [&](int xa, int ya, int xb, int yb) {
    const Vec3 a = place(xa, ya), b = place(xb, yb);
    JointDef& joint = join(scene, JointType::Fixed, first + ya * columns + xa, first + yb * columns + xb,
                           (a + b) / 2);
    joint.breakForce = value(arguments, "break_force");
    joint.breakTorque = value(arguments, "break_torque");
  };
  for (int y = 0; y < courses; ++y)
    for (int x = 0; x < columns; ++x) {
      if (y > 0 && x + 1 < columns) bond(x, y, x + 1, y);
      if (y + 1 == courses) continue;
      // the bricks of the next course that lie on this one
      const int left = y % 2 ? x : x - 1;
      if (left >= 0) bond(x, y, left, y + 1);
      if (left + 1 < columns) bond(x, y, left + 1, y + 1);
    }
  for (const Vec3& target : kShots) {
    BodyDef shot = ball(kShotRadius, target + Vec3{0, 0, kShotDistance}, kShotMass);
    shot.velocity = {0, 0, -value(arguments, "speed")};
    put(scene, shot, "shot" + std::to_string(&target - kShots));
  }
  return scene;
}

/// broken_near_ratio: of the joints that broke, the share within `reach` of a line of flight.
Probes wallProbes(const Arguments&, const Scene& scene) {
  std::vector<char> near;
  for (const JointDef& joint : scene.joints) {
    const Vec3 point = scene.bodies[static_cast<std::size_t>(joint.bodyA)].position + joint.anchorA;
    bool close = false;
    for (const Vec3& shot : kShots)
      close |= portable::hypot(point.x - shot.x, point.y - shot.y) < 4 * kShotRadius;
    near.push_back(close);
  }
  Probes probes;
  probes.push_back(jointErrorProbe());
  probes.push_back(atEnd([near](const World& world, Metrics& metrics) {
    double broken = 0, close = 0;
    std::size_t k = 0;
    for (const JointId id : world.joints()) {
      if (world.state(id).broken) broken += 1, close += near[k];
      ++k;
    }
    metrics["broken"] = broken;
    metrics["broken_near_ratio"] = broken > 0 ? close / broken : 0;
  }));
  return probes;
}

}  // namespace

std::vector<Spec> paperSpecs() {
  Spec whirl = jointSpec("whirl",
                         "Two balls, each 1,000 times as heavy as a link, whirl about one another on a chain "
                         "of fifty links (after Figure 9 of the AVBD paper).",
                         buildWhirl, whirlProbes,
                         {atMost("length_error_peak", .02, "the chain keeps its length within 2 %"),
                          atMost("joint_gap_peak_m", .02 * kLink, "no joint opens by 2 % of a link")},
                         600,
                         {count("links", 50, 1, 1000, "links between the balls"),
                          quantity("ratio", 1000, 1, 1e6, "1", "mass of a ball over that of a link"),
                          quantity("spin", 1, .1, 4, "rad/s", "at the start")});
  Spec wall = jointSpec(
      "breakable-wall",
      "A wall of bricks on hard joints that break, and three fast balls (after Figure 13 of "
      "the AVBD paper).",
      buildWall, wallProbes,
      {atLeast("broken", 10, "the balls break it"),
       atLeast("broken_near_ratio", .9, "within two diameters of where they strike"),
       atMost("joint_gap_max_m", .01, "joints that hold have a gap of less than 1 % of a brick")},
      240,
      {count("columns", 12, 8, 1000, "bricks of a course"), count("courses", 10, 8, 200, "courses"),
       quantity("break_force", 7e4, 1e3, 1e12, "N", "at which a joint breaks"),
       quantity("break_torque", 1.4e5, 1e3, 1e12, "N m", "likewise"),
       quantity("speed", 60, 1, 200, "m/s", "of the balls")});
  return {whirl, wall};
}

}  // namespace rubble::scenes
