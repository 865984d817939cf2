/// Stacks near their limit of stability, which inaccurate solutions let fall. Each verdict is stated for the
/// iterations or substeps that the scene needs.
#include <string>

#include "build.h"
#include "families.h"
#include "joint_probes.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

// Harmonic overhang: brick k from the top reaches length / (2 k) beyond the one below, at most.

constexpr Vec3 kBrick{.5, .25, .1};  ///< half edges [m]

Scene buildOverhang(const Arguments& arguments) {
  const int bricks = whole(arguments, "bricks");
  Scene scene = emptyScene(kUpZ, 10);
  put(scene, ground(kUpZ), "ground");
  double x = 0;
  for (int i = 0; i < bricks; ++i) {
    BodyDef brick = block(kBrick, {x, 0, kBrick.z * (2 * i + 1)}, 1000);
    put(scene, brick, "brick" + std::to_string(i));
    if (i + 1 < bricks) x += value(arguments, "share") * kBrick.x / (bricks - 1 - i);
  }
  return scene;
}

// Coins.

constexpr double kCoinRadius = .012, kCoinHalf = .00085;

Scene buildCoins(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  put(scene, ground(kUpZ), "ground");
  for (int i = 0; i < whole(arguments, "coins"); ++i) {
    BodyDef coin = block({}, {0, 0, kCoinHalf * (2 * i + 1)}, 7000);
    coin.shape = Shape::cylinder(kCoinRadius, kCoinHalf);
    put(scene, coin, "coin" + std::to_string(i));
  }
  return scene;
}

Probes standing(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(stackProbe(scene, kNoBound));
  return probes;
}

}  // namespace

std::vector<Spec> fineStackSpecs() {
  Spec overhang;
  overhang.name = "overhang";
  overhang.doc = "Bricks that reach out to 0.95 of the harmonic series beyond the one at the ground.";
  overhang.arguments = {count("bricks", 10, 2, 60, "in the stack"),
                        quantity("share", .95, .1, 1.2, "1", "of the limit")};
  overhang.build = buildOverhang;
  overhang.probes = standing;
  overhang.claims = [](const Arguments&) { return standsClaims(.02, "it stands"); };
  overhang.camera = overview;
  overhang.steps = 600;
  overhang.iterations = 6;
  overhang.tags = {"stack"};

  Spec coins = overhang;
  coins.name = "coins";
  coins.doc = "A stack of coins, left alone for 5 s.";
  coins.arguments = {count("coins", 50, 2, 1000, "in the stack")};
  coins.build = buildCoins;
  coins.claims = [](const Arguments&) { return standsClaims(.02, "it stands"); };
  coins.steps = 300;
  coins.iterations = 10;
  coins.substeps = 4;
  return {overhang, coins};
}

}  // namespace rubble::scenes
