#pragma once
/// Rods that resist stretch, shear, bending and twist: rigid segments with directions, joined by elastic
/// joints.
#include <optional>
#include <string>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

/// A rod of circular section along a line, as it is without load. Each piece between two points is a capsule.
/// Between neighbours is a joint with all six axes elastic, l the mean length of the two pieces, A = pi r^2,
/// I = pi r^4 / 4, J = 2 I:
///
///   stretch E A / l    shear kappa G A / l    twist G J / l    bending E I / l
///
/// with G = E / (2 (1 + nu)) and kappa = 6 (1 + nu) / (7 + 6 nu) (Cowper 1966). At an end that is built in, l
/// is half a piece.
struct SegmentRodDef {
  std::string name;            ///< of the bodies, with their numbers behind it; optional
  std::vector<Vec3> points;    ///< two at least, world [m]
  double radius = .01;         ///< [m]
  double youngsModulus = 1e7;  ///< E [Pa]
  double poissonRatio = .3;    ///< nu [1], -1 to .5
  double density = 1000;       ///< [kg/m3]
  double viscosity = 0;        ///< of the strain rate: every spring has a damper of viscosity / E times its
                               ///< stiffness [Pa s]
  std::optional<int> start, end;  ///< body that this end is built into (kWorld: the world); none: it is free
  Material material;
  double breakForce = kUnbreakable, breakTorque = kUnbreakable;  ///< of a joint [N], [N m]
};

/// Where the parts of a rod are in a scene.
struct SegmentRod {
  int firstBody = 0, bodies = 0;
  int firstJoint = 0, joints = 0;  ///< in order along the rod; the first is that of a built-in start
};

/// Adds bodies and joints of a rod to a scene. Throws Error with the path of what is wrong ("rod.points[3]").
SegmentRod addRod(Scene& scene, const SegmentRodDef& rod, const std::string& path = "rod");

}  // namespace rubble
