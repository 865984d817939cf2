/// Fast tops on ball joints, against the steady precession of a heavy symmetric top.
#include <cmath>
#include <numbers>

#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"

namespace rubble::scenes {
namespace {

constexpr double kG = 9.81, kPi = std::numbers::pi;
constexpr Vec3 kUp{0, 0, 1};

/// A body whose axis of symmetry is its z, over a point of it.
struct TopShape {
  const char* name;
  Shape shape;
  double lever;   ///< from the point to the center of mass [m]
  double center;  ///< z of the center of mass in the frame of the shape [m]
};
const TopShape kTops[] = {{"disc", Shape::cylinder(.3, .02), .05, 0},
                          {"box", Shape::box({.25, .25, .04}), .05, 0},
                          {"cone", Shape::cone(.4, .1), .06, -.05}};

/// Steady precession of a top of 1 kg with spin w about its axis: the slow root of I1 p^2 cos(a) - I3 w p +
/// m g l = 0, with I1 about the point. [rad/s]
double precession(const TopShape& top, double inclination, double spin) {
  MassProperties mass = massProperties(top.shape, 1000);
  const double load = kG * top.lever, momentum = mass.inertia.z / mass.mass * spin;
  const double across = (mass.inertia.x / mass.mass + top.lever * top.lever) * portable::cos(inclination);
  return 2 * load / (momentum + std::sqrt(momentum * momentum - 4 * across * load));
}

Scene buildTops(const Arguments& arguments) {
  const double inclination = value(arguments, "inclination") * kPi / 180, spin = value(arguments, "spin");
  Scene scene = emptyScene(kUp, kG);
  for (int i = 0; i < 3; ++i) {
    const TopShape& top = kTops[i];
    const Vec3 pivot{1.5 * i, 0, .6};
    BodyDef body;
    body.shape = top.shape;
    body.mass = 1;
    body.orientation = fromAxisAngle(Vec3{0, 1, 0}, inclination);
    const Vec3 axis = rotate(body.orientation, kUp);
    body.position = pivot + (top.lever - top.center) * axis;
    const double rate = precession(top, inclination, spin);
    body.angularVelocity = rate * kUp + (spin - rate * portable::cos(inclination)) * axis;
    body.velocity = cross(body.angularVelocity, top.lever * axis);
    put(scene, body, top.name);
    join(scene, JointType::Ball, i, kWorld, pivot);
  }
  return scene;
}

Probes topProbes(const Arguments& arguments, const Scene&) {
  const double inclination = value(arguments, "inclination") * kPi / 180, spin = value(arguments, "spin");
  Probes probes;
  for (const TopShape& top : kTops) {
    const double rate = precession(top, inclination, spin);
    double angle = 0, last = 0;
    probes.push_back(everyStep([=](const World& world, const StepReport&, Metrics& metrics) mutable {
      const Vec3 axis = rotate(bodyOf(world, top.name).orientation, kUp);
      raise(metrics, "inclination_error_deg", std::fabs(portable::acos(axis.z) - inclination) * 180 / kPi);
      const double now = portable::atan2(axis.y, axis.x);
      angle += std::remainder(now - last, 2 * kPi), last = now;
      metrics[std::string(top.name) + "_precession_ratio"] = angle / (rate * world.time());
    }));
  }
  return probes;
}

}  // namespace

std::vector<Spec> topSpecs() {
  const char* const why = "I1 p^2 cos(a) - I3 w p + m g l = 0";
  return {jointSpec(
      "top", "A disc, a box and a cone spin about inclined axes on ball joints.", buildTops, topProbes,
      {atMost("inclination_error_deg", 1, "fast tops do not fall"),
       within("disc_precession_ratio", .99, 1.01, why), within("box_precession_ratio", .99, 1.01, why),
       within("cone_precession_ratio", .99, 1.01, why)},
      600,
      {quantity("inclination", 60, 20, 120, "deg", "of the axes, from the vertical"),
       quantity("spin", 40, 40, 100, "rad/s", "about them")})};
}

}  // namespace rubble::scenes
