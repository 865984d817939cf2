/// Poses of a running world without a look at each body: from the arrays of its state.
#include <algorithm>
#include <cmath>

#include "io/picture_poses.h"
#include "platform/threads.h"
#include "render/stage.h"

namespace rubble::render {

/// A world whose bodies the renderer has.
struct Stage::Followed {
  std::int64_t epoch = -1;
  const World* world = nullptr;
  int bodiesSet = 0;    ///< of the stage, when it learned them
  bool simple = false;  ///< nothing deforms and no plane moves: poses are all that changes
  std::string why;      ///< not, or not on the device
  std::vector<io::PoseSource> sources;
  std::unique_ptr<PoseFeed> feed;
  bool feedAsked = false;
};

namespace {

/// As the device reads it.
PoseSource deviceSource(const io::PoseSource& from) {
  PoseSource source;
  source.row = from.row;
  for (int i = 0; i < 3; ++i)
    source.place[i] = static_cast<float>(from.place[i]), source.turn[i] = static_cast<float>(from.turn.v[i]);
  source.turn[3] = static_cast<float>(from.turn.s);
  return source;
}

Pose poseOf(const io::PoseSource& source, const PoseArrays& arrays) {
  const io::BodyPose pose = io::poseOf(source, arrays.position, arrays.orientation);
  const Vec3f p(pose.position - arrays.origin);
  const QuatT<float> q(pose.orientation);
  return {p.x, p.y, p.z, 0, q.v.x, q.v.y, q.v.z, q.s};
}

}  // namespace

void Stage::learn(World& world) {
  Followed& f = *followed_;
  setBodies(io::pictureBodies(world));
  f.world = &world;
  f.bodiesSet = bodiesSet_;
  f.epoch = world.epoch();
  f.sources.clear();
  f.simple = io::posesAreAll(world) && looks_.empty();
  f.why = f.simple ? "" : looks_.empty() ? "something deforms" : "bodies have drawn parts";
  if (!f.simple) return;
  f.sources = io::poseSources(world);
  for (const BodyId id : world.bodies()) {
    const BodyDef& body = world.definition(id);
    if (body.shape.type == ShapeType::Plane && body.motion != Motion::Static)
      f.simple = false, f.why = "a plane moves";
  }
  if (!f.simple || !world.array(StateArray::Position).device) return;
  if (!f.feedAsked) f.feed = makePoseFeed(f.why);
  f.feedAsked = true;
  if (!f.feed) return;
  std::vector<PoseSource> sources;
  for (const io::PoseSource& source : f.sources) sources.push_back(deviceSource(source));
  renderer_.bodies().setSources(sources, *f.feed);
}

void Stage::follow(World& world) {
  if (!followed_) followed_ = std::make_shared<Followed>();
  Followed& f = *followed_;
  if (f.world != &world || f.epoch != world.epoch() || f.bodiesSet != bodiesSet_ || !f.simple ||
      !io::posesAreAll(world)) {
    learn(world);
    posesFrom_ = "body by body (" + (f.why.empty() ? "new ones" : f.why) + ")";
    return;
  }
  PoseArrays arrays{world.array(StateArray::Position), world.array(StateArray::Orientation),
                    renderer_.origin()};
  if (f.feed) {
    renderer_.bodies().setPoses(*f.feed, arrays);
    posesFrom_ = "on the device";
    return;
  }
  posesFrom_ = "from the host's arrays";
  if (arrays.position.device) {
    const PoseFrame frame = io::posesNow(world);
    arrays.position = frame.position, arrays.orientation = frame.orientation;
    posesFrom_ = "copied to the host (" + f.why + ")";
  }
  poses_.resize(f.sources.size());
  forEachRange(poses_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) poses_[i] = poseOf(f.sources[i], arrays);
  });
  renderer_.bodies().setPoses(poses_);
}

}  // namespace rubble::render
