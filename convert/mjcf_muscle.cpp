/// Muscles: their curves are those of rubble::Muscle, in units of lengths that follow from the range of the
/// actuator.
#include <algorithm>
#include <cmath>

#include <rubble/error.h>

#include "convert/mjcf_lengths.h"

namespace rubble::convert {

bool MjcfReader::readMuscle(const Tag& tag, const MjcfTarget& target, ActuatorDef& out) {
  Muscle& muscle = out.muscle;
  out.type = ActuatorType::Muscle;
  std::vector<double> given{0.75, 1.05, -1, 200, 0.5, 1.6, 1.5, 1.3, 1.2};
  if (tag.type() == "general") {
    const auto list = tag.numbers("gainprm", 1, 10).value_or(std::vector<double>{});
    for (std::size_t i = 0; i < std::min(list.size(), given.size()); ++i) given[i] = list[i];
    const auto passive = tag.numbers("biasprm", 1, 10).value_or(list);
    if (tag.text("biastype").value_or("none") != "muscle")
      given[7] = 0;
    else if (passive != list)
      report_.note(Effect::Approximate, tag.place(), "general.biasprm",
                   "passive forces are those of gainprm");
  } else {
    out.dynamics = ActuatorDynamics::Muscle;
    const auto range = tag.range("range").value_or(std::array{given[0], given[1]});
    given[0] = range[0], given[1] = range[1];
    const char* const keys[] = {"force", "scale", "lmin", "lmax", "vmax", "fpmax", "fvmax"};
    for (std::size_t i = 0; i < std::size(keys); ++i) given[i + 2] = tag.number(keys[i], given[i + 2]);
    if (const auto times = tag.numbers("timeconst", 2, 2))
      muscle.rise = (*times)[0], muscle.fall = (*times)[1];
    muscle.smoothing = tag.number("tausmooth", 0);
  }
  muscle.shortest = given[4], muscle.longest = given[5], muscle.fastest = given[6];
  muscle.passive = given[7], muscle.lengthening = given[8];
  std::optional<std::array<double, 2>> lengths = tag.range("lengthrange");
  if (!lengths || !((*lengths)[1] > (*lengths)[0])) {
    const Coordinate& coordinate = *target.coordinate;
    lengths = target.tendon >= 0 && target.isOfModel
                  ? lengthRange(model_.tendons[static_cast<std::size_t>(target.tendon)])
                  : coordinate.range;
    if (lengths)
      lengths = {{std::min(target.gear * (*lengths)[0], target.gear * (*lengths)[1]),
                  std::max(target.gear * (*lengths)[0], target.gear * (*lengths)[1])}};
  }
  muscle.peakForce = given[2];
  if (const double response = given[2] < 0 ? responseTo(target.moments) : 0; response > 0)
    muscle.peakForce = given[3] / response;
  if (!lengths || !((*lengths)[1] > (*lengths)[0]) || !(given[1] > given[0])) return false;
  muscle.optimalLength = ((*lengths)[1] - (*lengths)[0]) / (given[1] - given[0]);
  muscle.tendonLength = (*lengths)[0] - given[0] * muscle.optimalLength;
  try {
    validate(out, "muscle");
  } catch (const Error&) {
    return false;
  }
  return true;
}

std::optional<std::array<double, 2>> MjcfReader::lengthRange(const Tendon& tendon) const {
  struct Coordinate {
    std::pair<int, int> dof;
    double least, most;
  };
  std::map<std::pair<int, int>, double> now;
  std::vector<Coordinate> free;
  for (const auto& [at, rate] : momentsOf(tendon)) {
    const Dof& own = model_.links[static_cast<std::size_t>(at.first)]
                         .dofs[static_cast<std::size_t>(at.second)];
    if (!own.range && own.type == DofType::Slide) return std::nullopt;
    const double turn = std::acos(-1.);
    const auto range = own.range.value_or(std::array{own.reference - turn, own.reference + turn});
    free.push_back({at, range[0], range[1]});
  }
  const auto length = [&] {
    const auto changeOf = [&](const std::pair<int, int>& at) {
      const auto found = now.find(at);
      const Dof& own = model_.links[static_cast<std::size_t>(at.first)]
                           .dofs[static_cast<std::size_t>(at.second)];
      return found == now.end() ? 0. : found->second - own.reference;
    };
    return lengthOf(
        tendon, [&](int link) { return poseWith(link, changeOf); },
        [&](const std::pair<int, int>& at) { return now.at(at); });
  };
  // the farthest value of each coordinate in turn, from the pose of the file
  const auto extreme = [&](double sign) {
    constexpr int kRounds = 3, kSamples = 12, kHalvings = 24;
    for (const Coordinate& each : free)
      now[each.dof] = model_.links[static_cast<std::size_t>(each.dof.first)]
                          .dofs[static_cast<std::size_t>(each.dof.second)]
                          .reference;
    for (int round = 0; round < kRounds; ++round)
      for (const Coordinate& each : free) {
        double& value = now[each.dof];
        const auto at = [&](double x) {
          return value = std::clamp(x, each.least, each.most), sign * length();
        };
        double step = (each.most - each.least) / kSamples, best = each.least, reached = at(best);
        for (int i = 1; i <= kSamples; ++i)
          if (const double x = each.least + i * step, here = at(x); here > reached) best = x, reached = here;
        for (int i = 0; i < kHalvings; ++i, step /= 2)
          for (const double x : {best - step / 2, best + step / 2})
            if (const double here = at(x); here > reached)
              best = std::clamp(x, each.least, each.most), reached = here;
        value = best;
      }
    return length();
  };
  const double least = extreme(-1), most = extreme(1);
  const auto& range = tendon.range;
  return std::array{range ? std::max(least, (*range)[0]) : least, range ? std::min(most, (*range)[1]) : most};
}

}  // namespace rubble::convert
