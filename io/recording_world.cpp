#include "io/recording.h"

#include <algorithm>
#include <cmath>

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

RecordedFrame recordedFrame(World& world, std::span<const PoseSource> sources) {
  const PoseFrame now = posesNow(world);
  RecordedFrame frame{world.stepCount(), world.time(), {}};
  for (const PoseSource& source : sources) {
    const BodyPose pose = poseOf(source, now.position, now.orientation);
    frame.poses.push_back({pose.position, pose.orientation});
  }
  return frame;
}

std::vector<PictureBody> pictureBodies(RecordingReader& recording, int frameIndex) {
  const auto idsOf = [&](int index) {
    std::vector<BodyId> ids;
    for (const RecordedBody& body : recording.bodies(index)) ids.push_back(body.id);
    return ids;
  };
  const int other = frameIndex > 0 ? frameIndex - 1 : std::min(1, recording.frameCount() - 1);
  const RecordedFrame neighbour = recording.frame(other);
  const std::vector<BodyId> neighbourIds = idsOf(other);
  const RecordedFrame frame = recording.frame(frameIndex);
  const double apart = std::fabs(frame.time - neighbour.time);
  const bool moved = apart > 0 && idsOf(frameIndex) == neighbourIds;
  std::vector<PictureBody> drawn;
  std::size_t i = 0;
  for (const RecordedBody& body : recording.bodies(frameIndex)) {
    const RecordedPose& pose = frame.poses[i];
    const double speed = moved ? length(pose.position - neighbour.poses[i].position) / apart : 0;
    drawn.push_back({body.shape, pose.position, pose.orientation, speed, static_cast<std::uint32_t>(body.id.index), body.motion});
    ++i;
  }
  return drawn;
}

int frameAfter(RecordingReader& recording, std::int64_t steps) {
  int low = 0, high = recording.frameCount() - 1;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (recording.frame(middle).step >= steps) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

}  // namespace rubble::io
