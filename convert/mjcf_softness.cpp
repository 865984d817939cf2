/// solref and solimp. MuJoCo holds a constraint by the acceleration a = -b v - k d r of its error r, with
/// R f = a - (acceleration by f and all else), R = (1 - d) / (d m). At rest f = m k d^2 / (1 - d) r: that is
/// the stiffness here. The damping ratio is that of the model. Constraints as hard as MuJoCo's default ones,
/// or harder, are hard.
#include <algorithm>
#include <cmath>

#include "convert/mjcf_reader.h"

namespace rubble::convert {
namespace {

/// Time constant [s] and damping ratio, and the largest impedance, of a model that does not say.
constexpr double kTime = 0.02, kRatio = 1, kImpedance = 0.95;

double stiffnessAtRest(double k, double d) { return k * d * d / (1 - d); }

}  // namespace

std::optional<Softness> MjcfReader::softnessOf(const Tag& tag, const char* reference, const char* impedance) {
  const auto given = tag.range(reference).value_or(std::array{kTime, kRatio});
  auto impedances = tag.numbers(impedance, 1, 5).value_or(std::vector<double>{0.9, kImpedance});
  if (impedances.size() < 2) impedances.push_back(kImpedance);
  const double d = std::clamp(impedances[1], 1e-4, 0.9999);
  const bool direct = given[0] <= 0 && given[1] <= 0;
  if (!direct && !(given[0] > 0 && given[1] > 0)) return std::nullopt;
  const double k = direct ? -given[0] / (d * d) : std::pow(d * given[0] * given[1], -2),
               b = direct ? -given[1] / d : 2 / (d * given[0]);
  const double usual = stiffnessAtRest(std::pow(kImpedance * kTime * kRatio, -2), kImpedance);
  const Softness out{stiffnessAtRest(k, d), k > 0 ? b / (2 * std::sqrt(k)) : 0};
  if (!(out.stiffness > 0) || out.stiffness > usual * (1 - 1e-9)) {
    if (tag.has(reference) || tag.has(impedance))
      report_.note(Effect::None, tag.place(), tag.type() + "." + reference,
                   "not softer than MuJoCo's default: hard here");
    return std::nullopt;
  }
  report_.note(Effect::Approximate, tag.place(), tag.type() + "." + reference,
               "stiffness and damping ratio of a constraint at rest");
  return out;
}

}  // namespace rubble::convert
