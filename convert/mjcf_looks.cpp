/// What is seen: <texture>, <material>, the shapes and colors of geoms, <camera> and <light>.
#include <algorithm>
#include <numbers>

#include "convert/mjcf_reader.h"
#include "convert/rotations.h"
#include "io/picture.h"

namespace rubble::convert {
namespace {

/// Groups of geoms that the viewer of MuJoCo shows.
constexpr int kLastShownGroup = 2;
constexpr int kLowestGroup = -1000, kHighestGroup = 1000;
/// The color of a geom that says nothing of it.
constexpr std::array<double, 4> kUsualColor{0.5, 0.5, 0.5, 1};
constexpr double kUsualFieldOfView = 45;  // degrees
constexpr double kDegree = std::numbers::pi / 180;

std::array<double, 4> colorOf(const Tag& tag, const std::array<double, 4>& usual) {
  std::array<double, 4> out = usual;
  if (const auto given = tag.numbers("rgba", 1, 4)) std::copy(given->begin(), given->end(), out.begin());
  return out;
}

Vec3 within(const Vec3& color) {
  return {std::clamp(color.x, 0., 1.), std::clamp(color.y, 0., 1.), std::clamp(color.z, 0., 1.)};
}

Vec3 meanColor(const io::Image& picture) {
  Vec3 sum;
  const std::size_t count = picture.rgb.size() / 3;
  for (std::size_t i = 0; i < picture.rgb.size(); ++i)
    sum[static_cast<int>(i % 3)] += static_cast<double>(picture.rgb[i]) / 255;
  return count > 0 ? sum / static_cast<double>(count) : Vec3{1, 1, 1};
}

}  // namespace

void MjcfReader::readTexture(const Tag& tag) {
  source_.use(tag.node());
  std::string name = tag.name();
  const std::size_t builtin = tag.choice("builtin", {"none", "gradient", "checker", "flat"}, 0);
  const Vec3 first = tag.vector("rgb1").value_or(Vec3{.8, .8, .8}),
             second = tag.vector("rgb2").value_or(Vec3{.5, .5, .5});
  Vec3 mean = builtin == 3 ? first : (first + second) / 2;
  if (builtin == 0 && tag.has("file")) {
    std::string file = tag.need("file");
    if (name.empty()) name = std::filesystem::path(file).stem().string();
    try {
      if (!file.ends_with(".png")) throw Error(tag.path("file"), "a picture in PNG", file);
      mean = meanColor(io::readPng(assetFile(tag, compiler_.textureFolder).string()));
    } catch (const Error& error) {
      report_.note(Effect::None, tag.place(), "texture" + inQuotes(name), error.what());
      mean = {1, 1, 1};
    }
  }
  textures_[name] = within(mean);
}

void MjcfReader::readMaterial(const Tag& tag) {
  source_.use(tag.node());
  MjcfMaterial material{colorOf(tag, {1, 1, 1, 1}), tag.text("texture").value_or("")};
  for (const pugi::xml_node& layer : source_.children(tag.node(), "layer")) {
    source_.use(layer);
    const Tag own(source_, layer);
    if (own.text("role").value_or("rgb").starts_with("rgb"))
      material.texture = own.text("texture").value_or("");
  }
  materials_[tag.name()] = material;
}

void MjcfReader::addDrawn(const Tag& tag, const MjcfScope& scope, DrawnShape drawn) {
  const int group = tag.whole("group", kLowestGroup, kHighestGroup).value_or(0);
  const MjcfMesh* const mesh = meshOf(tag);
  const auto material = materials_.find(tag.text("material").value_or(mesh ? mesh->material : ""));
  std::array<double, 4> color = colorOf(tag, kUsualColor);
  const bool hasColor = material != materials_.end() || tag.has("rgba");
  if (material != materials_.end()) {
    // a geom that has the usual color takes that of its material
    if (color == kUsualColor) color = material->second.color;
    const auto texture = textures_.find(material->second.texture);
    for (std::size_t k = 0; texture != textures_.end() && k < 3; ++k)
      color[k] *= texture->second[static_cast<int>(k)];
  }
  if (group < 0 || group > kLastShownGroup || !(color[3] > 0)) return;
  if (hasColor) drawn.color = within({color[0], color[1], color[2]});
  link(scope.link).drawn.push_back(std::move(drawn));
}

void MjcfReader::readCamera(const Tag& tag, const MjcfScope& scope) {
  const std::size_t mode = tag.choice("mode", {"fixed", "track", "trackcom", "targetbody", "targetbodycom"},
                                      0);
  if (mode > 0) report_.note(Effect::None, tag.place(), "camera.mode", "the camera does not move");
  const double angle = tag.number("fovy", kUsualFieldOfView);
  if (!(angle > 0 && angle < 180)) tag.fail("fovy", "an angle above 0 and below 180", std::to_string(angle));
  MjcfCamera& camera = cameras_.emplace_back(
      MjcfCamera{tag.name(), scope.link, scope.pose * poseOf(tag), angle * kDegree, "", -1, tag.place()});
  if (!camera.name.empty()) camera.name += scope.suffix;
  if (mode >= 3) camera.target = tag.need("target") + scope.suffix;
}

void MjcfReader::readLight(const Tag& tag, const MjcfScope& scope) {
  const bool isSun = tag.flag("directional", false) || tag.text("type").value_or("") == "directional";
  const Vec3 direction = tag.vector("dir").value_or(Vec3{0, 0, -1});
  if (!isSun || sun_ || !tag.flag("active", true) || !(length(direction) > 1e-9)) {
    tag.useAll();
    return report_.note(Effect::None, tag.place(), tag.describe(),
                        "pictures have one sun: the first light that is directional");
  }
  sun_ = {scope.link, scope.pose, direction, tag.place(), tag.describe()};
}

void MjcfReader::finishViews() {
  for (MjcfCamera& camera : cameras_) {
    if (camera.target.empty() || camera.targetLink >= 0) continue;
    const auto found = linkByName_.find(camera.target);
    if (found != linkByName_.end())
      camera.targetLink = found->second;
    else
      report_.note(Effect::None, camera.place, "camera" + inQuotes(camera.name),
                   "the body that it looks at is not there");
  }
  if (level_ > 0) return;
  for (const MjcfCamera& camera : cameras_) {
    Pose pose = referencePose(camera.link) * camera.pose;
    if (camera.targetLink >= 0) {
      const Vec3 back = pose.p - referencePose(camera.targetLink).p, right = cross(Vec3{0, 0, 1}, back);
      if (length(right) > 1e-9 * length(back)) {
        const Vec3 x = normalize(right), z = normalize(back);
        pose.q = quatOfAxes(x, cross(z, x), z);
      } else if (length(back) > 0) {
        pose.q = quatOfZ(back);
      }
    }
    model_.cameras.push_back({camera.name, pose, camera.fieldOfView});
    report_.converted(camera.place, "camera" + inQuotes(camera.name), "camera");
  }
  if (!sun_) return;
  model_.toSun = -normalize(rotate((referencePose(sun_->link) * sun_->pose).q, sun_->direction));
  report_.converted(sun_->place, sun_->what, "sun");
}

}  // namespace rubble::convert
