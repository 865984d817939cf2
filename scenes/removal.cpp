/// Support removal beside the stacks: a stack that stands by false stiffness hovers when its support goes.
#include <string>

#include "build.h"
#include "families.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

/// `base` settles for 2 s, then the ground goes; half a second of fall is measured. `fall` is what the top must reach of free fall.
Spec removalOf(const Spec& base, const std::string& name, const std::string& doc, const Arguments& defaults, double fall,
               const std::string& why) {
  Spec spec = variant(base, name, doc, defaults, kSettleSteps + int(kFallSeconds * 60));
  std::erase_if(spec.arguments, [](const Argument& a) { return a.name == "smash" || a.name == "ball_radius"; });
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
  spec.claims = [fall, why](const Arguments&) {
    return std::vector<Claim>{within("fall_ratio", fall, 2 - fall, why),
                              within("fall_ratio_ends", .9, 1.1, "the mean of top and bottom falls within 10 % of free fall"),
                              atLeast("fall_ratio_min", fall, "nothing hovers"),
                              atMost("bricks_lost", 0, "it stood before the support went"),
                              atMost("quarantined", 0, "every state stays finite")};
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
  const std::vector<Spec> piles = pileSpecs(), walls = wallSpecs(), pyramids = pyramidSpecs(), towers = towerSpecs();
  const std::string tower = "the top falls at least 80 % of free fall in 30 steps at 4 iterations";
  const std::string pile = "the fall is within 15 % of free fall";
  return {
      removalOf(named(towers, "tower"), "tower-removal", "Ten cubes at rest whose ground goes after 2 s.", {}, .8, tower),
      removalOf(named(towers, "mass"), "mass-removal", "The heavy cube on ten light ones; the ground goes after 2 s.", {}, .8, tower),
      removalOf(named(piles, "pile"), "pile-removal", "The pile of 1,000 bricks; the ground goes after 2 s.", {}, .85, pile),
      removalOf(named(walls, "wall"), "wall-removal", "A running-bond wall; the ground goes after 2 s.", {}, .85, pile),
      removalOf(named(walls, "walls"), "walls-removal", "Running-bond walls of 40 courses; the ground goes after 2 s.", {}, .85, pile),
      removalOf(named(walls, "ring"), "ring-removal", "The small ring wall; the ground goes after 2 s.", {}, .85, pile),
      removalOf(named(walls, "gables"), "gables-removal", "The small field of gables; the ground goes after 2 s.", {}, .85, pile),
      removalOf(named(pyramids, "pyramid"), "pyramid-removal", "A pyramid of base 20; the ground goes after 2 s.", {}, .85, pile),
      removalOf(named(towers, "stack-ratio"), "stack-ratio-removal", "Four growing cubes; the ground goes after 2 s.", {}, .8, tower),
  };
}

}  // namespace rubble::scenes
