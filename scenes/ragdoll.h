#pragma once
#include <string>

#include "registry.h"

namespace rubble::scenes {

/// A man of 1.75 m and 70 kg with eleven bodies, standing at `foot`; turned about z, and of another size: all
/// lengths times `size`. z is up.
void addRagdoll(Scene& scene, const Vec3& foot, double turn, const std::string& name, double size = 1);

}  // namespace rubble::scenes
