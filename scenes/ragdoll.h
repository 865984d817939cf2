#pragma once
#include <string>

#include "registry.h"

namespace rubble::scenes {

/// A ragdoll of 1.75 m and 70 kg with eleven bodies. It stands at `foot`, rotated about z by `turn`. All
/// lengths are multiplied by `size`. z is up.
void addRagdoll(Scene& scene, const Vec3& foot, double turn, const std::string& name, double size = 1);

}  // namespace rubble::scenes
