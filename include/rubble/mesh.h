#pragma once
/// From meshes to deformable objects: checks, a tetrahedraliser for closed surfaces, cloth and rods.
#include <array>
#include <string>
#include <vector>

#include <rubble/soft.h>

namespace rubble {

/// A surface; corners counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<std::array<int, 3>> triangles;
};

/// A solid; corners as in SoftDef.
struct TetrahedronMesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<std::array<int, 4>> tetrahedra;
};

/// Throws Error unless the surface encloses a solid: indices of vertices, triangles with an area, two
/// triangles on each edge that go along it in opposite directions, a positive volume. The path is that of the
/// first triangle that is wrong ("surface.triangles[17]").
void validateClosed(const TriangleMesh& surface, const std::string& path = "surface");

/// Volume inside of a closed surface [m3].
double volumeOf(const TriangleMesh& surface);

/// Tetrahedra that fill a closed surface, by isosurface stuffing (Labelle and Shewchuk 2007): a body-centred
/// lattice of cells of that width [m] whose points near the surface are moved onto it, and whose tetrahedra
/// are cut along it. What is thinner than a cell gets holes or is lost. The surface may have parts inside of
/// one another and cross itself: inside is what it winds around once or more. Throws Error for what
/// validateClosed() refuses, and for cells that are too wide to catch anything of it or so fine that there
/// are more than 2^26 of them.
TetrahedronMesh tetrahedralize(const TriangleMesh& surface, double cell, const std::string& path = "surface");

/// A solid of these tetrahedra; with those of negative volume turned over.
SoftDef softFromMesh(TetrahedronMesh mesh);
/// A solid inside of a closed surface.
SoftDef softFromSurface(const TriangleMesh& surface, double cell);
/// A sheet of these triangles. Vertices that none of them uses are left out.
ClothDef clothFromMesh(const TriangleMesh& mesh);
/// A rod along a line through these points, in segments of about that length [m]. A closed one returns to the
/// first point.
RodDef rodAlong(const std::vector<Vec3>& points, double segment, bool closed = false);

}  // namespace rubble
