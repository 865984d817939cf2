#include "apps/viewer/scene_view.h"

#include <algorithm>
#include <cmath>

#include "render/framing.h"

namespace rubble::viewer {
namespace {

/// A joint is picked within so many pixels of its anchor.
constexpr double kJointReach = 10;
/// A selection is looked at from so many times its size.
constexpr double kFrameDistance = 9;
constexpr float kSelectedWidth = 3, kSelectedDot = 9;
constexpr std::uint32_t kSelectedColor = 0xe08a12;

render::Camera cameraShowing(Session& session, int width, int height) {
  const scenes::Camera own = session.camera();
  const double aspect = static_cast<double>(width) / height;
  return render::cameraShowing(session.framed(), session.gravity(), {own.target - own.eye, .2, aspect, .5});
}

void addSelection(World& world, const Selection& selection, double size, std::vector<render::Line>& lines) {
  if (selection.joint && world.alive(*selection.joint)) {
    for (const int side : {0, 1}) {
      const render::Frame frame = render::jointFrame(world, *selection.joint, side);
      render::addFrame(frame, size, kSelectedWidth, lines);
      lines.push_back({frame.position, frame.position, kSelectedColor, kSelectedDot});
    }
  }
  if (selection.object && world.alive(*selection.object) && selection.vertex >= 0) {
    const Vec3 p = world.positions(*selection.object)[static_cast<std::size_t>(selection.vertex)];
    lines.push_back({p, p, kSelectedColor, kSelectedDot});
  }
}

int nearestVertex(const World& world, DeformableId object, const Vec3& point) {
  const std::vector<Vec3> x = world.positions(object);
  const auto nearest = std::min_element(x.begin(), x.end(), [&](const Vec3& a, const Vec3& b) {
    return lengthSquared(a - point) < lengthSquared(b - point);
  });
  return static_cast<int>(nearest - x.begin());
}

std::optional<DeformableId> objectWithKey(const World& world, std::uint32_t key) {
  for (const DeformableId id : world.deformables())
    if (static_cast<std::uint32_t>(id.index) == (key & (io::kSoftKeys - 1)) >> io::kSoftKeyBits) return id;
  return std::nullopt;
}

}  // namespace

void SceneView::begin(Session& session, int width, int height) {
  width_ = width, height_ = height;
  stages_.clear();
  // Software rendering: a responsive window matters more than fine shadows.
  if (render::gl::drawsInSoftware()) quality_ = {1, 1024, 2, 4};
  const int sideWidth = std::max(1, width / session.sides());
  orbit = Orbit(cameraShowing(session, sideWidth, height));
  for (int side = 0; side < session.sides(); ++side)
    stages_.push_back(std::make_unique<render::Stage>(session.bodies(side, io::ColorBy::Body),
                                                      session.gravity(), orbit.camera(), sideWidth, height,
                                                      session.appearance()));
}

void SceneView::draw(Session& session, UiState& uiState, int width, int height) {
  width_ = width, height_ = height;
  uiState.fullValue = 0;
  for (int side = 0; side < session.sides(); ++side) {
    render::Stage& stage = *stages_[static_cast<std::size_t>(side)];
    render::Renderer& renderer = stage.renderer();
    Player* player = session.live();
    if (player && uiState.colorBy == io::ColorBy::Body)
      stage.follow(player->world(side));
    else
      stage.setBodies(session.bodies(side, uiState.colorBy), uiState.colorBy);
    uiState.fullValue = std::max(uiState.fullValue, stage.fullValue());
    std::vector<render::Line> lines;
    int selected = -1;
    if (player) {
      World& world = player->world(side);
      if (uiState.overlays.any())
        lines = render::overlayLines(world, uiState.overlays, stage.setting().bodySize);
      addSelection(world, uiState.selection, stage.setting().bodySize, lines);
      if (uiState.selection.body) {
        const auto& keys = stage.keys();
        const auto at = std::find(keys.begin(), keys.end(),
                                  static_cast<std::uint32_t>(uiState.selection.body->index));
        if (at != keys.end()) selected = static_cast<int>(at - keys.begin());
      }
    }
    renderer.resize(sideWidth(), height);
    renderer.select(selected);
    renderer.setLines(lines);
    renderer.draw(orbit.camera(), stage.setting(), quality_);
    renderer.show(0, side * sideWidth());
  }
}

double SceneView::across(double x) const { return std::fmod(x, sideWidth()) / sideWidth(); }

Vec3 SceneView::ray(double x, double y) const { return orbit.ray(across(x), y / height_, aspect()); }

double SceneView::depthOf(const Vec3& point) const {
  const render::Camera camera = orbit.camera();
  return dot(point - camera.eye, normalize(camera.target - camera.eye));
}

Vec3 SceneView::pointAt(double x, double y, double depth) const {
  const render::Camera camera = orbit.camera();
  const Vec3 along = ray(x, y);
  return camera.eye + along * (depth / dot(along, normalize(camera.target - camera.eye)));
}

PickResult SceneView::pick(Session& session, double x, double y) const {
  PickResult picked;
  picked.side = std::clamp(static_cast<int>(x) / sideWidth(), 0, static_cast<int>(stages_.size()) - 1);
  render::Stage& stage = *stages_[static_cast<std::size_t>(picked.side)];
  const int px = static_cast<int>(x) - picked.side * sideWidth(), py = static_cast<int>(y);
  const int body = stage.renderer().bodyAt(px, py), surface = stage.renderer().surfaceAt(px, py);
  if (body < 0 && surface < 0) return picked;
  picked.something = true;
  picked.point = stage.renderer().pointAt(px, py);
  if (!session.live()) return picked;
  World& world = session.live()->world(picked.side);
  const std::uint32_t key = body >= 0 ? stage.keys()[static_cast<std::size_t>(body)]
                                      : stage.surfaceKeys()[static_cast<std::size_t>(surface)];
  if (key == io::kRopeKey) return picked;
  if (key < io::kSoftKeys) {
    picked.what.body = session.live()->bodyWithKey(key);
  } else if (const auto object = objectWithKey(world, key)) {
    picked.what.object = object;
    picked.what.vertex = nearestVertex(world, *object, picked.point);
  }
  return picked;
}

std::optional<JointId> SceneView::jointAt(Player& player, double x, double y) const {
  std::optional<JointId> best;
  double nearest = kJointReach;
  for (const JointId id : player.world().joints()) {
    for (const int side : {0, 1}) {
      const auto place = orbit.place(render::jointFrame(player.world(), id, side).position, aspect());
      if (!place) continue;
      const double away = std::hypot((*place)[0] * sideWidth() - std::fmod(x, sideWidth()),
                                     (*place)[1] * height_ - y);
      if (away < nearest) nearest = away, best = id;
    }
  }
  return best;
}

void SceneView::frame(Session& session, const Selection& selection) {
  Player* player = session.live();
  if (!player || !selection.any()) {
    orbit = Orbit(cameraShowing(session, sideWidth(), height_));
    return;
  }
  World& world = player->world();
  if (selection.body) {
    double radius = bodySize();
    for (const io::PictureBody& body : io::pictureBodies(world))
      if (body.key == static_cast<std::uint32_t>(selection.body->index))
        radius = io::extentAlong(body, normalize(Vec3{1, 1, 1}));
    orbit.aim(world.state(*selection.body).position, kFrameDistance * std::max(radius, bodySize()));
  } else if (selection.joint) {
    orbit.aim(render::jointFrame(world, *selection.joint, 0).position, kFrameDistance * bodySize());
  } else {
    orbit.aim(world.positions(*selection.object)[static_cast<std::size_t>(std::max(0, selection.vertex))],
              kFrameDistance * bodySize());
  }
}

}  // namespace rubble::viewer
