#pragma once
/// One tetrahedron, some of its faces and an edge in each binary format of mesh files.
#include <bit>

#include <rubble/math.h>

#include "tests/support/files.h"

namespace rubble::test {

inline const std::array<Vec3, 4> kMeshCorners{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 2, 0}, Vec3{0, 0, 3}};

inline std::string plyHead(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty double y\nproperty float "
         "z\nproperty uchar red\n"
         "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
}
inline std::string binaryPly(bool big) {
  const bool swap = big != (std::endian::native == std::endian::big);
  std::string bytes = plyHead(big ? "binary_big_endian" : "binary_little_endian");
  for (const Vec3& x : kMeshCorners) bytes += raws(swap, float(x.x), x.y, float(x.z), std::uint8_t{9});
  return bytes + raws(swap, std::uint8_t{3}, 0, 1, 2) + raws(swap, std::uint8_t{4}, 0, 1, 2, 3);
}

/// Nodes 10, 20, 30 and 40; a line, a triangle and the tetrahedron.
inline std::string binaryMsh2(bool swap) {
  std::string bytes = "$MeshFormat\n2.2 1 8\n" + raw(1, swap) + "\n$EndMeshFormat\n$Nodes\n4\n";
  for (int i = 0; i < 4; ++i) {
    const Vec3& x = kMeshCorners[std::size_t(i)];
    bytes += raws(swap, 10 * (i + 1), x.x, x.y, x.z);
  }
  return bytes + "\n$EndNodes\n$Elements\n3\n" + raws(swap, 1, 1, 2, 1, 0, 1, 10, 20) +
         raws(swap, 2, 1, 2, 2, 0, 1, 10, 30, 20) + raws(swap, 4, 1, 2, 3, 0, 1, 10, 20, 30, 40) +
         "\n$EndElements\n";
}
inline std::string binaryMsh4(bool swap) {
  using I = std::int64_t;
  std::string bytes = "$MeshFormat\n4.1 1 8\n" + raw(1, swap) + "\n$EndMeshFormat\n$Nodes\n" +
                      raws(swap, I{1}, I{4}, I{10}, I{40}, 3, 1, 0, I{4}, I{10}, I{20}, I{30}, I{40});
  for (const Vec3& x : kMeshCorners) bytes += raws(swap, x.x, x.y, x.z);
  return bytes + "\n$EndNodes\n$Elements\n" +
         raws(swap, I{3}, I{3}, I{1}, I{3}, 1, 1, 1, I{1}, I{1}, I{10}, I{20}, 2, 1, 2, I{1}, I{2}, I{10},
              I{30}, I{20}) +
         raws(swap, 3, 1, 4, I{1}, I{3}, I{10}, I{20}, I{30}, I{40}) + "\n$EndElements\n";
}

/// Two faces.
inline std::string binaryStl() {
  std::string bytes = "solid, but binary";
  bytes.resize(80, ' ');
  bytes += raw(std::uint32_t{2});
  for (const std::array<std::size_t, 3>& t : {std::array<std::size_t, 3>{0, 1, 2}, {0, 2, 3}}) {
    bytes += raws(false, 0.f, 0.f, 1.f);
    for (const std::size_t v : t)
      bytes += raws(false, float(kMeshCorners[v].x), float(kMeshCorners[v].y), float(kMeshCorners[v].z));
    bytes += raw(std::uint16_t{0});
  }
  return bytes;
}

}  // namespace rubble::test
