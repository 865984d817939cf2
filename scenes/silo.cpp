/// Grains in a tall bin: the load of its walls against the closed form of Janssen.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "build.h"
#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"
#include "probe_parts.h"

namespace rubble::scenes {
namespace {

constexpr double kWall = .8;     ///< half thickness over the width of the bin [1]
constexpr double kAverage = .5;  ///< forces are averages over the last part of the run [s]

/// A random generator with the same numbers in every build.
class Numbers {
 public:
  explicit Numbers(double seed) : state_(static_cast<std::uint32_t>(seed) * 2654435761u + 12345u) {}
  double between(double low, double high) {
    state_ = state_ * 1664525u + 1013904223u;
    return low + (high - low) * double(state_ >> 8) / double(1u << 24);
  }

 private:
  std::uint32_t state_;
};

/// Inner width of the bin, between opposite sides.
double widthOf(const Arguments& arguments) {
  return 2.04 * value(arguments, "radius") * whole(arguments, "across");
}

Scene buildSilo(const Arguments& arguments) {
  const double r = value(arguments, "radius"), width = widthOf(arguments), rise = value(arguments, "rise");
  const int across = whole(arguments, "across"), layers = whole(arguments, "layers"),
            sides = whole(arguments, "sides");
  const double top = 2 * r * layers * (1.02 + rise) + 2 * r, thick = kWall * width, pitch = width / across;
  Scene scene = emptyScene(kUpZ, 9.81);
  put(scene, held(box({width + thick, width + thick, thick}, {0, 0, -thick}, 1)), "floor");
  for (int k = 0; k < sides; ++k) {
    const Quat turn = fromAxisAngle(Vec3{0, 0, 1}, 2 * std::numbers::pi * k / sides);
    BodyDef wall = held(box({thick, width, top / 2}, rotate(turn, {width / 2 + thick, 0, top / 2}), 1));
    wall.orientation = turn;
    put(scene, wall, "wall" + std::to_string(k));
  }
  Numbers random(value(arguments, "seed"));
  const auto at = [&](int i) { return pitch * (i + .5) - width / 2 + random.between(-.01, .01) * r; };
  for (int z = 0; z < layers; ++z)
    for (int y = 0; y < across; ++y)
      for (int x = 0; x < across; ++x) {
        const Vec3 place{at(x), at(y), r * ((2 * z + 1) * 1.02 + 2 * rise * z)};
        const double own = r * random.between(.8, 1);
        const bool isBox = random.between(0, 1) < value(arguments, "boxes");
        const Vec3 axis{random.between(-1, 1), random.between(-1, 1), random.between(.1, 1)};
        const double angle = random.between(0, std::numbers::pi);
        if (sides != 4 && portable::hypot(place.x, place.y) > width / 2 - r) continue;
        BodyDef grain = box(.57 * own * Vec3{1, 1, 1}, place, 1);
        if (!isBox) grain.shape = Shape::sphere(own);
        grain.mass.reset();
        grain.density = 2000;
        if (isBox) grain.orientation = fromAxisAngle(axis / length(axis), angle);
        put(scene, grain);
      }
  setFriction(scene, value(arguments, "mu"));
  return scene;
}

/// K of Janssen's law at which the floor of a bin bears this share of the weight: (1 - exp(-x)) / x with
/// x = 4 mu K height / width. Any bin whose sides touch one circle has this ratio of circumference to area.
double janssen(double floor, double friction, double slenderness) {
  double low = 0, high = 100;
  for (int k = 0; k < 60; ++k) {
    const double x = (low + high) / 2;
    (-portable::expm1(-x) / x > floor ? low : high) = x;
  }
  return low / (4 * friction * slenderness);
}

class SiloProbe final : public Probe {
 public:
  SiloProbe(const Scene& scene, const Arguments& arguments, double end)
      : gravity_(length(scene.gravity)),
        friction_(value(arguments, "mu")),
        width_(widthOf(arguments)),
        from_(end - kAverage),
        walls_(whole(arguments, "sides")) {}

  void start(const World& world) override {
    for (const BodyId id : world.bodies())
      if (world.definition(id).motion == Motion::Dynamic) weight_ += gravity_ * world.massOf(id).mass;
  }
  void afterStep(const World& world, const StepReport&) override {
    if (!reached(world, from_)) return;
    ++steps_;
    for (const ContactPoint& c : world.contacts()) {
      const int a = c.a.index, b = c.b.index;
      if (a > walls_ && b > walls_) continue;
      (std::min(a, b) == 0 ? floor_ : wall_) += (a <= walls_ ? c.force.z : -c.force.z) / weight_;
    }
  }
  void finish(const World& world, Metrics& metrics) override {
    double mass = 0, moment = 0;
    for (const BodyId id : world.bodies()) {
      if (world.definition(id).motion != Motion::Dynamic) continue;
      const double own = world.massOf(id).mass;
      mass += own, moment += own * world.state(id).position.z;
    }
    metrics["floor_ratio"] = floor_ / steps_;
    metrics["wall_ratio"] = wall_ / steps_;
    metrics["janssen_k"] = janssen(floor_ / steps_, friction_, 2 * moment / mass / width_);
  }

 private:
  double gravity_, friction_, width_, from_, weight_ = 0, floor_ = 0, wall_ = 0;
  int walls_, steps_ = 0;
};

constexpr int kSteps = 300;

Probes siloProbes(const Arguments& arguments, const Scene& scene) {
  Probes probes;
  probes.push_back(std::make_unique<SiloProbe>(scene, arguments, kSteps / 60.));
  return probes;
}

std::vector<Claim> siloClaims(const Arguments&) {
  return {within("janssen_k", .3, 1,
                 "the floor bears what Janssen's law says, with a pressure on the walls of 0.3 to 1 of that "
                 "on the floor"),
          within("wall_ratio", .5, .85, "the walls bear the rest, upwards")};
}

}  // namespace

std::vector<Spec> siloSpecs() {
  Spec silo;
  silo.name = "silo";
  silo.doc =
      "Grains that fall into a tall bin: friction hangs a part of their weight on its walls (Janssen).";
  silo.arguments = {
      count("across", 6, 3, 40, "grains side by side"),
      count("layers", 30, 4, 400, "of grains"),
      quantity("rise", .5, 0, 10, "1", "gap between layers at the start over a grain's diameter: they fall"),
      quantity("boxes", .3, 0, 1, "1", "share of boxes among the grains, the others are spheres"),
      count("sides", 4, 4, 24, "of the bin"),
      quantity("radius", .05, 1e-3, 10, "m", "of the largest grain"),
      quantity("mu", .5, .1, 1, "1", "friction of grains and walls"),
      count("seed", 1, 1, 1000000, "of sizes and places")};
  silo.build = buildSilo;
  silo.probes = siloProbes;
  silo.claims = siloClaims;
  silo.camera = overview;
  silo.steps = kSteps;
  silo.iterations = 10;
  silo.tags = {"friction"};

  Spec coarse = variant(silo, "silo-4",
                        "The silo at 4 iterations: the walls bear grains, and do not push them down.", {});
  coarse.iterations = 4;
  coarse.claims = [](const Arguments&) {
    return std::vector<Claim>{within("wall_ratio", .4, .85, "the walls bear a part of the weight, upwards"),
                              within("floor_ratio", .15, .6, "the floor bears the rest")};
  };
  return {silo, coarse};
}

}  // namespace rubble::scenes
