#pragma once
#include <string>

#include "registry.h"

namespace rubble::scenes {

/// A man of 1.75 m and 70 kg with eleven bodies, standing at `foot`; turned about z. z is up.
void addRagdoll(Scene& scene, const Vec3& foot, double turn, const std::string& name);

}  // namespace rubble::scenes
