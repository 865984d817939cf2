#pragma once
/// Deformable objects from meshes: validation, a tetrahedralizer for closed surfaces, cloth and rods.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <rubble/deformables.h>
#include <rubble/scene.h>

namespace rubble {

/// A surface mesh. Triangles are counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<std::array<int, 3>> triangles;
};

/// A tetrahedral mesh. Corner order as in TetSolidDef.
struct TetrahedronMesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<std::array<int, 4>> tetrahedra;
};

/// The surface of a shape in its authored frame, for rendering. A corner at a sharp edge occurs once per
/// face.
struct ShapeMesh {
  std::vector<Vec3> points;                   ///< [m]
  std::vector<Vec3> normals;                  ///< outward, unit
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
};

/// Triangles of any shape. `segments`: per full circle. A plane has none. Throws Error for degenerate
/// geometry.
ShapeMesh shapeMesh(const Shape& shape, int segments = 48);

/// Throws Error unless the surface is closed and oriented. Required: valid vertex indices, triangles with an
/// area, two triangles of opposite direction on each edge, and a positive volume. The path of the error names
/// the first invalid triangle ("surface.triangles[17]").
void validateClosed(const TriangleMesh& surface, const Path& path = "surface");

/// Volume enclosed by a closed surface [m3].
double volumeOf(const TriangleMesh& surface);

/// Tetrahedralizes a closed surface by isosurface stuffing (Labelle and Shewchuk 2007). The lattice is
/// body-centered cubic with cells of width `cell` [m]. Lattice points near the surface are moved onto it, and
/// tetrahedra are cut along it. Parts thinner than a cell get holes or disappear. The surface may be nested
/// and self-intersecting: inside is where the winding number is 1 or more. Throws Error if validateClosed()
/// does, if no lattice point lies inside, or if there are more than 2^26 cells.
TetrahedronMesh tetrahedralize(const TriangleMesh& surface, double cell, const Path& path = "surface");

/// A solid from these tetrahedra. Tetrahedra of negative volume are reoriented.
TetSolidDef tetSolidFromMesh(TetrahedronMesh mesh);
/// A solid inside a closed surface, with cells of width `cell` [m].
TetSolidDef tetSolidFromSurface(const TriangleMesh& surface, double cell);
/// Cloth from these triangles. Unused vertices are left out.
ClothDef clothFromMesh(const TriangleMesh& mesh);
/// A rod along a polyline through these points, in segments of about that length [m]. A closed one returns to
/// the first point.
CableDef cableAlong(const std::vector<Vec3>& points, double segment, bool closed = false);

/// A convex part of a solid.
struct ConvexPart {
  std::vector<Vec3> points;  ///< corners of the part, which is their convex hull [m]
  double volume = 0;         ///< of the hull [m3]
};

/// Approximate decomposition of a closed surface into convex parts, by plane cuts. The parts do not overlap,
/// for each is the hull of what lies in a convex cell. The hulls exceed the solid by at most `concavity`
/// times its volume, unless that takes more than `most` parts. Deterministic. Throws Error if
/// validateClosed() does, or if this build has no qhull.
std::vector<ConvexPart> convexParts(const TriangleMesh& surface, double concavity, int most,
                                    const Path& path = "surface");

/// A broken solid.
struct Fracture {
  std::vector<ConvexPart> pieces;
  /// Where two pieces touch.
  struct Contact {
    int a = 0, b = 0;  ///< pieces
    Vec3 center;       ///< of the common face [m]
    Vec3 normal;       ///< unit, from a to b
    double area = 0;   ///< [m2]
  };
  std::vector<Contact> contacts;
  double lost = 0;  ///< volume of slivers that are left out [m3]
};

/// Breaks a closed surface into about `count` convex pieces: the Voronoi cells of points that are spread
/// evenly at random in the solid, cut further where they are not convex (as convexParts(), with a concavity
/// of 0.005). The same seed gives the same pieces. Throws Error as convexParts().
Fracture fracture(const TriangleMesh& surface, int count, std::uint64_t seed, const Path& path = "surface");

/// A distance field of a closed surface with `cells` cells along its longest side. Distances are exact near
/// the surface. Throws Error if validateClosed() does, or for fewer than 4 cells.
Shape distanceFieldOf(const TriangleMesh& surface, int cells, const Path& path = "surface");

}  // namespace rubble
