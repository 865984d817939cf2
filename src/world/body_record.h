#pragma once
/// Data that the world keeps of a body, in addition to that of the engine.
#include <vector>

#include <rubble/ids.h>
#include <rubble/scene.h>

#include "world/shape_frame.h"

namespace rubble {

struct BodyRecord {
  BodyDef def;
  MassProperties mass;
  ShapeFrame frame;  ///< engine frame in the authored frame
  double radius;     ///< of the bounding sphere about the center of mass [m]
  ShapeId shape;
  std::vector<JointId> joints = {};
};

}  // namespace rubble
