#pragma once
/// Small vectors, quaternions and 3x3 matrices. The public API uses double, the solver float or double.
/// Conventions: right-handed frames, Hamilton quaternions with the scalar first, rotation body -> world, SI
/// units.
#include <cmath>
#include <limits>

#include <rubble/compiler.h>

namespace rubble {

template <class R> struct Vec3T {
  R x{}, y{}, z{};

  constexpr Vec3T() = default;
  RUBBLE_HD constexpr Vec3T(R x_, R y_, R z_) : x(x_), y(y_), z(z_) {}
  template <class S>
  RUBBLE_HD constexpr explicit Vec3T(const Vec3T<S>& o)
      : x(static_cast<R>(o.x)), y(static_cast<R>(o.y)), z(static_cast<R>(o.z)) {}

  RUBBLE_HD constexpr R operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  RUBBLE_HD constexpr R& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  RUBBLE_HD constexpr Vec3T operator-() const { return {-x, -y, -z}; }
  RUBBLE_HD constexpr Vec3T& operator+=(const Vec3T& b) {
    x += b.x, y += b.y, z += b.z;
    return *this;
  }
  RUBBLE_HD constexpr Vec3T& operator-=(const Vec3T& b) {
    x -= b.x, y -= b.y, z -= b.z;
    return *this;
  }
  RUBBLE_HD constexpr Vec3T& operator*=(R s) {
    x *= s, y *= s, z *= s;
    return *this;
  }
  RUBBLE_HD friend constexpr Vec3T operator+(Vec3T a, const Vec3T& b) { return a += b; }
  RUBBLE_HD friend constexpr Vec3T operator-(Vec3T a, const Vec3T& b) { return a -= b; }
  RUBBLE_HD friend constexpr Vec3T operator*(Vec3T a, R s) { return a *= s; }
  RUBBLE_HD friend constexpr Vec3T operator*(R s, Vec3T a) { return a *= s; }
  RUBBLE_HD friend constexpr Vec3T operator/(Vec3T a, R s) { return a *= R(1) / s; }
  friend constexpr bool operator==(const Vec3T&, const Vec3T&) = default;
};

template <class R> RUBBLE_HD constexpr R dot(const Vec3T<R>& a, const Vec3T<R>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class R> RUBBLE_HD RUBBLE_NEAR constexpr Vec3T<R> cross(const Vec3T<R>& a, const Vec3T<R>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class R> RUBBLE_HD constexpr Vec3T<R> mul(const Vec3T<R>& a, const Vec3T<R>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class R> RUBBLE_HD constexpr R lengthSquared(const Vec3T<R>& a) { return dot(a, a); }
template <class R> RUBBLE_HD inline R length(const Vec3T<R>& a) { return std::sqrt(dot(a, a)); }
template <class R> RUBBLE_HD inline Vec3T<R> abs(const Vec3T<R>& a) {
  return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)};
}
/// Least |a|^2 whose root has all bits of R: smaller numbers are denormal and have few (|a| = 1.1e-19 for
/// float, 1.5e-154 for double).
template <class R> inline constexpr R kLeastSquare = std::numeric_limits<R>::min();
/// a / |a|, or `fallback` if |a|^2 is below kLeastSquare.
template <class R>
RUBBLE_HD inline Vec3T<R> normalize(const Vec3T<R>& a, const Vec3T<R>& fallback = {R(0), R(0), R(1)}) {
  const R l2 = dot(a, a);
  return l2 >= kLeastSquare<R> ? a * (R(1) / std::sqrt(l2)) : fallback;
}

/// Quaternion (s, v) with the Hamilton product. A unit quaternion rotates body -> world.
template <class R> struct QuatT {
  R s{1};
  Vec3T<R> v{};

  constexpr QuatT() = default;
  RUBBLE_HD constexpr QuatT(R s_, const Vec3T<R>& v_) : s(s_), v(v_) {}
  RUBBLE_HD constexpr QuatT(R s_, R x, R y, R z) : s(s_), v(x, y, z) {}
  template <class S> RUBBLE_HD constexpr explicit QuatT(const QuatT<S>& o) : s(static_cast<R>(o.s)), v(o.v) {}
  friend constexpr bool operator==(const QuatT&, const QuatT&) = default;
};

template <class R> RUBBLE_HD RUBBLE_NEAR constexpr QuatT<R> operator*(const QuatT<R>& a, const QuatT<R>& b) {
  return {a.s * b.s - dot(a.v, b.v), a.s * b.v + b.s * a.v + cross(a.v, b.v)};
}
/// Inverse of a unit quaternion.
template <class R> RUBBLE_HD constexpr QuatT<R> conjugate(const QuatT<R>& q) { return {q.s, -q.v}; }
template <class R> RUBBLE_HD inline QuatT<R> normalize(const QuatT<R>& q) {
  const R inv = R(1) / std::sqrt(q.s * q.s + dot(q.v, q.v));
  return {q.s * inv, q.v * inv};
}
/// R(q) r
template <class R> RUBBLE_HD RUBBLE_NEAR constexpr Vec3T<R> rotate(const QuatT<R>& q, const Vec3T<R>& r) {
  const Vec3T<R> t = R(2) * cross(q.v, r);
  return r + q.s * t + cross(q.v, t);
}
/// R(q)^T r
template <class R> RUBBLE_HD constexpr Vec3T<R> rotateInverse(const QuatT<R>& q, const Vec3T<R>& r) {
  return rotate(conjugate(q), r);
}
/// Rotation by `angle` [rad] about the unit vector `axis`.
template <class R> RUBBLE_HD inline QuatT<R> fromAxisAngle(const Vec3T<R>& axis, R angle) {
  return {std::cos(angle / 2), axis * std::sin(angle / 2)};
}
/// In double precision a function of the library, which has the same bits with every C library.
QuatT<double> fromAxisAngle(const Vec3T<double>& axis, double angle);

/// 3x3 matrix, stored by columns.
template <class R> struct Mat3T {
  Vec3T<R> c0{1, 0, 0}, c1{0, 1, 0}, c2{0, 0, 1};

  RUBBLE_HD constexpr const Vec3T<R>& column(int i) const { return i == 0 ? c0 : i == 1 ? c1 : c2; }
  RUBBLE_HD friend constexpr Vec3T<R> operator*(const Mat3T& m, const Vec3T<R>& a) {
    return m.c0 * a.x + m.c1 * a.y + m.c2 * a.z;
  }
  RUBBLE_HD friend constexpr Mat3T operator*(const Mat3T& m, const Mat3T& n) {
    return {m * n.c0, m * n.c1, m * n.c2};
  }
  RUBBLE_HD friend constexpr Mat3T operator+(const Mat3T& m, const Mat3T& n) {
    return {m.c0 + n.c0, m.c1 + n.c1, m.c2 + n.c2};
  }
  RUBBLE_HD friend constexpr Mat3T operator*(R s, const Mat3T& m) { return {s * m.c0, s * m.c1, s * m.c2}; }
};

template <class R> RUBBLE_HD constexpr Mat3T<R> transpose(const Mat3T<R>& m) {
  return {{m.c0.x, m.c1.x, m.c2.x}, {m.c0.y, m.c1.y, m.c2.y}, {m.c0.z, m.c1.z, m.c2.z}};
}
template <class R> RUBBLE_HD constexpr Mat3T<R> rotationMatrix(const QuatT<R>& q) {
  return {rotate(q, {R(1), R(0), R(0)}), rotate(q, {R(0), R(1), R(0)}), rotate(q, {R(0), R(0), R(1)})};
}
/// M^T a
template <class R> RUBBLE_HD constexpr Vec3T<R> mulTransposed(const Mat3T<R>& m, const Vec3T<R>& a) {
  return {dot(m.c0, a), dot(m.c1, a), dot(m.c2, a)};
}
/// [a], the matrix with [a] b = a x b.
template <class R> RUBBLE_HD constexpr Mat3T<R> crossMatrix(const Vec3T<R>& a) {
  return {{R(0), a.z, -a.y}, {-a.z, R(0), a.x}, {a.y, -a.x, R(0)}};
}

using Vec3 = Vec3T<double>;
using Quat = QuatT<double>;
using Mat3 = Mat3T<double>;

}  // namespace rubble
