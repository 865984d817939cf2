/// A tower of loose blocks, from which a drag joint pulls one block after the other.
#include <algorithm>
#include <cmath>

#include "families.h"
#include "joint_probes.h"

namespace rubble::scenes {
namespace {

constexpr int kLevels = 18, kRow = 3;
constexpr Vec3 kBlock{.375, .125,
                      .075};   ///< half extents, along x in even levels: ten times those of the game
constexpr double kWood = 600;  ///< [kg/m3]
constexpr double kFriction = .25, kHandSpeed = .75,
                 kHandForce = 3000;  ///< [1], [m/s], [N]: friction holds the lowest of them by 1,200 N
constexpr int kFirstPull = 60, kPullSteps = 120;  ///< 1.5 m

/// The middle blocks of these levels are drawn.
constexpr int kDrawn[] = {3, 6, 9, 12, 15};

std::string blockName(int level, int place) {
  return "block" + std::to_string(level) + "-" + std::to_string(place);
}

Scene buildJenga(const Arguments&) {
  Scene scene = emptyScene(kUpZ, 9.81);
  put(scene, ground(kUpZ, 0, kFriction));
  for (int level = 0; level < kLevels; ++level)
    for (int i = 0; i < kRow; ++i) {
      const double aside = 2 * kBlock.y * (i - 1), z = kBlock.z * (2 * level + 1);
      BodyDef def = block(kBlock, level % 2 ? Vec3{aside, 0, z} : Vec3{0, aside, z}, kWood);
      if (level % 2) def.orientation = fromAxisAngle({0, 0, 1}, 1.5707963267948966);
      def.material = {kFriction, kFriction, 0};
      put(scene, def, blockName(level, i));
    }
  int step = kFirstPull;
  for (const int level : kDrawn) {
    const int body = 1 + kRow * level + 1;
    const Vec3 way = level % 2 ? Vec3{0, 1, 0} : Vec3{1, 0, 0},
               from = scene.bodies[static_cast<std::size_t>(body)].position + kBlock.x * way;
    JointDef& hand = join(scene, JointType::Drag, body, kWorld, from, way, "hand" + std::to_string(level));
    hand.stiffness = 4e4, hand.dampingRatio = 1, hand.maxForce = kHandForce;
    for (int k = 0; k < kPullSteps; k += 2, step += 2) {
      Event event;
      event.step = step;
      event.setJoint.push_back({hand.name, 0, {}, {}, {}, from + kHandSpeed * (k + 2) / 60. * way});
      scene.events.push_back(event);
    }
  }
  return scene;
}

/// How far blocks have gone from where they were put: those that are drawn, and all others.
Probes jengaProbes(const Arguments&, const Scene& scene) {
  std::vector<std::pair<std::string, Vec3>> drawn, rest;
  for (const BodyDef& body : scene.bodies) {
    if (body.motion != Motion::Dynamic) continue;
    const bool out = std::any_of(std::begin(kDrawn), std::end(kDrawn),
                                 [&](int level) { return body.name == blockName(level, 1); });
    (out ? drawn : rest).emplace_back(body.name, body.position);
  }
  Probes probes;
  probes.push_back(atEnd([drawn, rest](const World& world, Metrics& metrics) {
    const auto way = [&](const std::pair<std::string, Vec3>& block) {
      return length(bodyOf(world, block.first).position - block.second);
    };
    double least = 1e30, most = 0;
    for (const auto& block : drawn) least = std::min(least, way(block));
    for (const auto& block : rest) most = std::max(most, way(block));
    metrics["drawn_least_m"] = least;
    metrics["drift_max_m"] = most;
    metrics["top_drop_m"] = kBlock.z * (2 * kLevels - 1) -
                            bodyOf(world, blockName(kLevels - 1, 1)).position.z;
  }));
  return probes;
}

}  // namespace

std::vector<Spec> jengaSpecs() {
  Spec jenga = jointSpec(
      "jenga", "A tower of 54 loose blocks, from which a drag joint pulls five.", buildJenga, jengaProbes,
      {atLeast("drawn_least_m", 2 * kBlock.x, "five blocks are out by their length"),
       atMost("drift_max_m", .5 * kBlock.y, "no other went along by a quarter of its width"),
       within("top_drop_m", -.01, .01, "the tower stands")},
      kFirstPull + static_cast<int>(std::size(kDrawn)) * kPullSteps + 60);
  jenga.camera = [](const Arguments&, const Scene&) { return Camera{{4, -5, 3.2}, {.5, .4, 1.2}}; };
  jenga.travels = true;
  jenga.tags = {"stack", "joint"};
  return {jenga};
}

}  // namespace rubble::scenes
