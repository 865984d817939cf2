#include "io/picture_poses.h"

#include <cstring>

namespace rubble::io {
namespace {

double number(const ArrayView& view, std::int64_t row, std::int64_t column) {
  const char* const at = static_cast<const char*>(view.data) + row * view.strides[0] +
                         column * view.strides[1];
  double wide = 0;
  float narrow = 0;
  if (view.typestr[2] == '8')
    std::memcpy(&wide, at, sizeof wide);
  else
    std::memcpy(&narrow, at, sizeof narrow), wide = static_cast<double>(narrow);
  return wide;
}

Vec3 positionAt(const ArrayView& view, std::int64_t row) {
  return {number(view, row, 0), number(view, row, 1), number(view, row, 2)};
}
Quat turnAt(const ArrayView& view, std::int64_t row) {
  return {number(view, row, 0), number(view, row, 1), number(view, row, 2), number(view, row, 3)};
}

}  // namespace

PoseFrame posesNow(World& world) {
  world.beginPoses();
  return world.takePoses();
}

std::vector<PoseSource> poseSources(World& world) {
  const PoseFrame engine = posesNow(world);
  std::vector<PoseSource> sources;
  for (const BodyId id : world.bodies()) {
    const BodyState state = world.state(id);
    const Quat own = conjugate(turnAt(engine.orientation, id.index));
    sources.push_back({id.index, rotate(own, state.position - positionAt(engine.position, id.index)),
                       normalize(own * state.orientation)});
  }
  return sources;
}

BodyPose poseOf(const PoseSource& source, const ArrayView& position, const ArrayView& orientation) {
  const Quat turn = turnAt(orientation, source.row);
  return {positionAt(position, source.row) + rotate(turn, source.place), turn * source.turn};
}

bool posesAreAll(const World& world) {
  return world.deformables().empty() && !hasRopes(world) && !hasMachines(world);
}

void WatchedBodies::update(World& world, ColorBy colorBy, std::vector<PictureBody>& bodies,
                           std::int64_t& epoch) {
  if (colorBy != ColorBy::Body || epoch != world.epoch() || !posesAreAll(world)) {
    bodies = pictureBodies(world, colorBy);
    epoch = world.epoch();
    return;
  }
  if (epoch_ != epoch) sources_ = poseSources(world), epoch_ = epoch;
  // Ropes and deformable objects come and go within an epoch: a list from before may hold theirs behind the
  // bodies.
  if (bodies.size() != sources_.size()) {
    bodies = pictureBodies(world, colorBy);
    return;
  }
  const PoseFrame frame = posesNow(world);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyPose pose = poseOf(sources_[i], frame.position, frame.orientation);
    bodies[i].position = pose.position;
    bodies[i].orientation = pose.orientation;
  }
}

}  // namespace rubble::io
