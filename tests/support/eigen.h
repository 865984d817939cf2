#pragma once
/// Our small types as Eigen's.
#include <rubble/math.h>
#include <Eigen/Dense>

namespace rubble::test {

inline Eigen::Vector3d eigen(const Vec3& a) { return {a.x, a.y, a.z}; }
inline Eigen::Quaterniond eigen(const Quat& q) { return {q.s, q.v.x, q.v.y, q.v.z}; }
inline Eigen::Matrix3d eigen(const Mat3& m) {
  Eigen::Matrix3d out;
  out << eigen(m.c0), eigen(m.c1), eigen(m.c2);
  return out;
}

}  // namespace rubble::test
