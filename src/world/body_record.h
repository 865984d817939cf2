#pragma once
/// What the world keeps of a body besides what the engine has.
#include <rubble/scene.h>

#include "world/shape_frame.h"

namespace rubble {

struct BodyRecord {
  BodyDef def;
  MassProperties mass;
  ShapeFrame frame;  ///< of the engine in that of the author
  double radius;     ///< of the bounding sphere about the center of mass [m]
};

}  // namespace rubble
