/// Granular particles: a column that collapses, and an hourglass.
#include <algorithm>
#include <cmath>

#include "build.h"
#include "families.h"
#include "grains.h"
#include "math/portable.h"
#include "soft_probes.h"

namespace rubble::scenes {

ParticlesDef sandBlock(const Vec3& corner, int nx, int ny, int nz, double radius) {
  ParticlesDef sand;
  sand.name = "sand";
  sand.radius = radius;
  const double pitch = 2.04 * radius;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x)
        sand.vertices.push_back(corner + Vec3{pitch * x + .1 * radius * (z % 3),
                                              pitch * y + .1 * radius * (z % 2), pitch * (z + .5)});
  return sand;
}

namespace {

Scene buildColumn(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  const int side = whole(arguments, "side");
  scene.deformables.push_back(
      sandBlock({}, side, side, whole(arguments, "height"), value(arguments, "radius")));
  return scene;
}

Spec columnSpec() {
  Spec spec;
  spec.name = "sand-column";
  spec.doc = "A column of granular particles without walls collapses to a heap.";
  spec.arguments = {count("side", 8, 1, 200, "particles along an edge"),
                    count("height", 16, 1, 400, "particles along the height"),
                    quantity("radius", .02, 1e-3, 1, "m", "of a particle")};
  spec.build = buildColumn;
  spec.probes = [](const Arguments& arguments, const Scene&) {
    const double radius = value(arguments, "radius");
    Probes probes;
    probes.push_back(endProbe(
        {{"lowest_over_radius", [=](const World& w) { return lowestVertex(w) / radius; }},
         {"penetration_over_radius", [=](const World& w) { return w.quality().penetration.p99 / radius; }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atLeast("lowest_over_radius", .9, "no particle sinks into the ground"),
                              atMost("penetration_over_radius", .1, "particles hardly overlap"),
                              atMost("kinetic_energy_j", .05, "the heap rests")};
  };
  spec.camera = [](const Arguments& arguments, const Scene&) {
    const double size = 4 * value(arguments, "radius") * whole(arguments, "side");
    return Camera{{1.4 * size, -1.6 * size, 1.1 * size}, {.25 * size, .25 * size, .15 * size}};
  };
  spec.travels = true;
  spec.steps = 420;
  spec.iterations = 4;
  spec.tags = {"grains"};
  return spec;
}

// Hourglass: a funnel of four tilted slabs over a closed box; what has run through lies below the neck.

constexpr double kNeck = .13, kSlabTilt = .9;

Scene buildHourglass(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  const double radius = value(arguments, "radius"), neckHeight = .5, slab = .4;
  for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}}) {
    // the lower edge of a slab is at the neck, and it leans outwards; its faces look along the local z
    const Quat turn = fromAxisAngle(Vec3{0, 0, 1}, portable::atan2(n.y, n.x)) *
                      fromAxisAngle(Vec3{0, 1, 0}, -kSlabTilt);
    const double thick = .02;
    BodyDef wall = block({slab, .8, thick},
                         n * kNeck + Vec3{0, 0, neckHeight} + rotate(turn, Vec3{slab, 0, -thick}), 1000);
    wall.motion = Motion::Static;
    wall.orientation = turn;
    scene.bodies.push_back(wall);
  }
  for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}}) {
    BodyDef wall = block(std::fabs(n.x) > 0 ? Vec3{.02, .32, .25} : Vec3{.32, .02, .25},
                         n * .3 + Vec3{0, 0, .25}, 1000);
    wall.motion = Motion::Static;
    scene.bodies.push_back(wall);
  }
  const int side = whole(arguments, "side");
  const double half = 1.02 * radius * side;
  scene.deformables.push_back(sandBlock({-half + radius, -half + radius, neckHeight + .3}, side, side,
                                        whole(arguments, "height"), radius));
  return scene;
}

Spec hourglassSpec() {
  Spec spec;
  spec.name = "hourglass";
  spec.doc = "Granular particles run through the neck of a funnel into a box.";
  spec.arguments = {count("side", 8, 1, 100, "particles along an edge"),
                    count("height", 10, 1, 200, "layers of particles"),
                    quantity("radius", .015, 1e-3, .1, "m", "of a particle")};
  spec.build = buildHourglass;
  spec.probes = [](const Arguments&, const Scene&) {
    const auto share = [](const World& w, auto&& inside) {
      const std::vector<Vec3> x = w.positions(w.deformableAt(0));
      return double(std::count_if(x.begin(), x.end(), inside)) / double(x.size());
    };
    Probes probes;
    probes.push_back(endProbe(
        {{"run_through", [=](const World& w) { return share(w, [](const Vec3& x) { return x.z < .5; }); }},
         {"spilled",
          [=](const World& w) {
            return share(
                w, [](const Vec3& x) { return x.z < .5 && std::max(std::fabs(x.x), std::fabs(x.y)) > .31; });
          }},
         {"lowest_m", lowestVertex}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atLeast("run_through", .9, "the particles run through the neck"),
                              atMost("spilled", 0, "none leaves through a wall"),
                              atLeast("lowest_m", .01, "none sinks into the ground")};
  };
  // into the funnel, whose slabs hide the particles from the side
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.3, -.6, 3}, {0, 0, .4}}; };
  spec.steps = 420;
  spec.iterations = 4;
  spec.tags = {"grains"};
  return spec;
}

}  // namespace

std::vector<Spec> softGrainSpecs() { return {columnSpec(), hourglassSpec()}; }

}  // namespace rubble::scenes
