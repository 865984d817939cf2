#include <rubble/info.h>

#include <build_info.h>

namespace rubble {

std::vector<ForceInfo> forceInfos() {
  const ForceField anchorA{"anchor_a", "m", "point on body A, in its frame"}, anchorB{"anchor_b", "m", "point on body B, in its frame"};
  const ForceField stiffness{"stiffness", "N/m", "of the anchors, or \"hard\""}, breakForce{"break_force", "N", "the joint breaks when its force reaches this"};
  return {
      {"contact", "contact of two bodies with Coulomb friction: one to four points, for each a normal row and two tangential rows", 12,
       {{"static_friction", "1", "mu_s; a pair takes the geometric mean"},
        {"dynamic_friction", "1", "mu_d, at most mu_s; a pair takes the geometric mean"},
        {"restitution", "1", "e, for closing speeds above 1 m/s; a pair takes the larger"},
        {"friction_combine", "1", "rule for both frictions of a pair: usual, average, minimum, multiply, maximum, geometric_mean; the later one wins"},
        {"restitution_combine", "1", "rule for the restitution of a pair"},
        {"surface_velocity", "m/s", "of a belt, body axes"}}},
      {"rolling", "rolling and torsional friction of a contact: three rows with moments bounded by a lever times the normal force", 3,
       {{"rolling_friction", "m", "lever of the moment that resists rolling; a pair takes the larger"},
        {"torsional_friction", "m", "lever of the moment that resists spinning about the normal; a pair takes the larger"}}},
      {"ball", "ball joint: two anchors coincide", 3, {anchorA, anchorB, stiffness, breakForce}},
      {"fixed", "fixed joint: two anchors coincide and the relative orientation is kept", 6,
       {anchorA, anchorB, {"orientation_a_to_b", "1", "wanted orientation of A seen from B, a unit quaternion"}, stiffness,
        {"angular_stiffness", "N m/rad", "of the orientation, or \"hard\""}, breakForce,
        {"break_torque", "N m", "the joint breaks when its torque reaches this"}}},
  };
}

BuildInfo buildInfo() {
  BuildInfo info;
  info.version = build::kVersion;
  info.commit = build::kCommit;
#if defined(__clang__)
  info.compiler = std::string("clang ") + __clang_version__;
#elif defined(__GNUC__)
  info.compiler = std::string("gcc ") + __VERSION__;
#endif
  info.precision = "float; double in backend \"reference\"";
  info.features.emplace_back(std::string("cuda ") + cudaStatus());
  if (std::string(build::kFeatures).size() > 0) info.features.emplace_back(build::kFeatures);
  return info;
}

}  // namespace rubble
