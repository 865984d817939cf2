/// Removal of the support of a stack: numerical stiffness would let the stack hover.
#include <string>

#include "build.h"
#include "families.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

/// Bounds of a fall.
struct Fall {
  double least;      ///< of free fall: the top layer, and the body that falls least
  bool equalBodies;  ///< a heavy body pushes a light one below it ahead, so the mean of top and bottom says
                     ///< little there
  std::string why;
};

/// `base` settles for 2 s, then the ground goes; half a second of fall is measured.
Spec removalOf(const Spec& base, const std::string& name, const std::string& doc, const Fall& fall) {
  Spec spec = variant(base, name, doc, {}, kSettleSteps + int(kFallSeconds * 60));
  std::erase_if(spec.arguments,
                [](const Argument& a) { return a.name == "smash" || a.name == "ball_radius"; });
  const auto whole = [](Arguments arguments) {
    // What was taken out of the list above.
    arguments["smash"] = 0;
    arguments["ball_radius"] = 1;
    return arguments;
  };
  spec.build = [build = base.build, whole](const Arguments& arguments) {
    Scene scene = build(whole(arguments));
    Event event;
    event.step = kSettleSteps;
    event.remove = {"ground"};
    scene.events.push_back(event);
    return scene;
  };
  spec.probes = [](const Arguments&, const Scene& scene) {
    Probes probes;
    probes.push_back(stackProbe(scene, kSettleSeconds));
    probes.push_back(fallProbe(scene, kSettleSeconds, kFallSeconds));
    return probes;
  };
  spec.claims = [fall](const Arguments&) {
    std::vector<Claim> claims{within("fall_ratio", fall.least, 2 - fall.least, fall.why),
                              atLeast("fall_ratio_min", fall.least, "nothing hovers"),
                              atMost("bricks_lost", 0, "it stood before the support went"),
                              atMost("quarantined", 0, "every state stays finite")};
    if (fall.equalBodies)
      claims.push_back(
          within("fall_ratio_ends", .9, 1.1, "the mean of top and bottom falls within 10 % of free fall"));
    return claims;
  };
  spec.smashStep = -1;
  spec.testSteps = 0;
  spec.testArguments.erase("smash");
  spec.testArguments.erase("ball_radius");
  spec.tags = {"stack", "removal"};
  return spec;
}

const Spec& named(const std::vector<Spec>& specs, const std::string& name) {
  for (const Spec& spec : specs)
    if (spec.name == name) return spec;
  throw Error("scene family", "a scene \"" + name + "\"", "none");
}

}  // namespace

std::vector<Spec> removalSpecs() {
  const std::vector<Spec> piles = pileSpecs(), walls = wallSpecs(), pyramids = pyramidSpecs(),
                          towers = towerSpecs();
  const std::string tower = "the top falls at least 80 % of free fall in 30 steps";
  const Fall equal{.8, true, tower}, unequal{.8, false, tower},
      tall{.85, true, "40 levels: the fall is within 15 % of free fall"};
  return {
      removalOf(named(towers, "tower"), "tower-removal", "Ten cubes at rest whose ground goes after 2 s.",
                equal),
      removalOf(named(towers, "mass"), "mass-removal",
                "The heavy cube on ten light ones; the ground goes after 2 s.", unequal),
      removalOf(named(piles, "pile"), "pile-removal", "The pile of 1,000 bricks; the ground goes after 2 s.",
                tall),
      removalOf(named(walls, "wall"), "wall-removal", "A running-bond wall; the ground goes after 2 s.",
                equal),
      removalOf(named(walls, "walls"), "walls-removal",
                "Running-bond walls of 40 courses; the ground goes after 2 s.", tall),
      removalOf(named(walls, "ring"), "ring-removal",
                "The ring wall of 5,000 bricks; the ground goes after 2 s.", tall),
      removalOf(named(walls, "gables"), "gables-removal",
                "The small field of gables; the ground goes after 2 s.", equal),
      removalOf(named(pyramids, "pyramid"), "pyramid-removal",
                "A pyramid of base 20; the ground goes after 2 s.", equal),
      removalOf(named(towers, "stack-ratio"), "stack-ratio-removal",
                "Four growing cubes; the ground goes after 2 s.", unequal),
  };
}

}  // namespace rubble::scenes
