#pragma once
/// Probes for single bodies and their motion; see probes.h for the stacks.
#include <memory>
#include <string>
#include <vector>

#include "registry.h"

namespace rubble::scenes {

/// `metric` = kinetic energy of all bodies at `at` seconds over `reference` joules; nothing in a run that
/// ends before.
std::unique_ptr<Probe> kineticProbe(double at, const std::string& metric, double reference);

/// swing_time_s: when the motion of a body along `direction` turns from backward to forward for the first
/// time, which is the far end of the first swing.
std::unique_ptr<Probe> swingProbe(const std::string& body, const Vec3& direction);

/// length_m: distance of two bodies' centers at `at` seconds.
std::unique_ptr<Probe> lengthProbe(const std::string& a, const std::string& b, double at);

/// position_error_ratio: largest distance from p + v n h + g h^2 n (n + 1) / 2 (implicit Euler in closed
/// form, h: substep) over the run, over the length of the way.
std::unique_ptr<Probe> ballisticProbe(const Scene& scene, const std::string& body);

/// period_s: mean time between the passages of a body through the vertical below the origin, in +x;
/// period_error against `period`.
std::unique_ptr<Probe> periodProbe(const std::string& body, double period);

/// Free spin, against the first step: momentum_error (largest |L - L1| / |L1|), energy_ratio (smallest E /
/// E1), energy_ratio_max, flips (how often the body's `axis` turned over against L).
std::unique_ptr<Probe> spinProbe(const std::string& body, const Vec3& axis);

/// Momentum of the two bodies: momentum_error (largest |p - p0| / |p0|); closing_speed_ratio: speed of a
/// towards b along the start's, over its start.
std::unique_ptr<Probe> impactProbe(const std::string& a, const std::string& b);

/// restitution_found: sqrt of the height of the first rebound over that of the drop, `drop` metres above the
/// place of rest at `rest`.
std::unique_ptr<Probe> reboundProbe(const Scene& scene, const std::string& body, double rest, double drop);

/// fallen_ratio: share of the bodies whose axis `local` has turned more than 45 degrees away from its start.
std::unique_ptr<Probe> fallenProbe(const Scene& scene, const Vec3& local);

}  // namespace rubble::scenes
