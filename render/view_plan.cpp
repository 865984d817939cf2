#include "render/view_plan.h"

#include <algorithm>
#include <cmath>

#include "render/sight.h"

namespace rubble::render {
namespace {

/// What moves is followed if its way is this much longer than it is large [1].
constexpr double kTravels = 7;
/// What goes farther than this times the size of the start, or the way of most bodies, leaves the picture
/// [1].
constexpr double kGone = 1.4;
/// So many count as most [1].
constexpr double kStaying = .85;
/// Walls that hide more than this share of what moves are looked around or left out [1].
constexpr double kHidden = .4;
/// Room for the ground that goes by, over the distance of the camera [1].
constexpr double kFollowRoom = .35;
/// The floor lies this share of the size of the scene below everything [1].
constexpr double kFloorGap = .02;
/// Cosine of the angle from up within which a beam of a stand is a post.
constexpr double kUpright = .999;

bool moves(const io::PictureBody& body) {
  return body.motion != Motion::Static && body.shape.type != ShapeType::Plane &&
         std::isfinite(dot(body.position, body.position));
}

/// Axis-aligned box of bodies that meet a condition [m].
struct Box {
  Vec3 low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
  bool empty() const { return low.x > high.x; }
  Vec3 middle() const { return (low + high) * .5; }
  Vec3 half() const { return empty() ? Vec3{} : (high - low) * .5; }
  void add(const io::PictureBody& body) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 along;
      along[axis] = 1;
      const double extent = io::extentAlong(body, along);
      low[axis] = std::min(low[axis], body.position[axis] - extent);
      high[axis] = std::max(high[axis], body.position[axis] + extent);
    }
  }
};
template <class Test> Box boxOf(std::span<const io::PictureBody> bodies, Test&& test) {
  Box box;
  for (const io::PictureBody& body : bodies)
    if (test(body)) box.add(body);
  return box;
}
double largest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

Vec3 upOf(const Vec3& gravity) { return normalize(-gravity, {0, 0, 1}); }

}  // namespace

ViewPlan::ViewPlan(std::span<const std::vector<io::PictureBody>> moments, const Vec3& gravity,
                   const Framing& framing, bool turns, const std::optional<Vec3>& eye) {
  // what moves, without the few that leave
  const Box start = boxOf(moments.front(), moves);
  start_ = start.middle(), reach_ = kGone * length(start.half());
  for (const std::vector<io::PictureBody>& moment : moments) {
    std::vector<double> away;
    for (const io::PictureBody& body : moment)
      if (moves(body)) away.push_back(length(body.position - start_));
    std::ranges::sort(away);
    if (!away.empty())
      reach_ = std::max(
          reach_, kGone * away[static_cast<std::size_t>(kStaying * static_cast<double>(away.size() - 1))]);
  }
  std::vector<io::PictureBody> swept;
  for (const std::vector<io::PictureBody>& moment : moments)
    for (const io::PictureBody& body : moment)
      if (moves(body) && !isGone(body)) swept.push_back(body);
  std::vector<io::PictureBody> framed = swept;
  const double whole = largest(boxOf(swept, moves).half());
  // the moment in which it is largest
  double widest = 0;
  std::size_t at = 0;
  for (std::size_t m = 0; m < moments.size(); ++m)
    if (const double size = largest(boxOf(moments[m], moves).half()); size > widest) widest = size, at = m;
  middle_ = boxOf(moments.front(), moves).middle();
  follows_ = !swept.empty() && whole > kTravels * widest;
  if (follows_) {
    framed = moments[at];
    middle_ = boxOf(framed, moves).middle();
  } else if (framed.empty()) {
    framed = moments.front();
  }
  camera_ = cameraShowing(framed, gravity, framing);
  if (follows_) {
    // the ground that goes by needs room
    camera_.eye += (camera_.eye - camera_.target) * kFollowRoom;
  }
  Sightlines sight(moments);
  if (turns) {
    double best = sight.from(camera_.eye).visible;
    const Vec3 up = upOf(gravity), back = camera_.eye - camera_.target;
    const Vec3 side = normalize(cross(up, back), {1, 0, 0});
    for (const double raised : {0., .3})
      for (const double turned : {.6, -.6, 1.2, -1.2, 2.4}) {
        if (best > 1 - kHidden) break;
        const Quat turn = fromAxisAngle(up, turned) * fromAxisAngle(side, -raised);
        Framing other = framing;
        other.direction = -rotate(turn, back);
        const Camera candidate = cameraShowing(framed, gravity, other);
        if (const double visible = sight.from(candidate.eye).visible; visible > best + .15)
          best = visible, camera_ = candidate;
      }
  }
  leaveWallsOut(sight, eye.value_or(camera_.eye));

  const bool grounded = std::ranges::all_of(moments, [](const std::vector<io::PictureBody>& moment) {
    return std::ranges::any_of(moment,
                               [](const io::PictureBody& b) { return b.shape.type == ShapeType::Plane; });
  });
  if (grounded) return;
  const Vec3 up = upOf(gravity);
  double lowest = 1e30;
  for (const std::vector<io::PictureBody>& moment : moments)
    for (const io::PictureBody& body : moment)
      if (std::isfinite(dot(body.position, body.position)))
        lowest = std::min(lowest, dot(body.position, up) - io::extentAlong(body, up));
  if (lowest > 1e29) lowest = 0;
  io::PictureBody& floor = floor_.emplace();
  floor.shape = Shape::plane();
  floor.motion = Motion::Static;
  floor.key = kFloorKey;
  const Vec3 level = camera_.target - up * dot(camera_.target, up);
  floor.position = level + up * (lowest - kFloorGap * length(camera_.eye - camera_.target));
  const Vec3 axis = cross(Vec3{0, 0, 1}, up);
  floor.orientation = length(axis) > 1e-9 ? fromAxisAngle(normalize(axis), std::acos(up.z))
                      : up.z > 0          ? Quat{}
                                          : Quat{0, 1, 0, 0};
}

void ViewPlan::leaveWallsOut(Sightlines& sight, const Vec3& eye) {
  for (Sightlines::View view = sight.from(eye); view.visible < 1 - kHidden && !view.hiding.empty();
       view = sight.from(eye)) {
    const auto worst = std::ranges::max_element(view.hiding, {},
                                                [](const auto& wall) { return wall.second; });
    hidden_.insert(worst->first);
    sight.removeWall(worst->first);
  }
}

bool ViewPlan::isGone(const io::PictureBody& body) const {
  return !(length(body.position - start_) <= reach_);
}

Camera ViewPlan::camera(std::span<const io::PictureBody> bodies) const {
  if (!follows_) return camera_;
  const Box box = boxOf(bodies, moves);
  if (box.empty()) return camera_;
  Camera camera = camera_;
  const Vec3 way = box.middle() - middle_;
  camera.eye += way, camera.target += way;
  return camera;
}

std::vector<io::PictureBody> ViewPlan::shown(std::vector<io::PictureBody> bodies) const {
  std::erase_if(bodies, [&](const io::PictureBody& body) {
    return body.motion != Motion::Dynamic && !body.deforms && hidden_.contains(body.key);
  });
  if (!floor_) return bodies;
  for (io::PictureBody& body : bodies)
    if (body.key >= io::kStandKeys && body.key < kFloorKey) reachTheFloor(body);
  bodies.insert(bodies.begin(), *floor_);
  return bodies;
}

void ViewPlan::reachTheFloor(io::PictureBody& stand) const {
  const Vec3 up = rotate(floor_->orientation, Vec3{0, 0, 1}), x = rotate(stand.orientation, Vec3{1, 0, 0});
  double& half = stand.shape.halfExtents.x;
  if (stand.shape.type != ShapeType::Box || std::fabs(dot(x, up)) < kUpright) return;
  const double gap = dot(stand.position - floor_->position, up) - half;
  if (gap > 0) half += gap / 2, stand.position -= up * (gap / 2);
}

}  // namespace rubble::render
