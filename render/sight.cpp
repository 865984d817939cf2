#include "render/sight.h"

#include <algorithm>
#include <cmath>

namespace rubble::render {
namespace {

bool isSolid(const io::PictureBody& body) {
  return std::isfinite(dot(body.position, body.position)) && body.shape.type != ShapeType::Plane;
}

Scene wallsOf(std::span<const io::PictureBody> bodies, std::vector<std::uint32_t>& keys) {
  Scene scene;
  for (const io::PictureBody& body : bodies) {
    if (!isSolid(body) || body.deforms || body.motion == Motion::Dynamic || body.key >= io::kStandKeys)
      continue;
    BodyDef& def = scene.bodies.emplace_back();
    def.motion = Motion::Static;
    def.shape = body.shape;
    def.position = body.position, def.orientation = normalize(body.orientation);
    keys.push_back(body.key);
  }
  return scene;
}

WorldOptions oneThread() {
  WorldOptions options;
  options.threads = 1;
  return options;
}

Vec3 middleOf(const io::PictureBody& body) {
  if (!body.deforms) return body.position;
  Vec3 sum;
  const std::vector<Vec3>& points = body.shape.geometry->points;
  for (const Vec3& p : points) sum += p / static_cast<double>(points.size());
  return body.position + sum;
}

}  // namespace

Sightlines::Sightlines(std::span<const std::vector<io::PictureBody>> moments, int targets)
    : world_(wallsOf(moments.front(), keys_), oneThread()) {
  std::vector<const io::PictureBody*> moving;
  for (const std::size_t moment : {std::size_t{0}, moments.size() / 2, moments.size() - 1})
    for (const io::PictureBody& body : moments[moment])
      if (isSolid(body) && body.motion == Motion::Dynamic) moving.push_back(&body);
  const std::size_t step = moving.size() / static_cast<std::size_t>(targets) + 1;
  for (std::size_t i = 0; i < moving.size(); i += step) targets_.push_back(middleOf(*moving[i]));
}

Sightlines::View Sightlines::from(const Vec3& eye) {
  View view;
  std::vector<RayQuery> rays;
  for (const Vec3& target : targets_)
    rays.push_back({eye, target - eye, std::max(1e-9, length(target - eye)), {}});
  int seen = 0;
  for (const RayHit& hit : world_.castRays(rays))
    hit.hit ? ++view.hiding[keys_[static_cast<std::size_t>(hit.body.index)]] : ++seen;
  if (!targets_.empty()) view.visible = seen / static_cast<double>(targets_.size());
  return view;
}

void Sightlines::removeWall(std::uint32_t key) {
  for (const BodyId id : world_.bodies())
    if (keys_[static_cast<std::size_t>(id.index)] == key) world_.removeBody(id);
}

}  // namespace rubble::render
