#include "io/recording.h"

namespace rubble::io {

std::vector<RecordedBody> recordedBodies(const World& world) {
  std::vector<RecordedBody> bodies;
  for (const BodyId id : world.bodies()) {
    const BodyDef& definition = world.definition(id);
    bodies.push_back({definition.name, definition.shape, definition.motion, id});
  }
  return bodies;
}

RecordedFrame recordedFrame(const World& world) {
  RecordedFrame frame{world.stepCount(), world.time(), {}};
  for (const BodyId id : world.bodies()) {
    const BodyState state = world.state(id);
    frame.poses.push_back({state.position, state.orientation});
  }
  return frame;
}

}  // namespace rubble::io
