/// Small rigid bodies on coarse cloth: they touch the sheet between its vertices.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "soft_probes.h"

namespace rubble::scenes {
namespace {

constexpr double kSheetSide = 2, kBodySize = .05;  // [m]

Shape smallShape(int kind) {
  constexpr double s = kBodySize;
  switch (kind) {
    case 1:
      return Shape::hull({{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}});
    case 2:
      return Shape::sphere(s);
    case 3:
      return Shape::capsule(.6 * s, s);
    case 4:
      return Shape::cylinder(s, .6 * s);
    case 5:
      return Shape::cone(s, s);
    default:
      return Shape::box({s, s, s});
  }
}

/// A rotation for each number, spread over all of them.
Quat someTurn(int i) {
  const double a = 2.4 * i, b = 1.7 * i + .4, c = .37 * i;
  return normalize(Quat{portable::cos(c), portable::sin(c) * portable::cos(a),
                        portable::sin(c) * portable::sin(a) * portable::cos(b),
                        portable::sin(c) * portable::sin(a) * portable::sin(b)});
}

Scene buildDents(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, -3));
  const int side = whole(arguments, "bodies"), cells = whole(arguments, "cells");
  for (int i = 0; i < side * side; ++i) {
    BodyDef body;
    body.shape = smallShape(i % 6);
    body.density = value(arguments, "density");
    body.material.staticFriction = body.material.dynamicFriction = .6;
    const double pitch = .75 * kSheetSide / side;
    body.position = {pitch * (i % side - .5 * (side - 1)), pitch * (i / side - .5 * (side - 1)),
                     .2 + .1 * (i % 3)};
    body.orientation = someTurn(i);
    scene.bodies.push_back(body);
  }
  scene.deformables.push_back(heldSheet(kSheetSide, 0, cells));
  return scene;
}

Spec dentsSpec() {
  Spec spec;
  spec.name = "cloth-dents";
  spec.doc =
      "Boxes, tetrahedra, balls, capsules, cylinders and cones of 10 cm fall on a sheet whose cells are "
      "three times as wide.";
  spec.arguments = {count("bodies", 6, 1, 30, "bodies along a side"),
                    count("cells", 6, 1, 100, "cells of the sheet along a side"),
                    quantity("density", 1000, 10, 10000, "kg/m3", "of the bodies")};
  spec.build = buildDents;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(peakProbe(0, {{"below_peak", [](const World& w) { return bodiesBelow(w, 0); }}}));
    probes.push_back(endProbe({{"stretch", [](const World& w) { return largestStretch(w, 0); }},
                               {"sag_m", [](const World& w) { return -lowestVertex(w); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{
        atMost("below_peak", 0, "no body ever slips through a cell"),
        atMost("penetration_max_m", 2e-3, "none sinks in"), atLeast("sag_m", .01, "the sheet carries them"),
        atMost("stretch", 1.25, "and stretches little"), atMost("quarantined", 0, "finite throughout")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{1.5, -2.2, 1.5}, {0, 0, -.1}}; };
  spec.steps = 600;
  spec.iterations = 10;
  spec.testSteps = 240;
  spec.tags = {"cloth", "contact"};
  return spec;
}

}  // namespace

std::vector<Spec> softDentSpecs() { return {dentsSpec()}; }

}  // namespace rubble::scenes
