#include "convert/mjcf_muscle.h"

#include <cmath>

#include "convert/mjcf_reader.h"

namespace rubble::convert {

std::optional<MjcfLaw> MjcfReader::muscleLaw(const Tag& tag, double activation, const MjcfTarget& target) {
  const bool general = tag.type() == "general";
  auto given = general ? tag.numbers("gainprm", 1, 10).value_or(std::vector<double>{})
                       : std::vector<double>{};
  const double usual[] = {0.75, 1.05, -1, 200, 0.5, 1.6, 1.5, 1.3, 1.2};
  for (std::size_t i = given.size(); i < std::size(usual); ++i) given.push_back(usual[i]);
  if (!general) {
    const auto range = tag.range("range").value_or(std::array{usual[0], usual[1]});
    given = {range[0],
             range[1],
             tag.number("force", usual[2]),
             tag.number("scale", usual[3]),
             tag.number("lmin", usual[4]),
             tag.number("lmax", usual[5]),
             tag.number("vmax", usual[6]),
             tag.number("fpmax", usual[7]),
             tag.number("fvmax", usual[8])};
  }
  const MuscleCurves curves{given[4], given[5], given[6], given[7], given[8]};
  std::optional<std::array<double, 2>> lengths = tag.range("lengthrange");
  if (!lengths || !((*lengths)[1] > (*lengths)[0])) {
    lengths.reset();
    if (const auto& range = target.coordinate->range)
      lengths = {{std::min(target.gear * (*range)[0], target.gear * (*range)[1]),
                  std::max(target.gear * (*range)[0], target.gear * (*range)[1])}};
  }
  double peak = given[2];
  if (const double response = peak < 0 ? responseTo(target.moments) : 0; response > 0)
    peak = given[3] / response;
  if (!lengths || peak < 0 || !(given[1] > given[0]) || !(curves.longest > 1 && curves.shortest < 1) ||
      !(curves.fastest > 0))
    return std::nullopt;
  report_.note(Effect::Approximate, tag.place(), tag.describe(),
               "the force is linear about the length at the beginning, at the activation there");
  const double optimal = ((*lengths)[1] - (*lengths)[0]) / (given[1] - given[0]);
  const double at = given[0] + (target.length - (*lengths)[0]) / optimal, h = 1e-4;
  const auto force = [&](double x) { return -peak * (activation * curves.active(x) + curves.stretched(x)); };
  // only a muscle that stiffens as it is stretched has a stable linear force
  const double slope = std::min((force(at + h) - force(at - h)) / (2 * h) / optimal, 0.);
  const double damping = -2 * peak * activation * curves.active(at) / (optimal * curves.fastest);
  return MjcfLaw{force(at) - slope * target.length, slope, damping};
}

}  // namespace rubble::convert
