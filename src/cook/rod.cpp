#include <cmath>
#include <numbers>

#include <rubble/error.h>
#include <rubble/rod.h>

#include "cook/checks.h"

namespace rubble {

namespace {

using namespace checks;

void check(const Scene& scene, const RodDef& rod, const Path& path) {
  if (rod.points.size() < 2) throw Error(path + ".points", "two at least", std::to_string(rod.points.size()));
  for (std::size_t i = 0; i < rod.points.size(); ++i) {
    const Vec3& x = rod.points[i];
    const Path list = path + ".points", here = list[i];
    finite(x, here);
    if (i > 0 && !(length(x - rod.points[i - 1]) > 0))
      throw Error(here, "another place than the point before", "the same");
  }
  positive(rod.radius, path + ".radius");
  positive(rod.youngsModulus, path + ".youngsModulus");
  positive(rod.density, path + ".density");
  if (!(rod.poissonRatio > -1 && rod.poissonRatio <= .5))
    throw Error(path + ".poissonRatio", "a number above -1 and up to .5", std::to_string(rod.poissonRatio));
  notNegative(rod.viscosity, path + ".viscosity");
  for (const auto& [end, name] : {std::pair{rod.start, ".start"}, {rod.end, ".end"}})
    if (end && (*end < kWorld || *end >= static_cast<int>(scene.bodies.size())))
      throw Error(path + name,
                  "the index of one of " + std::to_string(scene.bodies.size()) + " bodies, or kWorld",
                  std::to_string(*end));
}

/// Stiffnesses of a segment of length 1 m.
struct Section {
  double stretch, shear, twist, bend;  ///< [N], [N], [N m2], [N m2]

  explicit Section(const RodDef& rod) {
    const double area = std::numbers::pi * rod.radius * rod.radius,
                 second = area * rod.radius * rod.radius / 4, nu = rod.poissonRatio;
    const double shearModulus = rod.youngsModulus / (2 * (1 + nu)), kappa = 6 * (1 + nu) / (7 + 6 * nu);
    stretch = rod.youngsModulus * area, shear = kappa * shearModulus * area;
    twist = 2 * shearModulus * second, bend = rod.youngsModulus * second;
  }
};

}  // namespace

RodParts addRod(Scene& scene, const RodDef& rod, const Path& path) {
  check(scene, rod, path);
  const Section section(rod);
  RodParts out{static_cast<int>(scene.bodies.size()), static_cast<int>(rod.points.size()) - 1,
               static_cast<int>(scene.joints.size()), 0};
  const auto pieceOf = [&](int i) {
    return rod.points[static_cast<std::size_t>(i) + 1] - rod.points[static_cast<std::size_t>(i)];
  };
  for (int i = 0; i < out.bodies; ++i) {
    const Vec3 piece = pieceOf(i);
    const double size = length(piece), area = std::numbers::pi * rod.radius * rod.radius;
    BodyDef body;
    if (!rod.name.empty()) body.name = rod.name + std::to_string(i);
    body.shape = Shape::capsule(rod.radius, size / 2);
    body.material = rod.material;
    body.density = rod.density;
    // mass of the cylinder: the caps of neighboring capsules overlap
    const double mass = rod.density * area * size,
                 across = mass * (rod.radius * rod.radius / 4 + size * size / 12);
    body.mass = mass;
    body.inertia = Vec3{across, across, mass * rod.radius * rod.radius / 2};
    body.position = rod.points[static_cast<std::size_t>(i)] + piece / 2;
    // z of the capsule is x of the frame along the segment
    body.orientation = normalize(frameAlong(piece) *
                                 Quat{std::numbers::sqrt2 / 2, 0, std::numbers::sqrt2 / 2, 0});
    scene.bodies.push_back(body);
  }
  const auto join = [&](int a, int b, const Vec3& at, const Vec3& along, double l) {
    JointDef joint = jointAt(scene, JointType::SixDof, a, b, at, frameAlong(along));
    const double stiffness[6] = {section.stretch, section.shear, section.shear,
                                 section.twist,   section.bend,  section.bend};
    for (std::size_t k = 0; k < 6; ++k) {
      JointAxis& axis = joint.axes[k];
      axis.min = axis.max = 0;
      axis.limitStiffness = stiffness[k] / l;
      axis.limitDamping = axis.limitStiffness * rod.viscosity / rod.youngsModulus;
    }
    joint.breakForce = rod.breakForce, joint.breakTorque = rod.breakTorque;
    scene.joints.push_back(joint);
    ++out.joints;
  };
  const int last = out.bodies - 1;
  if (rod.start) join(out.firstBody, *rod.start, rod.points.front(), pieceOf(0), length(pieceOf(0)) / 2);
  for (int i = 0; i < last; ++i) {
    const Vec3 before = pieceOf(i), after = pieceOf(i + 1);
    join(out.firstBody + i + 1, out.firstBody + i, rod.points[static_cast<std::size_t>(i) + 1],
         normalize(before) + normalize(after), (length(before) + length(after)) / 2);
  }
  if (rod.end)
    join(out.firstBody + last, *rod.end, rod.points.back(), pieceOf(last), length(pieceOf(last)) / 2);
  return out;
}

}  // namespace rubble
