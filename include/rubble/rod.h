#pragma once
/// Rods that resist stretch, shear, bending and twist: rigid segments connected by elastic joints.
#include <optional>
#include <string>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

/// A rod of circular section along a polyline, which is its unloaded shape. Each segment is a capsule.
/// Neighboring segments are connected by a joint with six elastic axes. With l the mean length of the two
/// segments, A = pi r^2, I = pi r^4 / 4, J = 2 I:
///
///   stretch E A / l    shear kappa G A / l    twist G J / l    bending E I / l
///
/// with G = E / (2 (1 + nu)) and kappa = 6 (1 + nu) / (7 + 6 nu) (Cowper 1966). At a built-in end, l is half
/// a segment.
struct RodDef {
  std::string name;            ///< prefix of the names of its bodies, followed by their number; optional
  std::vector<Vec3> points;    ///< at least two, world [m]
  double radius = .01;         ///< [m]
  double youngsModulus = 1e7;  ///< E [Pa]
  double poissonRatio = .3;    ///< nu [1], -1 to 0.5
  double density = 1000;       ///< [kg/m3]
  /// Viscosity of the strain rate [Pa s]. Each spring has a damper of viscosity / E times its stiffness.
  double viscosity = 0;
  std::optional<int> start, end;  ///< body that this end is built into (kWorld: the world); empty: free end
  Material material;
  double breakForce = kUnbreakable, breakTorque = kUnbreakable;  ///< per joint [N], [N m]
};

/// Indices of the parts of a rod in a scene.
struct RodParts {
  int firstBody = 0, bodies = 0;
  int firstJoint = 0, joints = 0;  ///< in order along the rod; the first one is that of a built-in start
};

/// Adds the bodies and joints of a rod to a scene. Throws Error with the path of an invalid field
/// ("rod.points[3]").
RodParts addRod(Scene& scene, const RodDef& rod, const Path& path = "rod");

}  // namespace rubble
