#include "cook/solid_mass.h"

#include <algorithm>
#include <cmath>

namespace rubble {

namespace {

struct Symmetric {
  double m[3][3];
};

/// Eigenvectors of a symmetric matrix as columns, by Jacobi rotations. The matrix becomes diagonal.
void diagonalize(Symmetric& a, double (&axes)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) axes[i][j] = i == j;
  constexpr int kSweeps = 32;
  const double scale = std::fabs(a.m[0][0]) + std::fabs(a.m[1][1]) + std::fabs(a.m[2][2]);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const double off = std::fabs(a.m[0][1]) + std::fabs(a.m[0][2]) + std::fabs(a.m[1][2]);
    // round-off of a frame that is already principal
    if (off <= 1e-12 * scale) return;
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (a.m[p][q] == 0) continue;
        const double theta = (a.m[q][q] - a.m[p][p]) / (2 * a.m[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const double kp = a.m[k][p], kq = a.m[k][q];
          a.m[k][p] = c * kp - s * kq, a.m[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < 3; ++k) {
          const double pk = a.m[p][k], qk = a.m[q][k];
          a.m[p][k] = c * pk - s * qk, a.m[q][k] = s * pk + c * qk;
        }
        for (int k = 0; k < 3; ++k) {
          const double kp = axes[k][p], kq = axes[k][q];
          axes[k][p] = c * kp - s * kq, axes[k][q] = s * kp + c * kq;
        }
      }
    }
  }
}

/// The quaternion of a rotation matrix given by columns (Shepperd 1978: largest component first).
Quat quaternionOf(const double (&r)[3][3]) {
  const double trace = r[0][0] + r[1][1] + r[2][2];
  double q[4];
  int largest = 0;
  const double sizes[4] = {trace, r[0][0], r[1][1], r[2][2]};
  for (int i = 1; i < 4; ++i)
    if (sizes[i] > sizes[largest]) largest = i;
  if (largest == 0) {
    q[0] = 1 + trace, q[1] = r[2][1] - r[1][2], q[2] = r[0][2] - r[2][0], q[3] = r[1][0] - r[0][1];
  } else {
    const int i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
    q[0] = r[k][j] - r[j][k];
    q[1 + i] = 1 + r[i][i] - r[j][j] - r[k][k];
    q[1 + j] = r[j][i] + r[i][j];
    q[1 + k] = r[k][i] + r[i][k];
  }
  return normalize(Quat{q[0], q[1], q[2], q[3]});
}

}  // namespace

SolidSums& SolidSums::operator+=(const SolidSums& b) {
  volume += b.volume;
  first += b.first;
  for (std::size_t i = 0; i < 6; ++i) second[i] += b.second[i];
  return *this;
}

SolidSums tetrahedronSums(const Vec3& a, const Vec3& b, const Vec3& c) {
  // the integral of x_i x_j over (0, a, b, c) is V/20 (s_i s_j + a_i a_j + b_i b_j + c_i c_j) with s = a + b
  // + c
  SolidSums out;
  const double volume = dot(a, cross(b, c)) / 6;
  const Vec3 s = a + b + c;
  out.volume = volume;
  out.first = s * (volume / 4);
  const auto incidence = [&](int i, int j) {
    return volume / 20 * (s[i] * s[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j]);
  };
  out.second = {incidence(0, 0), incidence(1, 1), incidence(2, 2),
                incidence(0, 1), incidence(0, 2), incidence(1, 2)};
  return out;
}

SolidSums boxSums(const Vec3& h) {
  const double v = 8 * h.x * h.y * h.z;
  return {v, {}, {v / 3 * h.x * h.x, v / 3 * h.y * h.y, v / 3 * h.z * h.z, 0, 0, 0}};
}

SolidSums sumsOf(const MassProperties& mass) {
  SolidSums s;
  s.volume = mass.mass;
  const Vec3& i = mass.inertia;
  s.second = {(i.y + i.z - i.x) / 2, (i.x + i.z - i.y) / 2, (i.x + i.y - i.z) / 2, 0, 0, 0};
  return placed(s, mass.center, mass.axes, 1);
}

SolidSums placed(const SolidSums& s, const Vec3& position, const Quat& q, double density) {
  const Mat3 r = rotationMatrix(q);
  const Mat3 m{{s.second[0], s.second[3], s.second[4]},
               {s.second[3], s.second[1], s.second[5]},
               {s.second[4], s.second[5], s.second[2]}};
  const Mat3 turned = r * m * transpose(r);
  const Vec3 first = r * s.first;
  const Mat3& t = turned;
  const auto incidence = [&](int i, int j, double own) {
    return density *
           (own + first[i] * position[j] + position[i] * first[j] + s.volume * position[i] * position[j]);
  };
  SolidSums out;
  out.volume = density * s.volume;
  out.first = density * (first + s.volume * position);
  out.second = {incidence(0, 0, t.c0.x), incidence(1, 1, t.c1.y), incidence(2, 2, t.c2.z),
                incidence(0, 1, t.c1.x), incidence(0, 2, t.c2.x), incidence(1, 2, t.c2.y)};
  return out;
}

MassProperties principal(const SolidSums& s) {
  MassProperties out;
  out.mass = s.volume;
  out.center = s.first / s.volume;
  const SolidSums c = placed(s, -out.center, Quat{}, 1);
  const double xx = c.second[0], yy = c.second[1], zz = c.second[2];
  Symmetric inertia{{{yy + zz, -c.second[3], -c.second[4]},
                     {-c.second[3], xx + zz, -c.second[5]},
                     {-c.second[4], -c.second[5], xx + yy}}};
  double axes[3][3];
  diagonalize(inertia, axes);
  const Vec3 a{axes[0][0], axes[1][0], axes[2][0]}, b{axes[0][1], axes[1][1], axes[2][1]},
      e{axes[0][2], axes[1][2], axes[2][2]};
  if (dot(cross(a, b), e) < 0)
    for (auto& row : axes) row[2] = -row[2];
  out.axes = quaternionOf(axes);
  out.inertia = {inertia.m[0][0], inertia.m[1][1], inertia.m[2][2]};
  return out;
}

}  // namespace rubble
