/// Solids of tetrahedra: a hanging beam, a twisted one, squishy balls in a bin, a box that starts as a plane.
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "soft_probes.h"

namespace rubble::scenes {
namespace {

// Beam: clamped at x = 0, 1 m long, 0.1 m square. Euler and Bernoulli: tip q L^4 / (8 E I).

constexpr double kBeamSide = .1;

Scene buildBeam(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, -1));
  TetSolidDef beam = tetBox(
      {0, -kBeamSide / 2, -kBeamSide / 2}, {1, kBeamSide, kBeamSide},
      {whole(arguments, "cells_along"), whole(arguments, "cells_wide"), whole(arguments, "cells_high")});
  beam.name = "beam";
  beam.youngsModulus = value(arguments, "youngs_modulus");
  beam.poissonRatio = 0;
  beam.fixed = verticesWhere(beam, [](const Vec3& x) { return x.x == 0; });
  scene.deformables.push_back(beam);
  return scene;
}

Spec beamSpec() {
  Spec spec;
  spec.name = "soft-beam";
  spec.doc = "A clamped beam of tetrahedra bends under its own weight: against Euler and Bernoulli.";
  spec.arguments = {count("cells_along", 50, 2, 400, "cells along the beam"),
                    count("cells_wide", 1, 1, 40, "cells across it, level"),
                    count("cells_high", 8, 1, 40, "cells across it, upright: the way it bends"),
                    quantity("youngs_modulus", 2e7, 1e4, 1e10, "Pa", "Young's modulus")};
  spec.build = buildBeam;
  spec.probes = [](const Arguments& arguments, const Scene& scene) {
    const double inertia = portable::pow(kBeamSide, 4) / 12, load = 1000 * 10 * kBeamSide * kBeamSide;
    const double exact = load / (8 * value(arguments, "youngs_modulus") * inertia);
    const std::vector<int> tip = verticesWhere(common(scene.deformables[0]),
                                               [](const Vec3& x) { return x.x > .999; });
    Probes probes;
    probes.push_back(meanProbe(
        2, {{"tip_over_beam_theory", [=](const World& w) { return -meanOf(w, 0, tip).z / exact; }}}));
    probes.push_back(endProbe({{"crushed_cells", [](const World& w) { return crushedCells(w, 0); }}}));
    return probes;
  };
  spec.claims = [](const Arguments& arguments) {
    // what linear tetrahedra lock by goes with 1 / cells (docs/research/deformables.md)
    const double cell = 1 / value(arguments, "cells_high");
    return std::vector<Claim>{within("tip_over_beam_theory", 1 - .8 * cell, 1.02 - .3 * cell,
                                     "the sag of beam theory, but for the stiffness of linear tetrahedra"),
                              atMost("crushed_cells", 0, "no cell has lost half its volume")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.5, -2.2, .5}, {.5, 0, -.1}}; };
  spec.steps = 240;
  spec.iterations = 20;
  spec.tags = {"soft"};
  return spec;
}

// Twist: a bar whose far end starts turned by half a turn.

Scene buildTwist(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.gravity = {};
  scene.bodies.push_back(ground(kUpZ, -1));
  TetSolidDef bar = tetBox({0, -.1, -.1}, {1, .2, .2}, {whole(arguments, "cells_along"), 3, 3});
  bar.name = "bar";
  bar.youngsModulus = 1e6;
  bar.viscosity = 5e3;
  for (const Vec3& x : bar.vertices) {
    const double angle = value(arguments, "turns") * 2 * std::numbers::pi * x.x;
    bar.start.push_back(rotate(fromAxisAngle(Vec3{1, 0, 0}, angle), x));
  }
  bar.fixed = verticesWhere(bar, [](const Vec3& x) { return x.x == 0; });
  scene.deformables.push_back(bar);
  return scene;
}

Spec twistSpec() {
  Spec spec;
  spec.name = "soft-twist";
  spec.doc = "A bar of tetrahedra, clamped at one end and twisted, is let go: it comes back to its shape.";
  spec.arguments = {count("cells_along", 15, 2, 200, "cells along the bar"),
                    quantity("turns", .5, 0, 4, "1", "turns of the free end")};
  spec.build = buildTwist;
  spec.probes = [](const Arguments&, const Scene& scene) {
    const std::vector<Vec3> rest = common(scene.deformables[0]).vertices;
    Probes probes;
    probes.push_back(endProbe({{"shape_error_m",
                                [rest](const World& w) {
                                  double worst = 0;
                                  const std::vector<Vec3> x = w.positions(w.deformableAt(0));
                                  for (std::size_t i = 0; i < x.size(); ++i)
                                    worst = std::max(worst, length(x[i] - rest[i]));
                                  return worst;
                                }},
                               {"crushed_cells", [](const World& w) { return crushedCells(w, 0); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atMost("shape_error_m", .01, "back to its shape at rest"),
                              atMost("crushed_cells", 0, "no cell has lost half its volume"),
                              atMost("quarantined", 0, "finite throughout")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.5, -2, .8}, {.5, 0, 0}}; };
  spec.steps = 300;
  spec.iterations = 10;
  spec.tags = {"soft"};
  return spec;
}

// Balls in a bin.

Scene buildBalls(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  const int side = whole(arguments, "side"), layers = whole(arguments, "layers");
  const double radius = .25, pitch = .62, half = pitch * side / 2 + .05;
  for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}}) {
    BodyDef wall = block({.1, .1, 2}, n * (half + .1) + Vec3{0, 0, 2}, 1000);
    wall.shape.halfExtents = std::fabs(n.x) > 0 ? Vec3{.1, half + .2, 2} : Vec3{half + .2, .1, 2};
    wall.motion = Motion::Static;
    scene.bodies.push_back(wall);
  }
  for (int z = 0; z < layers; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        TetSolidDef ball = tetBall({pitch * (x - .5 * (side - 1)) + .02 * (z % 2),
                                    pitch * (y - .5 * (side - 1)), .35 + 1.1 * pitch * z},
                                   radius, whole(arguments, "cells"));
        ball.youngsModulus = 3e4;
        ball.density = 500;
        ball.viscosity = 100;
        ball.contactRadius = radius / whole(arguments, "cells");
        ball.collideVertices = true;
        ball.collideSurface = false;
        scene.deformables.push_back(ball);
      }
  return scene;
}

Spec ballsSpec() {
  Spec spec;
  spec.name = "soft-balls";
  spec.doc =
      "Squishy balls dropped into a bin, layer on layer; they collide as the spheres of their vertices.";
  spec.arguments = {count("side", 3, 1, 40, "balls along a side of the bin"),
                    count("layers", 3, 1, 40, "layers of balls"),
                    count("cells", 4, 2, 40, "cells through a ball")};
  spec.build = buildBalls;
  spec.probes = [](const Arguments&, const Scene& scene) {
    const int balls = int(scene.deformables.size());
    double cells = 0;
    for (const Deformable& d : scene.deformables) cells += double(std::get<TetSolidDef>(d).tetrahedra.size());
    const auto cellsOf = [balls](const World& w, double share) {
      double sum = 0;
      for (int i = 0; i < balls; ++i) sum += cellsBelow(w, i, share);
      return sum;
    };
    Probes probes;
    probes.push_back(
        endProbe({{"lowest_m", lowestVertex},
                  {"lift_over_weight",
                   [](const World& w) {
                     double mass = 0;
                     for (const DeformableId id : w.deformables())
                       for (const double m : w.masses(id)) mass += m;
                     return -liftOfVertices(w) / (mass * length(w.gravity()));
                   }},
                  {"inverted_cells", [cellsOf](const World& w) { return cellsOf(w, 0); }},
                  {"crushed_ratio", [cellsOf, cells](const World& w) { return cellsOf(w, .5) / cells; }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atLeast("lowest_m", -.01, "on the floor, not in it"),
                              atMost("inverted_cells", 0, "no cell is inverted"),
                              atMost("crushed_ratio", .001, "hardly one has half its volume"),
                              within("lift_over_weight", .97, 1.03, "the bin carries their weight"),
                              atMost("kinetic_energy_j", 1, "they come to rest")};
  };
  spec.camera = [](const Arguments& arguments, const Scene&) {
    const double size = .6 * whole(arguments, "side");
    // over the rim of the bin, whose walls are 4 m high
    return Camera{{.2 * size, -.4 * size, 5 + 1.2 * size}, {0, 0, .2}};
  };
  spec.steps = 300;
  spec.iterations = 10;
  spec.testArguments = {{"side", 2}, {"layers", 2}, {"cells", 2}};
  spec.tags = {"soft"};
  return spec;
}

// Flat: a box whose vertices all start in one plane.

Scene buildFlat(const Arguments&) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.gravity = {};
  scene.bodies.push_back(ground(kUpZ, -5));
  TetSolidDef box = tetBox({-.25, -.25, -.25}, {.5, .5, .5}, {4, 4, 4});
  box.name = "box";
  for (const Vec3& x : box.vertices) box.start.push_back({x.x, x.y, 0});
  scene.deformables.push_back(box);
  return scene;
}

Spec flatSpec() {
  Spec spec;
  spec.name = "soft-flat";
  spec.doc =
      "A solid whose vertices all start in one plane, every cell without volume: it comes back to its shape.";
  spec.build = buildFlat;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(endProbe({{"crushed_cells", [](const World& w) { return crushedCells(w, 0); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atMost("crushed_cells", 0, "every cell has its volume again"),
                              atMost("quarantined", 0, "finite throughout")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{1.2, -1.6, 1}, {0, 0, 0}}; };
  spec.steps = 240;
  spec.iterations = 10;
  spec.tags = {"soft"};
  return spec;
}

}  // namespace

std::vector<Spec> softSolidSpecs() { return {beamSpec(), twistSpec(), ballsSpec(), flatSpec()}; }

}  // namespace rubble::scenes
