#pragma once
/// Meshes in files: OBJ, STL, PLY (surfaces) and Gmsh's MSH 2.2 and 4.1 (surfaces and tetrahedra), as text or
/// binary where the format has both.
#include <string>
#include <vector>

#include <rubble/mesh.h>

namespace rubble::io {

/// What a file holds. Polygons are cut into triangles; nodes that nothing uses stay.
struct MeshFile {
  std::vector<Vec3> vertices;  ///< in the unit of the file
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 4>> tetrahedra;
  std::vector<std::vector<int>> lines;  ///< polylines of OBJ; two-node lines of MSH, each for itself

  TriangleMesh surface() const { return {vertices, triangles}; }
};

/// By the ending of its name. Throws Error that names the file and the line (text) or byte (binary) of what
/// is wrong, what was expected and what came.
MeshFile readMesh(const std::string& file);
/// The same of the content of a file of that name.
MeshFile parseMesh(const std::string& name, std::string content);

/// The tetrahedra of a mesh without the nodes that they do not use.
TetrahedronMesh tetrahedraOf(const MeshFile& mesh);
/// The two-node lines or polylines of a mesh joined to one line: its points in order, the first one again at
/// the end of a closed one. Throws Error if they branch or are several.
std::vector<Vec3> lineOf(const MeshFile& mesh, const std::string& path);

/// Writes a surface as OBJ, or tetrahedra as MSH 4.1 text. Throws Error if the file cannot be written.
void writeObj(const std::string& file, const TriangleMesh& mesh);
void writeMsh(const std::string& file, const TetrahedronMesh& mesh);

}  // namespace rubble::io
