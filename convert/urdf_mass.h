#pragma once
/// Masses of URDF links as files have them: absent, zero, or with an inertia that no solid has.
#include "convert/model.h"

namespace rubble::convert {

/// Integrals of a link by its <inertial>, about its center of mass. An inertia that no solid has becomes the
/// nearest one that a solid has, which is reported; of zeros, that of `shapes` or of a ball.
SolidSums massOfInertial(double mass, const std::array<double, 6>& tensor, const SolidSums& shapes,
                         const Place& place, Report& report);

/// Gives links that move, and have neither mass nor anything fixed to them that has, a hundredth of the mean
/// mass of the others, which is reported.
void giveMissingMasses(Model& model, Report& report);

}  // namespace rubble::convert
