#pragma once
/// Triangle meshes of the unit shapes that bodies are drawn with.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/camera.h"

namespace rubble::render {

/// Two texels of four floats a vertex: position and how far the half length moves it along z (-1, 0 or 1),
/// normal and nothing.
struct MeshData {
  std::vector<float> texels;
  std::vector<std::uint32_t> indices;

  std::size_t vertexCount() const { return texels.size() / 8; }
  void addVertex(const Vec3f& position, float alongZ, const Vec3f& normal);
};

using Triangle = std::array<std::uint32_t, 3>;

/// The three faces of a box about its corner 7; only the indices are used.
MeshData boxFaces();
/// A unit sphere, cut in two halves that a half length moves apart: with one it is a capsule. `rings` from
/// pole to pole, even.
MeshData roundMesh(int rings);
/// A unit cylinder along z, from -1 to 1.
MeshData cylinderMesh(int sides);
/// Vertices and triangles as they are, with flat faces where edges are sharp (above `crease` [rad]) and
/// smooth ones elsewhere.
MeshData meshOf(std::span<const Vec3f> vertices, std::span<const Triangle> triangles, float crease = .6f);
/// Normals of the vertices of a smooth surface, weighted by area.
std::vector<Vec3f> smoothNormals(std::span<const Vec3f> vertices, std::span<const Triangle> triangles);

}  // namespace rubble::render
