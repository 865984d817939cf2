#pragma once
/// Deformable objects from meshes: validation, a tetrahedralizer for closed surfaces, cloth and rods.
#include <array>
#include <string>
#include <vector>

#include <rubble/deformables.h>

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

}  // namespace rubble
