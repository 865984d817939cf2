#pragma once
/// The probes that scenes measure with. Names of metrics end in their unit; a ratio has none.
/// Times are in seconds since the start of the world, so that a probe means the same at every time step.
#include <memory>
#include <string>
#include <vector>

#include "registry.h"

namespace rubble::scenes {

/// Indices into scene.bodies of all dynamic bodies, and of those with the largest height along the scene's up
/// (the top layer).
std::vector<int> dynamicBodies(const Scene& scene);
std::vector<int> topLayer(const Scene& scene);

/// At `at` seconds, or at the end of a shorter run: penetration_mean_m, penetration_p99_m, penetration_max_m,
/// joint_gap_mean_m, joint_gap_max_m, kinetic_energy_j, max_speed_m_s; over the whole run: quarantined
/// (bodies whose state was not finite), broken_joints. `prefix` goes before each name; a probe with a prefix
/// measures nothing in a run that ends before `at`.
std::unique_ptr<Probe> qualityProbe(double at, const std::string& prefix = "");

/// A stack at `at` seconds, or at the end of a shorter run, against its start:
///   top_drop_m       mean sinking of the top layer along gravity
///   top_drop_peak_m  the largest so far, sampled every 0.1 s
///   max_drift_m      largest displacement of a brick
///   bricks_lost      bricks displaced by more than half their smallest edge
///   lowest_m         lowest point of a brick above the ground
std::unique_ptr<Probe> stackProbe(const Scene& scene, double at);

/// A stack after a smash, at the end of the run; nothing if the run ends before `at` seconds:
/// smash_moved_ratio (share of the bricks displaced by more than half their smallest edge), smash_lowest_m,
/// smash_top_drop_m, and the quality half a second after the smash.
Probes smashProbes(const Scene& scene, double at);

/// Fall of a stack in the `duration` after the step at `at` seconds, over the discrete free fall g dt^2 n (n
/// + 1) / 2. fall_ratio: mean of the top layer; fall_ratio_mean: all bodies; fall_ratio_ends: mean of top
/// layer and lowest brick; fall_ratio_bottom; fall_ratio_min: the body that falls least.
std::unique_ptr<Probe> fallProbe(const Scene& scene, double at, double duration);

/// Joints along a chain of `length` metres: stretch (sum of the gaps over the length, at the end),
/// stretch_peak (largest in the run).
std::unique_ptr<Probe> chainProbe(const Scene& scene, double length);

/// Energy of all bodies against the start, over `scale` joules: energy_gain_ratio (largest), energy_end_ratio
/// (at the end).
std::unique_ptr<Probe> energyProbe(double scale);

}  // namespace rubble::scenes
