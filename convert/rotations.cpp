#include "convert/rotations.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rubble::convert {

Quat quatOfAxes(const Vec3& x, const Vec3& y, const Vec3& z) {
  // Shepperd 1978: the largest component first
  const double trace = x.x + y.y + z.z;
  if (trace >= std::max({x.x, y.y, z.z})) return normalize(Quat{1 + trace, y.z - z.y, z.x - x.z, x.y - y.x});
  if (x.x >= std::max(y.y, z.z)) return normalize(Quat{y.z - z.y, 1 + x.x - y.y - z.z, x.y + y.x, z.x + x.z});
  if (y.y >= z.z) return normalize(Quat{z.x - x.z, x.y + y.x, 1 + y.y - x.x - z.z, y.z + z.y});
  return normalize(Quat{x.y - y.x, z.x + x.z, y.z + z.y, 1 + z.z - x.x - y.y});
}

Quat quatOfZ(const Vec3& direction) {
  const Vec3 z = normalize(direction);
  const Vec3 axis = cross(Vec3{0, 0, 1}, z);
  const double sine = length(axis);
  if (sine < 1e-10) return z.z > 0 ? Quat{} : Quat{0, 1, 0, 0};
  return fromAxisAngle(axis / sine, std::atan2(sine, z.z));
}

Quat quatOfEuler(const Vec3& angles, const std::string& sequence) {
  Quat out;
  for (int i = 0; i < 3; ++i) {
    const char letter = sequence[static_cast<std::size_t>(i)];
    const bool fixed = letter >= 'X' && letter <= 'Z';
    const int k = letter - (fixed ? 'X' : 'x');
    const Quat turn = fromAxisAngle(Vec3{k == 0 ? 1. : 0., k == 1 ? 1. : 0., k == 2 ? 1. : 0.}, angles[i]);
    out = fixed ? turn * out : out * turn;
  }
  return normalize(out);
}

Vec3 rotationVector(const Quat& q) {
  const double sine = length(q.v), sign = q.s < 0 ? -1 : 1;
  return sine > 0 ? 2 * sign * std::atan2(sine, sign * q.s) / sine * q.v : Vec3{};
}

}  // namespace rubble::convert
