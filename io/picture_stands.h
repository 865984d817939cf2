#pragma once
/// Stands, as machines are drawn with: static parts that are no bodies and have no effect on the motion.
#include <vector>

#include "io/picture.h"

namespace rubble::io {

/// Does a joint hold a body in the world in a way that is drawn? Hinges and sliders do, and pulleys.
bool needsStand(const World& world, JointId id);
/// Stands of the joints that are not broken. They depend on how bodies were added, and not on how they are
/// now. Parts that are upright end at the ground, or in worlds without one below what turns.
std::vector<PictureBody> standsOf(const World& world);

}  // namespace rubble::io
