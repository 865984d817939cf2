/// Solid blocks of bricks, bonded so that each inner brick rests on four. y up, g 9.81.
#include <algorithm>

#include "build.h"
#include "families.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr Vec3 kHalfBrick{.5, .25, .25};
constexpr double kPitchX = 1.05, kPitchZ = .55;  // [m]: gaps of 5 cm
constexpr double kBallClearance = .61;           // from the ball to the end of an unshifted level [m]
constexpr double kBond = .2;                     // shift of a level over the pitch, to either side

Scene build(const Arguments& arguments) {
  const int nx = whole(arguments, "nx"), nz = whole(arguments, "nz"), levels = whole(arguments, "levels");
  const Scale scale = scaleOf(arguments);
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.reserve(std::size_t(nx) * std::size_t(nz) * std::size_t(levels) + 1);
  scene.bodies.push_back(ground(kUpY));
  for (int level = 0; level < levels; ++level) {
    const double side = level % 2 == 1 ? kBond : -kBond;
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < nz; ++j) {
        const Vec3 position{(i - .5 * (nx - 1) + side) * kPitchX, (level + .5) * 2 * kHalfBrick.y,
                            (j - .5 * (nz - 1) + side) * kPitchZ};
        scene.bodies.push_back(block(scale.length * kHalfBrick, scale.length * position, scale.density));
      }
  }
  if (whole(arguments, "smash") == 1) {
    const double radius = value(arguments, "ball_radius");
    BodyDef ball;
    ball.name = "ball";
    ball.shape = Shape::sphere(scale.length * radius);
    ball.density = 5 * scale.density;
    ball.position = scale.length * Vec3{0, std::max(radius, levels * kHalfBrick.y),
                                        -(nz * kPitchZ / 2 + radius + kBallClearance)};
    ball.velocity = {0, 0, 30 * scale.speed};
    addAt(scene, kSettleSteps, {ball});
  }
  return scene;
}

Probes probes(const Arguments& arguments, const Scene& scene) {
  const bool smash = whole(arguments, "smash") == 1;
  Probes result;
  if (smash) result = smashProbes(scene, kSettleSeconds);
  result.push_back(stackProbe(scene, smash ? kSettleSeconds : kNoBound));
  return result;
}

std::vector<Claim> claims(const Arguments& arguments) {
  const double scale = scaleOf(arguments).length;
  std::vector<Claim> result = standsClaims(.05 * scale,
                                           "40 levels at 4 iterations: the top level goes down under 50 mm");
  if (whole(arguments, "smash") == 1)
    return result + smashClaims(scale) +
           std::vector<Claim>{atMost("smash_penetration_p99_m", .115 * scale,
                                     "bricks stay out of one another as well as in the best engine measured, "
                                     "half a second after the smash")};
  result.push_back(atMost("max_speed_m_s", .05 * scaleOf(arguments).speed, "it stands still"));
  return result;
}

}  // namespace

std::vector<Spec> pileSpecs() {
  Spec pile;
  pile.name = "pile";
  pile.doc =
      "A solid bonded block of bricks 40 levels high, each on four others, smashed by a heavy ball (after "
      "Figure 1 of the AVBD abstract).";
  pile.arguments = stackArguments(
      {count("nx", 5, 1, 1000, "bricks a level along x"), count("nz", 5, 1, 1000, "bricks a level along z"),
       count("levels", 40, 1, 200, "levels of bricks"), flag("smash", true, "1: the ball comes after 2 s"),
       quantity("ball_radius", 2.5, .2, 20, "m", "radius of the ball, five times as dense as a brick")});
  pile.build = build;
  pile.probes = probes;
  pile.claims = claims;
  pile.camera = overview;
  pile.steps = 600;
  pile.iterations = 4;
  pile.smashStep = kSettleSteps;
  pile.testArguments = {{"nx", 3}, {"nz", 4}, {"levels", 10}, {"ball_radius", 1}};
  pile.testSteps = 240;
  pile.tags = {"stack", "smash"};
  std::vector<Spec> specs{pile};
  const auto sized = [&](const std::string& name, const std::string& doc, double nx, double nz, int steps) {
    specs.push_back(variant(pile, name, doc, {{"nx", nx}, {"nz", nz}}, steps));
    specs.back().tags.push_back("scale");
  };
  sized("pile-1k", "The pile of 5 x 5 x 40 = 1,000 bricks, smashed.", 5, 5, 600);
  sized("pile-10k", "The pile of 10 x 25 x 40 = 10,000 bricks, smashed.", 10, 25, 600);
  sized("pile-110k", "The pile of 55 x 50 x 40 = 110,000 bricks, smashed.", 55, 50, 240);
  sized("pile-510k", "The pile of 150 x 85 x 40 = 510,000 bricks, smashed.", 150, 85, 240);
  specs.push_back(variant(pile, "pile-1k-hold", "The pile of 1,000 bricks left alone for 10 s.",
                          {{"nx", 5}, {"nz", 5}, {"smash", 0}}));
  specs.push_back(variant(pile, "pile-10k-hold", "The pile of 10,000 bricks left alone for 10 s.",
                          {{"nx", 10}, {"nz", 25}, {"smash", 0}}));
  return specs;
}

}  // namespace rubble::scenes
