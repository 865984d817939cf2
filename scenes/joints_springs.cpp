/// The spring scenes of avbd-demo3d.
#include <cmath>

#include "families.h"
#include "joint_probes.h"

namespace rubble::scenes {
namespace {

constexpr double kG = 10;

// avbd-demo3d, "Spring": rest at 14 - 4 - m g / k.
Scene buildDemoSpring(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, box({1, 1, 1}, {0, 0, 8}, 8), "cube");
  JointDef spring = link(JointType::Spring, 0, kWorld);
  spring.anchorB = {0, 0, 14};
  spring.stiffness = 100;
  spring.length = 4;
  scene.joints.push_back(spring);
  return scene;
}
Probes demoSpringProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(atEnd(
      [](const World& world, Metrics& metrics) { metrics["height_m"] = bodyOf(world, "cube").position.z; }));
  return probes;
}

// avbd-demo3d, "Spring ratio": stiffnesses of 1000 : 1 in turn, attached at the ends of the blocks and so
// compressed.
Scene buildSpringRatio(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  for (int i = 0; i < 8; ++i) {
    const BodyDef body = box({.5, .375, .375}, {3. * i, 0, 12}, .5625);
    put(scene, i == 0 || i == 7 ? held(body) : body, "block" + std::to_string(i));
  }
  for (int i = 0; i < 7; ++i) {
    JointDef spring = link(JointType::Spring, i, i + 1);
    spring.anchorA = {.5, 0, 0}, spring.anchorB = {-.5, 0, 0};
    spring.stiffness = i % 2 ? 10 : 10000;
    spring.length = 3;
    scene.joints.push_back(spring);
  }
  return scene;
}
Probes springRatioProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    if (std::fabs(world.time() - 2) < .3 * world.params().dt)
      metrics["middle_height_2s_m"] = bodyOf(world, "block3").position.z;
  }));
  return probes;
}

// avbd-demo3d, "Soft body": three blocks of 4 x 4 x 4 cubes on soft fixed joints.
Scene buildSoft(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, ground(kUpZ, 0, .5));
  constexpr int n = 4;
  constexpr double side = .8;
  for (int blockIndex = 0; blockIndex < 3; ++blockIndex) {
    const int first = static_cast<int>(scene.bodies.size());
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          BodyDef cube = box({side / 2, side / 2, side / 2},
                             {side * x, side * y, 8 + 5.2 * blockIndex + side * z}, side * side * side);
          cube.material = {.5, .5, 0};
          put(scene, cube);
        }
    const auto at = [&](int x, int y, int z) { return first + (z * n + y) * n + x; };
    const auto weld = [&](int a, int b) {
      const Vec3 middle = (scene.bodies[static_cast<std::size_t>(a)].position +
                           scene.bodies[static_cast<std::size_t>(b)].position) /
                          2;
      JointDef& joint = join(scene, JointType::Fixed, a, b, middle);
      joint.stiffness = 1000;
      joint.angularStiffness = 14746;
    };
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          if (x + 1 < n) weld(at(x, y, z), at(x + 1, y, z));
          if (y + 1 < n) weld(at(x, y, z), at(x, y + 1, z));
          if (z + 1 < n) weld(at(x, y, z), at(x, y, z + 1));
        }
  }
  return scene;
}
Probes noProbes(const Arguments&, const Scene&) { return {}; }

}  // namespace

std::vector<Spec> springSpecs() {
  return {
      jointSpec("spring", "A cube of 8 kg on a spring of 100 N/m (avbd-demo3d).", buildDemoSpring,
                demoSpringProbes, {within("height_m", 9.19, 9.21, "14 - 4 - m g / k")}, 3600),
      jointSpec("spring-ratio",
                "Eight blocks on springs of 10000 and 10 N/m in turn, compressed (avbd-demo3d).",
                buildSpringRatio, springRatioProbes,
                {within("middle_height_2s_m", -2.8, -1.2,
                        "-1.65 or -2.29 in converged runs, by sweeps or with trees: the row is compressed "
                        "and buckles"),
                 within("kinetic_energy_j", 22.9, 36.8, "26.9 or 32.0 there, within 15 %")},
                240),
      jointSpec("soft-blocks", "Three blocks of 64 cubes on soft joints fall on one another (avbd-demo3d).",
                buildSoft, noProbes,
                {atMost("kinetic_energy_j", 17, "they come to rest as in the reference"),
                 atMost("max_speed_m_s", 3, "nothing flies off")},
                600),
  };
}

}  // namespace rubble::scenes
