#include "apps/cli/render_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "render/canvas.h"
#include "render/framing.h"

namespace rubble::cli {
namespace {

/// Room for rubble on every side of a scene that is smashed, over its height.
constexpr double kRubbleRoom = .3;
constexpr std::uint8_t kDividerGrey = 250;

/// Where a named camera looks along: across from the scene's own view, away from it, and down.
struct Direction {
  const char* name;
  double away, right, down;
  double closer = 1;  ///< distance over that of a view of everything
};
constexpr Direction kDirections[] = {{"front", 1, 0, .12},     {"side", 0, -1, .12},   {"back", -1, 0, .12},
                                     {"top", .02, 0, 1},       {"corner", 1, -1, .75}, {"low", 1, -.55, .06},
                                     {"close", 1, -.7, .3, .5}};

}  // namespace

const std::vector<std::string>& cameraNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"scene"};
    for (const Direction& direction : kDirections) all.emplace_back(direction.name);
    return all;
  }();
  return names;
}

Sight sightOf(const scenes::Job& job) {
  return {job.camera, job.scene.gravity, io::pictureBodies(job.scene, true), job.smashStep >= 0};
}

namespace {

/// Where a named camera looks along, and its distance over that of a view of everything.
std::pair<Vec3, double> directionOf(const std::string& name, const scenes::Camera& own, const Vec3& gravity) {
  const Vec3 up = normalize(-gravity, {0, 0, 1});
  Vec3 direction = own.target - own.eye;
  double closer = 1;
  if (name != "scene") {
    const auto found = std::find_if(std::begin(kDirections), std::end(kDirections),
                                    [&](const Direction& d) { return name == d.name; });
    if (found == std::end(kDirections))
      throw Error("--camera", fmt::format("one of {}", fmt::join(cameraNames(), ", ")), name);
    // Level, along the axis that the scene's own view is nearest to.
    Vec3 away = direction - up * dot(direction, up);
    if (lengthSquared(away) == 0)
      away = std::fabs(up.x) < .9 ? cross(up, Vec3{1, 0, 0}) : cross(up, Vec3{0, 1, 0});
    int axis = 0;
    for (int i = 1; i < 3; ++i)
      if (std::fabs(away[i]) > std::fabs(away[axis])) axis = i;
    Vec3 level;
    level[axis] = away[axis] > 0 ? 1 : -1;
    direction = normalize(level) * found->away + cross(level, up) * found->right - up * found->down;
    closer = found->closer;
  }
  return {direction, closer};
}

}  // namespace

render::Camera cameraOf(const std::string& name, const Sight& sight, int width, int height,
                        double fieldOfView) {
  const auto [direction, closer] = directionOf(name, sight.own, sight.gravity);
  const double aspect = static_cast<double>(width) / height;
  render::Camera camera = render::cameraShowing(
      sight.bodies, sight.gravity, {direction, sight.smashes ? kRubbleRoom : 0, aspect, fieldOfView, closer});
  return camera;
}

render::ViewPlan planOf(const std::string& name, const MomentSource& source,
                        std::span<const std::vector<io::PictureBody>> moments, int width, int height,
                        double fieldOfView, const std::optional<Vec3>& eye) {
  const auto [direction, closer] = directionOf(name, source.camera(), source.gravity());
  // rubble of a run that is not known ahead needs room
  const double room = source.smashes() && moments.size() == 1 ? kRubbleRoom : 0;
  render::Framing framing{direction, room, static_cast<double>(width) / height, fieldOfView};
  framing.closer = closer;
  return render::ViewPlan(moments, source.gravity(), framing, name == "scene" && !eye, eye);
}

render::Camera turned(const render::Camera& camera, double angle) {
  render::Camera result = camera;
  result.eye = camera.target + rotate(fromAxisAngle(normalize(camera.up), angle), camera.eye - camera.target);
  return result;
}

std::string grouped(long long number) {
  std::string digits = std::to_string(number);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

void drawCaption(io::Image& image, const Caption& caption) {
#if defined(RUBBLE_HAS_CAIRO)
  const double scale = std::max(.5, image.height / 720.);
  render::Canvas canvas(image, scale);
  const render::TextStyle title{17, {0x26221d, .95}, true, render::Align::Start, 0},
      facts{13.5, {0x3a352f, .92}, false, render::Align::Start, 0};
  const std::string line = fmt::format("{}", fmt::join(caption.facts, "  ·  "));
  const double height = 54, margin = 18, inside = 14, bottom = image.height / scale - margin;
  const double width = std::max(canvas.textWidth(caption.title, title), canvas.textWidth(line, facts)) +
                       2 * inside;
  canvas.rectangle({margin, bottom - height}, width, height, {0xffffff, .62}, 7);
  canvas.text({margin + inside, bottom - height + 22}, caption.title, title);
  canvas.text({margin + inside, bottom - height + 42}, line, facts);
  canvas.finish();
#else
  (void)image, (void)caption;
#endif
}

io::Image beside(const io::Image& left, const io::Image& right) {
  io::Image image{left.width + kDivider + right.width, std::min(left.height, right.height), {}};
  for (int y = 0; y < image.height; ++y) {
    for (const io::Image* side : {&left, &right}) {
      const auto row = side->rgb.begin() + 3ll * y * side->width;
      if (side == &right) image.rgb.insert(image.rgb.end(), 3 * kDivider, kDividerGrey);
      image.rgb.insert(image.rgb.end(), row, row + 3ll * side->width);
    }
  }
  return image;
}

}  // namespace rubble::cli
