#include "render/camera.h"

#include <algorithm>
#include <cmath>

#include <rubble/error.h>

namespace rubble::render {

void Bounds::add(const Vec3f& p) {
  low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
  high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
}

void Bounds::add(const Bounds& other) {
  if (other.empty()) return;
  add(other.low);
  add(other.high);
}

bool touches(const Bounds& bounds, const std::vector<HalfSpace>& spaces) {
  const Vec3f middle = bounds.middle(), half = bounds.half();
  return std::all_of(spaces.begin(), spaces.end(), [&](const HalfSpace& space) {
    return dot(space.normal, middle) + space.offset + dot(abs(space.normal), half) >= 0;
  });
}

float distanceTo(const Bounds& bounds, const Vec3f& point) {
  Vec3f away;
  for (int axis = 0; axis < 3; ++axis)
    away[axis] = std::max({bounds.low[axis] - point[axis], point[axis] - bounds.high[axis], 0.f});
  return length(away);
}

Eye::Eye(const Camera& camera, const Vec3& origin, int width, int height) {
  if (width < 1 || height < 1)
    throw Error("picture.size", "at least one pixel", std::to_string(width) + "x" + std::to_string(height));
  if (!(camera.fieldOfView > 0 && camera.fieldOfView < 3.1))
    throw Error("picture.fieldOfView", "an angle above 0 and below 3.1 rad",
                std::to_string(camera.fieldOfView));
  const double distance = length(camera.target - camera.eye);
  if (!(distance > 0)) throw Error("picture.eye", "a point other than the target", "the target");
  const Vec3 ahead = (camera.target - camera.eye) / distance;
  const Vec3 across = cross(ahead, camera.up);
  // Straight up or down there is no natural right: any will do.
  const Vec3 spare = cross(ahead, std::fabs(ahead.x) < .9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  const Vec3 side = normalize(lengthSquared(across) > 1e-18 * lengthSquared(camera.up) ? across : spare);
  position = Vec3f(camera.eye - origin);
  forward = Vec3f(ahead);
  right = Vec3f(side);
  up = Vec3f(cross(side, ahead));
  const double tall = std::tan(camera.fieldOfView / 2);
  spanY = static_cast<float>(tall);
  spanX = static_cast<float>(tall * width / height);
  nearest = static_cast<float>(1e-3 * distance);
  pixelAngle = static_cast<float>(2 * tall / height);
}

Matrix Eye::viewProjection(float jitterX, float jitterY) const {
  // Rows: x / spanX + jitter z, y / spanY + jitter z, z - 2 nearest, z.
  const Vec3f rows[4] = {right * (1 / spanX) + forward * jitterX, up * (1 / spanY) + forward * jitterY,
                         forward, forward};
  Matrix m;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      m.columns[4 * axis + row] = rows[row][static_cast<int>(axis)];
    m.columns[12 + row] = -dot(rows[row], position) - (row == 2 ? 2 * nearest : 0);
  }
  return m;
}

std::vector<HalfSpace> Eye::halfSpaces() const {
  std::vector<HalfSpace> spaces;
  const auto add = [&](const Vec3f& normal, float offset) {
    spaces.push_back({normal, offset - dot(normal, position)});
  };
  add(forward, 0);
  for (const float side : {-1.f, 1.f}) {
    add(normalize(forward * spanX + right * side), 0);
    add(normalize(forward * spanY + up * side), 0);
  }
  return spaces;
}

Vec3f Eye::at(float x, float y, float depth) const {
  return position + (forward + right * (x * spanX) + up * (y * spanY)) * depth;
}

}  // namespace rubble::render
