#pragma once
/// What USD and glTF have in common: bodies that are placed by themselves, shapes under scaled frames, and
/// joints with six axes.
#include <array>
#include <optional>
#include <string>

#include <rubble/mesh.h>

#include "convert/model.h"

namespace rubble::convert {

/// x -> m x + t, with the columns of m.
struct Affine {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t;

  Vec3 direction(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3 operator*(const Vec3& p) const { return direction(p) + t; }
  Affine operator*(const Affine& b) const {
    return {direction(b.x), direction(b.y), direction(b.z), *this * b.t};
  }
  double determinant() const { return dot(x, cross(y, z)); }
  bool isFinite() const;
  /// Lengths of the columns.
  Vec3 scale() const { return {length(x), length(y), length(z)}; }
  /// The rigid part: columns made orthonormal in their order. A column of length 0 gives the identity.
  Pose rigid() const;
  static Affine of(const Pose& pose);
  static Affine scaling(const Vec3& s) { return {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {}}; }
};

/// The pose without what round-off has left of zeros.
Pose tidied(const Pose& pose);

/// A shape in the frame of its prim or node, in its units.
struct FreeShape {
  enum class Type { Box, Sphere, Capsule, Cylinder, Cone, Plane, Mesh } type = Type::Box;
  Vec3 size;                      ///< box: edges
  double radius = 0, height = 0;  ///< of the cylinder between the caps of a capsule
  double topRadius = -1;          ///< cylinder, capsule: where it is not `radius`; below 0: the same
  int axis = 2;                   ///< 0, 1, 2
  TriangleMesh mesh;
  enum class Mesh { Triangles, Hull, Parts, Box, Sphere } as = Mesh::Hull;
};

/// Adds the shape to a link as geoms, and its solid at density 1 to `solid`, in the frame of the link.
/// `toLink`: from the frame of the shape. Geoms have the name, place, material and contact of `like`. Returns
/// false if nothing could be made of it, which is reported.
bool addShape(Link& link, const FreeShape& shape, const Affine& toLink, const Geom& like, bool isStatic,
              SolidSums& solid, Report& report);

/// The simplest joint with these axes: travels and turns about x, y and z, of which locked ones have equal
/// limits.
JointDef jointOfAxes(const std::array<JointAxis, 6>& axes);

/// Axes of a frame whose x axis is axis 0, 1 or 2 of another one, with the next ones behind it.
Quat frameOfAxis(int axis);

}  // namespace rubble::convert
