#pragma once
/// Probes for bodies that slide and roll.
#include <memory>
#include <string>
#include <vector>

#include "registry.h"

namespace rubble::scenes {

/// A box that slides along +x until friction stops it.
struct Slider {
  std::string body;
  double friction;  ///< of the pair [1]
};

/// Error of the way to rest against v0^2 / (2 mu g) - v0 h / 2 (implicit Euler, h: substep), relative, the
/// largest one: stop_distance_error of the boxes with mu up to 1, stop_distance_error_high of the others.
std::unique_ptr<Probe> stopProbe(const Scene& scene, const std::vector<Slider>& sliders);

/// A box on a ramp.
struct RampBox {
  std::string body;
  double ratio;  ///< friction of the pair over the tangent of the ramp's angle: below 1 it slides
};

/// slides_wrong: boxes that hold (displaced by less than `hold` metres at the end) and should slide, or the
/// other way round; threshold_error: largest |ratio - 1| of those, 0 without; creep_max_m: largest
/// displacement of a box that should hold, from `settled` seconds to the end.
std::unique_ptr<Probe> rampProbe(const std::vector<RampBox>& boxes, double hold, double settled);

/// final_speed_ratio: speed of a body along `direction` at the end over `reference` [m/s].
std::unique_ptr<Probe> speedProbe(const std::string& body, const Vec3& direction, double reference);

/// final_slip_ratio: speed of the point of a sphere that touches the ground, over `reference` [m/s], at the
/// end.
std::unique_ptr<Probe> slipProbe(const Scene& scene, const std::string& body, double reference);

/// travel_m: how far a body has come along `direction` by the end.
std::unique_ptr<Probe> travelProbe(const std::string& body, const Vec3& direction);

}  // namespace rubble::scenes
