#pragma once
#include <rubble/deformables.h>

namespace rubble::scenes {

/// A block of particles. Each layer is shifted a little against the one below.
ParticlesDef sandBlock(const Vec3& corner, int nx, int ny, int nz, double radius);

}  // namespace rubble::scenes
