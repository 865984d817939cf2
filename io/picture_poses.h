#pragma once
/// Poses of the bodies of a running world without a look at each of them: from the arrays of its state.
#include <cstdint>
#include <span>
#include <vector>

#include <rubble/arrays.h>

#include "io/picture.h"

namespace rubble::io {

/// Where the pose of a body is: the row of its pose in the engine's arrays, and the frame of its shape in
/// that of the engine.
struct PoseSource {
  std::int32_t row = -1;
  Vec3 place;  ///< [m]
  Quat turn;
};
struct BodyPose {
  Vec3 position;     ///< world [m]
  Quat orientation;  ///< body -> world
};

/// Poses of all body slots as they are now, on the host. Valid until the second call after this one.
PoseFrame posesNow(World& world);
/// Of all bodies, in the order of World::bodies(). To be taken anew when World::epoch() is another.
std::vector<PoseSource> poseSources(World& world);
/// Of a body, from arrays of the host: StateArray::Position and Orientation.
BodyPose poseOf(const PoseSource& source, const ArrayView& position, const ArrayView& orientation);
/// Do bodies move and nothing else? Deformable objects and ropes are other meshes in every
/// step, and machines have parts that are no bodies.
bool posesAreAll(const World& world);

/// Bodies as pictureBodies has them, kept up to date: while none come or go and nothing deforms, only poses
/// are fetched.
class WatchedBodies {
 public:
  /// `bodies` are what a call left there when the world had this `epoch`; -1: nothing.
  void update(World& world, ColorBy colorBy, std::vector<PictureBody>& bodies, std::int64_t& epoch);

 private:
  std::int64_t epoch_ = -1;  ///< of the sources
  std::vector<PoseSource> sources_;
};

}  // namespace rubble::io
