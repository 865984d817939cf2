/// Poses of a running world without a look at each body: from the arrays of its state.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "render/stage.h"

namespace rubble::render {

/// A world whose bodies the renderer has.
struct Stage::Followed {
  std::int64_t epoch = -1;
  const World* world = nullptr;
  int bodiesSet = 0;    ///< of the stage, when it learned them
  bool simple = false;  ///< nothing deforms and no plane moves: poses are all that changes
  std::string why;      ///< not, or not on the device
  std::vector<PoseSource> sources;
  std::unique_ptr<PoseFeed> feed;
  bool feedAsked = false;
};

namespace {

double number(const ArrayView& view, std::int64_t row, std::int64_t column) {
  const char* const at = static_cast<const char*>(view.data) + row * view.strides[0] + column * view.strides[1];
  double wide = 0;
  float narrow = 0;
  if (view.typestr[2] == '8') std::memcpy(&wide, at, sizeof wide);
  else std::memcpy(&narrow, at, sizeof narrow), wide = static_cast<double>(narrow);
  return wide;
}

Vec3 positionAt(const ArrayView& view, std::int64_t row) { return {number(view, row, 0), number(view, row, 1), number(view, row, 2)}; }
Quat turnAt(const ArrayView& view, std::int64_t row) {
  return {number(view, row, 0), number(view, row, 1), number(view, row, 2), number(view, row, 3)};
}

/// The shape's frame in that of the engine.
PoseSource sourceOf(const BodyState& state, const PoseFrame& engine, std::int32_t row) {
  const Quat own = conjugate(turnAt(engine.orientation, row)), turn = normalize(own * state.orientation);
  const Vec3 place = rotate(own, state.position - positionAt(engine.position, row));
  PoseSource source;
  source.row = row;
  for (int i = 0; i < 3; ++i) source.place[i] = static_cast<float>(place[i]), source.turn[i] = static_cast<float>(turn.v[i]);
  source.turn[3] = static_cast<float>(turn.s);
  return source;
}

Pose poseOf(const PoseSource& s, const PoseArrays& arrays) {
  const Quat q = turnAt(arrays.orientation, s.row);
  const Vec3 p = positionAt(arrays.position, s.row) + rotate(q, Vec3{s.place[0], s.place[1], s.place[2]}) - arrays.origin;
  const Quat turn = q * Quat{s.turn[3], s.turn[0], s.turn[1], s.turn[2]};
  const auto f = [](double a) { return static_cast<float>(a); };
  return {f(p.x), f(p.y), f(p.z), 0, f(turn.v.x), f(turn.v.y), f(turn.v.z), f(turn.s)};
}

}  // namespace

void Stage::learn(World& world) {
  Followed& f = *followed_;
  setBodies(io::pictureBodies(world));
  f.world = &world;
  f.bodiesSet = bodiesSet_;
  f.epoch = world.epoch();
  f.sources.clear();
  f.simple = world.deformables().empty() && !io::hasRopes(world);
  f.why = f.simple ? "" : "something deforms";
  if (!f.simple) return;
  world.beginPoses();
  const PoseFrame engine = world.takePoses();
  for (const BodyId id : world.bodies()) {
    const BodyDef& body = world.definition(id);
    f.sources.push_back(sourceOf(world.state(id), engine, id.index));
    if (body.shape.type == ShapeType::Plane && body.motion != Motion::Static) f.simple = false, f.why = "a plane moves";
  }
  if (!f.simple || !world.array(StateArray::Position).device) return;
  if (!f.feedAsked) f.feed = makePoseFeed(f.why);
  f.feedAsked = true;
  if (f.feed) renderer_.bodies().setSources(f.sources, *f.feed);
}

void Stage::follow(World& world) {
  if (!followed_) followed_ = std::make_shared<Followed>();
  Followed& f = *followed_;
  if (f.world != &world || f.epoch != world.epoch() || f.bodiesSet != bodiesSet_ || !f.simple) {
    learn(world);
    posesFrom_ = "body by body (" + (f.why.empty() ? "new ones" : f.why) + ")";
    return;
  }
  PoseArrays arrays{world.array(StateArray::Position), world.array(StateArray::Orientation), renderer_.origin()};
  if (f.feed) {
    renderer_.bodies().setPoses(*f.feed, arrays);
    posesFrom_ = "on the device";
    return;
  }
  posesFrom_ = "from the host's arrays";
  if (arrays.position.device) {
    world.beginPoses();
    const PoseFrame frame = world.takePoses();
    arrays.position = frame.position, arrays.orientation = frame.orientation;
    posesFrom_ = "copied to the host (" + f.why + ")";
  }
  poses_.resize(f.sources.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, poses_.size(), 4096), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) poses_[i] = poseOf(f.sources[i], arrays);
  });
  renderer_.bodies().setPoses(poses_);
}

}  // namespace rubble::render
