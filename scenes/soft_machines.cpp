/// Deformable objects in machines and among bodies: a falling figure, ragdolls on a trampoline, a car on
/// soft wheels, a gripper with a soft ball.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <rubble/mesh.h>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "ragdoll.h"
#include "soft_probes.h"

namespace rubble::scenes {
namespace {

/// The surface where a function is zero, negative inside: each cube of a grid is six tetrahedra about its
/// diagonal, each cut by a plane.
TriangleMesh surfaceOf(const std::function<double(const Vec3&)>& distance, const Vec3& low, const Vec3& high,
                       double spacing) {
  std::array<int, 3> count;
  for (int axis = 0; axis < 3; ++axis)
    count[std::size_t(axis)] = int(std::ceil((high[axis] - low[axis]) / spacing)) + 1;
  const auto place = [&](int p) {
    return low + spacing * Vec3{double(p % count[0]), double(p / count[0] % count[1]),
                                double(p / count[0] / count[1])};
  };
  std::vector<double> value;
  for (int p = 0; p < count[0] * count[1] * count[2]; ++p) value.push_back(distance(place(p)));
  TriangleMesh mesh;
  std::map<std::pair<int, int>, int> cuts;
  const auto cut = [&](int in, int out) {
    const auto [entry, isNew] = cuts.emplace(std::pair{in, out}, int(mesh.vertices.size()));
    const double a = value[std::size_t(in)], b = value[std::size_t(out)];
    // away from the corners, so that no triangle is degenerate
    const double share = std::clamp(a / (a - b), .01, .99);
    if (isNew) mesh.vertices.push_back(place(in) + share * (place(out) - place(in)));
    return entry->second;
  };
  const auto emit = [&](int a, int b, int c, const Vec3& inside) {
    const auto at = [&](int v) { return mesh.vertices[std::size_t(v)]; };
    if (dot(cross(at(b) - at(a), at(c) - at(a)), inside - at(a)) > 0) std::swap(b, c);
    mesh.triangles.push_back({a, b, c});
  };
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const std::array<int, 3> step{1, count[0], count[0] * count[1]};
  for (int k = 0; k + 1 < count[2]; ++k)
    for (int j = 0; j + 1 < count[1]; ++j)
      for (int i = 0; i + 1 < count[0]; ++i)
        for (const auto& order : kOrders) {
          int p[4] = {(k * count[1] + j) * count[0] + i};
          for (int n = 0; n < 3; ++n) p[n + 1] = p[n] + step[std::size_t(order[n])];
          std::vector<int> in, out;
          for (const int corner : p) (value[std::size_t(corner)] < 0 ? in : out).push_back(corner);
          if (in.empty() || out.empty()) continue;
          if (in.size() == 2) {
            const int a = cut(in[0], out[0]), b = cut(in[0], out[1]), c = cut(in[1], out[1]),
                      d = cut(in[1], out[0]);
            emit(a, b, c, place(in[0])), emit(a, c, d, place(in[0]));
          } else {
            const bool one = in.size() == 1;
            const auto corner = [&](std::size_t n) { return one ? cut(in[0], out[n]) : cut(in[n], out[0]); };
            emit(corner(0), corner(1), corner(2), place(in[0]));
          }
        }
  return mesh;
}

/// Tetrahedra inside of that surface.
TetSolidDef softFromFunction(const std::function<double(const Vec3&)>& distance, const Vec3& low,
                             const Vec3& high, double cell) {
  return tetSolidFromSurface(surfaceOf(distance, low, high, cell / 2), cell);
}

double crushedInAll(const World& world) {
  double sum = 0;
  for (int i = 0; i < int(world.deformables().size()); ++i) sum += crushedCells(world, i);
  return sum;
}

// A figure with a trunk, a head, ears, limbs and a tail.

/// From a point to a piece of a limb, a radius at each end.
double limb(const Vec3& x, const Vec3& a, const Vec3& b, double ra, double rb) {
  const Vec3 along = b - a;
  const double t = std::clamp(dot(x - a, along) / dot(along, along), 0., 1.);
  return length(x - a - t * along) - (ra + t * (rb - ra));
}
/// The union of two solids, rounded where they meet [m].
double blend(double a, double b, double rounding) {
  const double h = std::max(rounding - std::fabs(a - b), 0.) / rounding;
  return std::min(a, b) - h * h * rounding / 4;
}
double figure(const Vec3& p) {
  double d = limb(p, {0, 0, .42}, {0, 0, .72}, .17, .14);
  const auto add = [&](const Vec3& a, const Vec3& b, double ra, double rb) {
    d = blend(d, limb(p, a, b, ra, rb), .06);
  };
  add({.02, 0, .95}, {.1, 0, .93}, .12, .07);
  add({-.1, 0, .34}, {-.38, 0, .16}, .08, .035);
  for (const double s : {-1., 1.}) {
    add({0, s * .06, 1.03}, {-.02, s * .12, 1.16}, .035, .03);
    add({0, s * .14, .76}, {.04, s * .33, .62}, .07, .055);
    add({.04, s * .33, .62}, {.18, s * .38, .6}, .055, .05);
    add({0, s * .1, .36}, {.03, s * .16, .12}, .095, .065);
    add({.03, s * .16, .08}, {.14, s * .17, .06}, .06, .055);
  }
  return d;
}

Scene buildFigure(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  BodyDef log = block({.1, .1, .1}, {0, 0, .12}, 1000);
  log.shape = Shape::capsule(.12, .6);
  log.orientation = {std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2, 0, 0};
  log.motion = Motion::Static;
  scene.bodies.push_back(log);
  TetSolidDef body = softFromFunction(figure, {-.6, -.6, -.15}, {.4, .6, 1.35}, value(arguments, "cell"));
  const Quat turn = fromAxisAngle({0, 1, 0}, 1.2);
  for (Vec3& x : body.vertices) x = Vec3{-.4, 0, .8} + rotate(turn, x);
  body.name = "figure";
  body.youngsModulus = value(arguments, "youngs_modulus");
  body.density = 500;
  body.viscosity = 100;
  scene.deformables.push_back(body);
  return scene;
}

Spec figureSpec() {
  Spec spec;
  spec.name = "soft-figure";
  spec.doc = "A figure with limbs, ears and a tail, filled with tetrahedra, falls over a log.";
  spec.arguments = {quantity("cell", .06, .01, .12, "m", "width of the cells"),
                    quantity("youngs_modulus", 1e5, 1e3, 1e8, "Pa", "Young's modulus")};
  spec.build = buildFigure;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(
        endProbe({{"crushed_cells", crushedInAll}, {"lowest_m", lowestVertex}, {"motion_j", motion}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atMost("crushed_cells", 0, "no cell is crushed"),
                              atLeast("lowest_m", -.005, "it lies on the ground, not in it"),
                              atMost("motion_j", .5, "it comes to rest"),
                              atMost("quarantined", 0, "finite throughout")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{2, -2.6, 1.5}, {.1, 0, .35}}; };
  spec.travels = true;
  spec.steps = 360;
  spec.iterations = 10;
  spec.testArguments = {{"cell", .11}};
  spec.testSteps = 240;
  spec.tags = {"soft"};
  return spec;
}

// Ragdolls on a trampoline.

constexpr double kBed = 4, kBedHeight = 1.5;  // [m]

Scene buildJumpers(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ, -2));
  const int ragdolls = whole(arguments, "men");
  for (int i = 0; i < ragdolls; ++i) {
    const double angle = 2 * std::numbers::pi * i / ragdolls, far = ragdolls > 1 ? .9 : 0;
    addRagdoll(scene, {far * portable::cos(angle), far * portable::sin(angle), kBedHeight + .5 + .3 * i},
               1.3 * i, "ragdoll" + std::to_string(i));
  }
  const int cells = whole(arguments, "cells");
  ClothDef bed = heldSheet(kBed, kBedHeight, cells);
  bed.name = "bed";
  bed.thickness = 5e-3;
  bed.youngsModulus = 5e6;
  scene.deformables.push_back(bed);
  return scene;
}

Spec jumpersSpec() {
  Spec spec;
  spec.name = "trampoline-men";
  spec.doc = "Ragdolls of 70 kg fall on a trampoline of 4 m.";
  spec.arguments = {count("men", 3, 1, 6, "ragdolls"),
                    count("cells", 24, 8, 200, "cells along an edge of the bed")};
  spec.build = buildJumpers;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(
        peakProbe(0, {{"below_peak", [](const World& w) { return bodiesBelow(w, 0); }},
                      {"sag_peak_m", [](const World& w) { return kBedHeight - lowestVertex(w); }}}));
    probes.push_back(endProbe({{"stretch", [](const World& w) { return largestStretch(w, 0); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atMost("below_peak", 0, "no limb ever goes through the bed"),
                              within("sag_peak_m", .2, 1.4, "it gives way, and holds"),
                              atMost("stretch", 1.3, "and stretches little at rest"),
                              atMost("joint_gap_max_m", .01, "joints are closed at the end"),
                              atMost("quarantined", 0, "finite throughout")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{3.6, -4.8, 4}, {0, 0, 1.3}}; };
  spec.travels = true;
  spec.steps = 480;
  spec.iterations = 10;
  spec.testArguments = {{"men", 1}, {"cells", 16}};
  spec.testSteps = 180;
  spec.tags = {"cloth", "joint"};
  return spec;
}

// A car on soft wheels.

constexpr double kTyre = .2, kTube = .1, kHub = .17, kChassisMass = 40, kAxleSpeed = 8;  // [m], [kg], [rad/s]

Scene buildCar(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, 0, 1));
  const double height = kTyre + kTube + .01;
  BodyDef chassis = block({.6, .2, .08}, {0, 0, height + .05}, 1000);
  chassis.name = "chassis";
  chassis.mass = kChassisMass;
  scene.bodies.push_back(chassis);
  const auto ring = [](const Vec3& x) {
    return portable::hypot(portable::hypot(x.x, x.z) - kTyre, x.y) - kTube;
  };
  const double far = kTyre + kTube + .05;
  const TetSolidDef tyre = softFromFunction(ring, {-far, -kTube - .05, -far}, {far, kTube + .05, far},
                                            value(arguments, "cell"));
  int number = 0;
  for (const double x : {-.5, .5})
    for (const double y : {-.4, .4}) {
      const Vec3 center{x, y, height};
      BodyDef hub = block({.1, .1, .1}, center, 1000);
      hub.name = "hub" + std::to_string(number);
      hub.shape = Shape::cylinder(kHub, .06);
      hub.mass = 2;
      hub.orientation = {std::numbers::sqrt2 / 2, -std::numbers::sqrt2 / 2, 0, 0};
      // the tyre is built onto it
      hub.filter.mask = 0;
      const int body = int(scene.bodies.size());
      scene.bodies.push_back(hub);
      JointDef axle = jointAt(scene, JointType::Hinge, body, 1, center, frameAlong({0, 1, 0}));
      axle.name = "axle" + std::to_string(number);
      if (x < 0) {
        axle.axes[0].targetSpeed = kAxleSpeed;
        axle.axes[0].driveDamping = kHard;
        axle.axes[0].maxDriveForce = 40;
      }
      scene.joints.push_back(axle);
      TetSolidDef own = tyre;
      own.name = "tyre" + std::to_string(number);
      own.youngsModulus = value(arguments, "youngs_modulus");
      own.density = 200;
      own.viscosity = 200;
      own.material.staticFriction = own.material.dynamicFriction = 1;
      for (std::size_t v = 0; v < own.vertices.size(); ++v) {
        const bool inner = portable::hypot(own.vertices[v].x, own.vertices[v].z) < kHub;
        own.vertices[v] += center;
        if (!inner) continue;
        AttachmentDef hold;
        hold.object = int(scene.deformables.size());
        hold.vertices = {int(v)};
        hold.body = body;
        scene.attachments.push_back(hold);
      }
      scene.deformables.push_back(own);
      ++number;
    }
  // sleepers to drive over
  for (int i = 0; i < 5; ++i) {
    BodyDef sleeper = block({.04, 1, .03}, {2 + .6 * i, 0, .03}, 1000);
    sleeper.motion = Motion::Static;
    sleeper.material.staticFriction = sleeper.material.dynamicFriction = 1;
    scene.bodies.push_back(sleeper);
  }
  return scene;
}

Spec carSpec() {
  Spec spec;
  spec.name = "soft-wheels";
  spec.doc = "A car on four soft tyres, driven by its rear wheels, over sleepers.";
  spec.arguments = {quantity("cell", .07, .02, .1, "m", "width of the cells of the tyres"),
                    quantity("youngs_modulus", 2e5, 1e4, 1e8, "Pa", "of the tyres")};
  spec.build = buildCar;
  spec.probes = [](const Arguments&, const Scene&) {
    const auto chassis = [](const World& w) { return w.state(w.findBody("chassis")); };
    Probes probes;
    probes.push_back(
        endProbe({{"travel_m", [=](const World& w) { return chassis(w).position.x; }},
                  {"side_m", [=](const World& w) { return std::fabs(chassis(w).position.y); }},
                  {"speed_ratio",
                   [=](const World& w) { return chassis(w).velocity.x / (kAxleSpeed * (kTyre + kTube)); }},
                  {"crushed_cells", crushedInAll}}));
    probes.push_back(peakProbe(
        .5, {{"sag_peak_m", [=](const World& w) { return kTyre + kTube + .06 - chassis(w).position.z; }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atLeast("travel_m", 5, "it drives over the sleepers"),
                              atMost("side_m", 1.2, "nearly straight on"),
                              within("speed_ratio", .8, 1.05, "its tyres roll"),
                              within("sag_peak_m", .002, .12, "they give way, and carry it"),
                              atMost("joint_gap_max_m", .01, "axles and tyres hold"),
                              atMost("quarantined", 0, "finite throughout")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{3.5, -8.5, 4.2}, {3.5, 0, 0}}; };
  spec.travels = true;
  spec.steps = 300;
  spec.iterations = 10;
  spec.testArguments = {{"cell", .1}};
  spec.testSteps = 200;
  spec.tags = {"soft", "joint"};
  return spec;
}

// A gripper that lifts a soft ball.

constexpr double kBallRadius = .1, kLift = .5;  // [m]

Scene buildGripper(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  BodyDef beam = block({.25, .05, .03}, {0, 0, .45}, 1000);
  beam.name = "beam";
  beam.mass = 3;
  scene.bodies.push_back(beam);
  JointDef lift = jointAt(scene, JointType::Slider, 1, kWorld, beam.position, frameAlong(kUpZ));
  lift.name = "lift";
  lift.axes[0].driveStiffness = 2e4, lift.axes[0].driveDamping = 800;
  // the sag of the drive under beam and fingers is not part of the verdict
  scene.joints.push_back(lift);
  for (const double side : {-1., 1.}) {
    BodyDef finger = block({.015, .06, .12}, {side * .2, 0, .13}, 1000);
    finger.mass = 1;
    finger.material.staticFriction = finger.material.dynamicFriction = value(arguments, "friction");
    const int body = int(scene.bodies.size());
    scene.bodies.push_back(finger);
    JointDef slide = jointAt(scene, JointType::Slider, body, 1, finger.position, frameAlong({-side, 0, 0}));
    slide.name = side < 0 ? "left" : "right";
    slide.axes[0].targetPosition = .2;
    slide.axes[0].driveStiffness = 4000, slide.axes[0].driveDamping = 200;
    slide.axes[0].maxDriveForce = value(arguments, "force");
    scene.joints.push_back(slide);
  }
  TetSolidDef ball = tetBall({0, 0, kBallRadius}, kBallRadius, whole(arguments, "cells"));
  ball.name = "ball";
  ball.youngsModulus = 5e4;
  ball.density = 300;
  ball.viscosity = 100;
  ball.material.staticFriction = ball.material.dynamicFriction = value(arguments, "friction");
  scene.deformables.push_back(ball);
  // up in a second, smoothly, from 1.5 s on
  for (int k = 0; k <= 60; ++k) {
    const double s = k / 60.;
    Event event;
    event.step = 90 + k;
    Event::Turn turn;
    turn.joint = "lift";
    turn.targetPosition = kLift * s * s * (3 - 2 * s);
    event.setJoint.push_back(turn);
    scene.events.push_back(event);
  }
  return scene;
}

Vec3 middleOf(const World& world, int object) {
  Vec3 sum;
  const std::vector<Vec3> x = world.positions(world.deformableAt(object));
  for (const Vec3& p : x) sum += p / double(x.size());
  return sum;
}

Spec gripperSpec() {
  Spec spec;
  spec.name = "soft-gripper";
  spec.doc = "Two fingers close on a soft ball and lift it by friction.";
  spec.arguments = {count("cells", 6, 2, 40, "cells through the ball"),
                    quantity("force", 40, 1, 1000, "N", "of each finger"),
                    quantity("friction", .8, 0, 2, "1", "of fingers and ball")};
  spec.build = buildGripper;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(endProbe({{"lifted_m", [](const World& w) { return middleOf(w, 0).z - kBallRadius; }},
                               {"slip_m",
                                [](const World& w) {
                                  const double beam = w.state(w.findBody("beam")).position.z - .45;
                                  return std::fabs(beam - (middleOf(w, 0).z - kBallRadius));
                                }},
                               {"crushed_cells", crushedInAll}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{
        within("lifted_m", .9 * kLift, 1.05 * kLift, "the ball goes up with the gripper"),
        atMost("slip_m", .015, "and does not slip"), atMost("crushed_cells", 0, "no cell is crushed"),
        atMost("kinetic_energy_j", .05, "it hangs still")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{1.3, -1.9, 1}, {0, 0, .5}}; };
  spec.travels = true;
  spec.steps = 300;
  spec.iterations = 10;
  spec.testArguments = {{"cells", 4}};
  spec.tags = {"soft", "joint", "friction"};
  return spec;
}

}  // namespace

std::vector<Spec> softMachineSpecs() { return {figureSpec(), jumpersSpec(), carSpec(), gripperSpec()}; }

}  // namespace rubble::scenes
