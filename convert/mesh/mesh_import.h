#pragma once
/// Meshes of other programs as scenes: one rigid body, one deformable object, or the pieces of a broken
/// solid.
#include <cstdint>
#include <string>
#include <vector>

#include "io/mesh_file.h"
#include "io/scene_json.h"

namespace rubble::convert {

/// What a mesh becomes.
enum class MeshAs {
  Hull,      ///< a body, its convex hull
  Parts,     ///< a body, a compound of convex parts
  Distance,  ///< a body with a signed-distance field
  Mesh,      ///< a static body of triangles
  Solid,     ///< a deformable solid of tetrahedra
  Cloth      ///< cloth
};
/// "hull", "parts", "distance", "mesh", "solid", "cloth", in the order of MeshAs.
const std::vector<std::string>& meshKinds();

struct MeshOptions {
  MeshAs as = MeshAs::Hull;
  double scale = 1;         ///< meters per unit of the file
  std::string up = "";      ///< axis of the file that becomes z: "y" or "z"; "": "y" for formats that say so
  double density = 1000;    ///< of bodies and solids [kg/m3]
  double concavity = 0.05;  ///< parts: volume of the hulls beyond that of the solid, as a share of it
  int parts = 32;           ///< parts: at most
  int cells = 24;           ///< distance, solid: cells along the longest side
  bool ground = true;       ///< adds a ground plane; the mesh stands on z = 0
};

struct FractureOptions {
  int pieces = 100;
  std::uint64_t seed = 1;
  double strength = 1e6;  ///< tensile strength of the joints between pieces [Pa]
  double strike = 0;      ///< speed of a ball that hits the solid after one second [m/s]; 0: none
};

struct MeshScene {
  io::SceneFile file;
  std::vector<std::string> facts;  ///< what became of the mesh, a line each
};

/// The surface of a mesh file in meters, z up, with vertices at one place joined. OBJ, STL, PLY and MSH need
/// no library; other formats (.dae, .gltf, .glb, .fbx and more) need assimp. Throws Error with the file and
/// the line or reason of what is wrong, and for files that lead out of their folder.
TriangleMesh readSurface(const std::string& file, double scale = 1, const std::string& up = "");

/// The same with the axes of the file as they are, whichever it says is up: what URDF means. Units that the
/// file gives are applied.
TriangleMesh readSurfaceAsWritten(const std::string& file);

/// A scene with the mesh. Throws Error if it has no surface, or is not closed where that is needed.
MeshScene importMesh(const std::string& file, const MeshOptions& options = {});

/// A scene with the pieces of a closed mesh, and breakable fixed joints where they touch. A joint holds the
/// strength times the area of contact, and a torque of that over the edge of a square. Deterministic. Throws
/// Error if the mesh is not closed.
MeshScene importFracture(const std::string& file, const MeshOptions& options = {},
                         const FractureOptions& fracture = {});

/// Does this name a mesh file, by its ending?
bool isMeshFile(const std::string& file);

}  // namespace rubble::convert
