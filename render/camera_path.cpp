#include "render/camera_path.h"

#include <algorithm>
#include <fstream>
#include <numbers>
#include <sstream>
#include <utility>

#include "io/definition_json.h"

namespace rubble::render {
namespace {

std::vector<CameraKey> readKeys(const std::string& file) {
  std::ifstream in(file);
  std::ostringstream text;
  if (!in) throw Error(file, "a file that can be read", "none");
  text << in.rdbuf();
  std::vector<CameraKey> keys;
  io::readDefinition(text.str(), file, [&](const io::Node& node) {
    for (const io::Node& element : node.elements("a list of key frames")) {
      io::ObjectReader object(element, "a key frame: \"time\", \"eye\", \"target\"");
      CameraKey& key = keys.emplace_back();
      if (const auto time = object.need("time", "of the film [s]")) key.time = time->number().value_or(0);
      if (const auto eye = object.need("eye", "three numbers [m]")) key.eye = eye->vector().value_or(Vec3{});
      if (const auto target = object.need("target", "three numbers [m]"))
        key.target = target->vector().value_or(Vec3{});
      double degrees = 0;
      object.read("fov", degrees, {1, true, 150, "an angle from 1 to 150 [degrees]"});
      key.fieldOfView = degrees * std::numbers::pi / 180;
      object.finish();
    }
  });
  return keys;
}

/// Derivative at key k of a curve with these times.
Vec3 slope(const std::vector<CameraKey>& keys, std::size_t k, Vec3 CameraKey::*member) {
  const CameraKey &before = keys[k == 0 ? 0 : k - 1], &after = keys[std::min(k + 1, keys.size() - 1)];
  return k == 0 || k + 1 == keys.size() ? Vec3{}
                                        : (after.*member - before.*member) / (after.time - before.time);
}

}  // namespace

CameraPath::CameraPath(const std::string& file) : CameraPath(readKeys(file), file) {}

CameraPath::CameraPath(std::vector<CameraKey> keys, const std::string& name) : keys_(std::move(keys)) {
  if (keys_.empty()) throw Error(name, "at least one key frame", "none");
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    if (k > 0 && !(keys_[k].time > keys_[k - 1].time))
      throw Error(Path(name)[k] + ".time",
                  "a time after that of the key before, " + std::to_string(keys_[k - 1].time),
                  std::to_string(keys_[k].time));
    if (keys_[k].eye == keys_[k].target)
      throw Error(Path(name)[k] + ".target", "a point other than the eye", "it");
  }
}

Camera CameraPath::at(double time, const Camera& usual) const {
  Camera camera = usual;
  const auto set = [&](const CameraKey& key) {
    camera.eye = key.eye, camera.target = key.target;
    if (key.fieldOfView > 0) camera.fieldOfView = key.fieldOfView;
    return camera;
  };
  if (time <= keys_.front().time) return set(keys_.front());
  if (time >= keys_.back().time) return set(keys_.back());
  const auto next = std::ranges::upper_bound(keys_, time, {}, &CameraKey::time);
  const auto k = static_cast<std::size_t>(next - keys_.begin()) - 1;
  const CameraKey &a = keys_[k], &b = keys_[k + 1];
  const double span = b.time - a.time, s = (time - a.time) / span, t = 1 - s;
  const auto curve = [&](Vec3 CameraKey::*member) {
    return a.*member * (t * t * (1 + 2 * s)) + b.*member * (s * s * (3 - 2 * s)) +
           (slope(keys_, k, member) * t - slope(keys_, k + 1, member) * s) * (s * t * span);
  };
  CameraKey key{time, curve(&CameraKey::eye), curve(&CameraKey::target), 0};
  const auto angle = [&](const CameraKey& of) {
    return of.fieldOfView > 0 ? of.fieldOfView : usual.fieldOfView;
  };
  key.fieldOfView = angle(a) * t + angle(b) * s;
  return set(key);
}

}  // namespace rubble::render
