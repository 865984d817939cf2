#include "convert/urdf_mass.h"

#include <algorithm>
#include <cmath>

#include "convert/geometry.h"

namespace rubble::convert {
namespace {

/// Radius of gyration of balls that stand for links without a size [m].
constexpr double kGyration = 0.02;

std::array<double, 6> ballTensor(double mass) {
  const double i = mass * kGyration * kGyration;
  return {i, i, i, 0, 0, 0};
}

}  // namespace

SolidSums massOfInertial(double mass, const std::array<double, 6>& tensor, const SolidSums& shapes,
                         const Place& place, Report& report) {
  const auto note = [&](const char* why) {
    report.note(Effect::Approximate, place, "inertial.inertia", why);
  };
  const double size = std::max({std::fabs(tensor[0]), std::fabs(tensor[1]), std::fabs(tensor[2])});
  if (!(size > 0)) {
    if (!(shapes.volume > 0)) {
      note("of a link without an inertia: that of a ball");
      return sumsOfTensor(mass, ballTensor(mass));
    }
    note("of a link without an inertia: that of its shapes");
    MassProperties own = principal(shapes);
    own.inertia *= mass / own.mass, own.mass = mass, own.center = {};
    return sumsOf(own);
  }
  // principal() keeps the moments of inertia apart from the mass: of any tensor
  MassProperties own = principal(sumsOfTensor(mass, tensor));
  constexpr double kLeast = 1e-6, kRoundOff = 1 + 1e-9;
  Vec3& i = own.inertia;
  const Vec3 before = i;
  for (int k = 0; k < 3; ++k) i[k] = std::max(i[k], kLeast * size);
  const int most = i.x >= i.y && i.x >= i.z ? 0 : i.y >= i.z ? 1 : 2;
  const double missing = i[most] - i[(most + 1) % 3] - i[(most + 2) % 3];
  if (missing > 0 && 2 * i[most] > (i.x + i.y + i.z) * kRoundOff)
    for (int k = 1; k < 3; ++k) i[(most + k) % 3] += missing / 2;
  if (i == before) return sumsOfTensor(mass, tensor);
  note("no solid has it: its smaller principal moments are raised until one has");
  return sumsOf(own);
}

void giveMissingMasses(Model& model, Report& report) {
  std::vector<double> mass(model.links.size(), 0);
  std::vector<std::size_t> root(model.links.size(), 0);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    root[i] = link.moves() || link.parent < 0 ? i : root[static_cast<std::size_t>(link.parent)];
    mass[root[i]] += link.mass.volume;
    sum += link.mass.volume, count += link.mass.volume > 0;
  }
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    Link& link = model.links[i];
    if (!link.moves() || mass[i] > 0) continue;
    const double own = count > 0 ? 0.01 * sum / count : 0.01;
    link.mass = sumsOfTensor(own, ballTensor(own));
    report.note(Effect::Approximate, link.place, "link" + inQuotes(link.name),
                "it moves and has no mass: a ball of a hundredth of the mean mass of the others");
  }
}

}  // namespace rubble::convert
