#pragma once
/// Orientations as model files write them.
#include <string>

#include <rubble/math.h>

namespace rubble::convert {

/// The frame with these orthonormal, right-handed axes.
Quat quatOfAxes(const Vec3& x, const Vec3& y, const Vec3& z);
/// The shortest rotation of the z axis to a direction.
Quat quatOfZ(const Vec3& z);
/// Rotations about the axes named by `sequence`, in order: about moving axes for x, y, z, about fixed ones
/// for X, Y, Z [rad].
Quat quatOfEuler(const Vec3& angles, const std::string& sequence);
/// The rotation vector of at most half a revolution [rad].
Vec3 rotationVector(const Quat& q);
/// URDF: roll, pitch and yaw about fixed x, y and z axes [rad].
inline Quat quatOfRpy(const Vec3& rpy) { return quatOfEuler(rpy, "XYZ"); }

}  // namespace rubble::convert
