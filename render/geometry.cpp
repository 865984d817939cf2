#include "render/geometry.h"

#include <cmath>
#include <numbers>

namespace rubble::render {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

Vec3f areaNormal(std::span<const Vec3f> vertices, const Triangle& t) {
  return cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]);
}

}  // namespace

void MeshData::addVertex(const Vec3f& p, float alongZ, const Vec3f& n) {
  texels.insert(texels.end(), {p.x, p.y, p.z, alongZ, n.x, n.y, n.z, 0});
}

MeshData boxFaces() {
  MeshData mesh;
  mesh.texels.resize(8 * 8);
  mesh.indices = {1, 3, 7, 1, 7, 5, 2, 6, 7, 2, 7, 3, 4, 5, 7, 4, 7, 6};
  return mesh;
}

MeshData roundMesh(int rings) {
  const int sectors = 2 * rings, middle = rings / 2;
  MeshData mesh;
  // The equator is there twice: it is where the two halves come apart.
  for (int row = 0; row <= rings + 1; ++row) {
    const int ring = row <= middle ? row : row - 1;
    const float polar = kPi * static_cast<float>(ring) / static_cast<float>(rings);
    const float alongZ = row <= middle ? 1.f : -1.f;
    for (int sector = 0; sector <= sectors; ++sector) {
      const float angle = 2 * kPi * static_cast<float>(sector) / static_cast<float>(sectors);
      const Vec3f p{std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar)};
      mesh.addVertex(p, alongZ, p);
    }
  }
  const auto across = static_cast<std::uint32_t>(sectors + 1);
  for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rings + 1); ++row) {
    for (std::uint32_t sector = 0; sector + 1 < across; ++sector) {
      const std::uint32_t a = row * across + sector, b = a + across;
      mesh.indices.insert(mesh.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  }
  return mesh;
}

MeshData cylinderMesh(int sides) {
  MeshData mesh;
  const auto n = static_cast<std::uint32_t>(sides);
  const auto direction = [&](std::uint32_t i) {
    const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(n);
    return Vec3f{std::cos(angle), std::sin(angle), 0};
  };
  const Vec3f axis{0, 0, 1};
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (const float z : {-1.f, 1.f}) mesh.addVertex(direction(i) + axis * z, 0, direction(i));
    if (i < n)
      mesh.indices.insert(mesh.indices.end(), {2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 1});
  }
  for (const float z : {-1.f, 1.f}) {
    const auto first = static_cast<std::uint32_t>(mesh.vertexCount());
    for (std::uint32_t i = 0; i < n; ++i) mesh.addVertex(direction(i) + axis * z, 0, axis * z);
    for (std::uint32_t i = 2; i < n; ++i)
      mesh.indices.insert(mesh.indices.end(), {first, first + i - 1, first + i});
  }
  return mesh;
}

MeshData meshOf(std::span<const Vec3f> vertices, std::span<const Triangle> triangles, float crease) {
  std::vector<std::vector<std::uint32_t>> around(vertices.size());
  std::vector<Vec3f> faces;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) around[v].push_back(static_cast<std::uint32_t>(faces.size()));
    faces.push_back(areaNormal(vertices, t));
  }
  MeshData mesh;
  const float together = std::cos(crease);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t v : triangles[i]) {
      Vec3f sum;
      for (const std::uint32_t other : around[v])
        if (dot(normalize(faces[other]), normalize(faces[i])) >= together) sum += faces[other];
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertexCount()));
      mesh.addVertex(vertices[v], 0, normalize(sum, normalize(faces[i])));
    }
  }
  return mesh;
}

std::vector<Vec3f> smoothNormals(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  std::vector<Vec3f> normals(vertices.size());
  for (const Triangle& t : triangles) {
    const Vec3f normal = areaNormal(vertices, t);
    for (const std::uint32_t v : t) normals[v] += normal;
  }
  for (Vec3f& normal : normals) normal = normalize(normal);
  return normals;
}

}  // namespace rubble::render
