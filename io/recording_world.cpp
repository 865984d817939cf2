#include "io/recording.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace rubble::io {

std::vector<RecordedBody> recordedBodies(const World& world) {
  std::vector<RecordedBody> bodies;
  for (const BodyId id : world.bodies()) {
    const BodyDef& definition = world.definition(id);
    bodies.push_back({definition.name, definition.shape, definition.motion, id});
  }
  return bodies;
}

std::vector<RecordedSoft> recordedSofts(const World& world) {
  std::vector<RecordedSoft> softs;
  for (const DeformableId id : world.deformables()) {
    World::Surface s = world.surface(id);
    const Deformable& definition = world.definition(id);
    softs.push_back({common(definition).name, id, static_cast<int>(s.vertices.size()), std::move(s.triangles),
                     std::move(s.segments), s.radius, s.spheres,
                     std::holds_alternative<TetSolidDef>(definition)});
  }
  return softs;
}

namespace {

void addVertices(RecordedFrame& frame, const World& world) {
  for (const DeformableId id : world.deformables()) {
    const std::vector<Vec3> places = world.positions(id);
    frame.vertices.insert(frame.vertices.end(), places.begin(), places.end());
  }
}

}  // namespace

RecordedFrame recordedFrame(const World& world) {
  RecordedFrame frame{world.stepCount(), world.time(), {}, {}};
  for (const BodyId id : world.bodies()) {
    const BodyState state = world.state(id);
    frame.poses.push_back({state.position, state.orientation});
  }
  addVertices(frame, world);
  return frame;
}

RecordedFrame recordedFrame(World& world, std::span<const PoseSource> sources) {
  const PoseFrame now = posesNow(world);
  RecordedFrame frame{world.stepCount(), world.time(), {}, {}};
  for (const PoseSource& source : sources) {
    const BodyPose pose = poseOf(source, now.position, now.orientation);
    frame.poses.push_back({pose.position, pose.orientation});
  }
  addVertices(frame, world);
  return frame;
}

std::vector<PictureBody> pictureBodies(RecordingReader& recording, int frameIndex) {
  /// Bodies and deformable objects of a frame, with their numbers of vertices.
  struct Present {
    std::vector<BodyId> bodies;
    std::vector<std::pair<DeformableId, int>> softs;
    bool operator==(const Present&) const = default;
  };
  const auto presentIn = [&](int index) {
    Present out;
    for (const RecordedBody& body : recording.bodies(index)) out.bodies.push_back(body.id);
    for (const RecordedSoft& soft : recording.softs(index)) out.softs.emplace_back(soft.id, soft.vertices);
    return out;
  };
  const int other = frameIndex > 0 ? frameIndex - 1 : std::min(1, recording.frameCount() - 1);
  const RecordedFrame neighbor = recording.frame(other);
  const Present before = presentIn(other);
  const RecordedFrame frame = recording.frame(frameIndex);
  const double apart = std::fabs(frame.time - neighbor.time);
  const bool moved = apart > 0 && presentIn(frameIndex) == before;
  std::vector<PictureBody> drawn;
  std::size_t i = 0;
  for (const RecordedBody& body : recording.bodies(frameIndex)) {
    const RecordedPose& pose = frame.poses[i];
    const double speed = moved ? length(pose.position - neighbor.poses[i].position) / apart : 0;
    drawn.push_back({body.shape, pose.position, pose.orientation, speed,
                     static_cast<std::uint32_t>(body.id.index), body.motion});
    ++i;
  }
  std::vector<DrawnSoft> softs;
  std::size_t first = 0;
  for (const RecordedSoft& soft : recording.softs(frameIndex)) {
    DrawnSoft look{static_cast<std::uint32_t>(soft.id.index),
                   {},
                   {},
                   soft.triangles,
                   soft.segments,
                   soft.radius,
                   soft.spheres,
                   soft.solid};
    for (std::size_t v = first; v < first + static_cast<std::size_t>(soft.vertices); ++v) {
      look.vertices.push_back(frame.vertices[v]);
      look.velocities.push_back(moved ? (frame.vertices[v] - neighbor.vertices[v]) / apart : Vec3{});
    }
    first += static_cast<std::size_t>(soft.vertices);
    softs.push_back(std::move(look));
  }
  addDeformables(softs, drawn);
  return drawn;
}

std::string remainder(RecordingReader& recording) {
  if (recording.complete()) return "";
  constexpr double kMegabyte = 1e6;
  const int frames = recording.frameCount();
  char text[128];
  std::snprintf(text, sizeof text, "%d frames (%.2f s) in %.2f of %.2f MB", frames,
                frames > 0 ? recording.frame(frames - 1).time - recording.frame(0).time : 0.,
                static_cast<double>(recording.intactBytes()) / kMegabyte,
                static_cast<double>(recording.fileBytes()) / kMegabyte);
  return text;
}

void requireRecordingName(const std::string& file) {
  if (std::filesystem::path(file).extension() != ".rubble")
    throw Error(file, "a recording, a name that ends in .rubble; `rubble export` makes other formats of it",
                "\"" + std::filesystem::path(file).extension().string() + "\"");
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
