/// Mesh files that are cut off or damaged at any byte are read or are an Error; the sanitizers watch what is
/// touched.
#include <gtest/gtest.h>
#include <rubble/error.h>

#include "io/mesh_file.h"
#include "tests/support/mesh_files.h"

namespace rubble::io {
namespace {

using test::TemporaryFile;

/// Reads the file, and everything that a mesh is used for.
void readOrThrow(const std::string& ending, const std::string& bytes) {
  const TemporaryFile file(ending, bytes);
  try {
    const MeshFile mesh = readMesh(file.path);
    for (const auto& t : mesh.triangles)
      for (const int v : t) ASSERT_TRUE(v >= 0 && static_cast<std::size_t>(v) < mesh.vertices.size());
    tetrahedraOf(mesh);
    lineOf(mesh, "line");
  } catch (const Error&) {
  }
}

struct Sample {
  std::string ending, bytes;
};
std::vector<Sample> samples() {
  using namespace test;
  return {{".ply", binaryPly(false)}, {".ply", binaryPly(true)},   {".msh", binaryMsh2(false)},
          {".msh", binaryMsh2(true)}, {".msh", binaryMsh4(false)}, {".msh", binaryMsh4(true)},
          {".stl", binaryStl()}};
}

TEST(DamagedMesh, CutOffAtEveryByte) {
  for (const Sample& sample : samples())
    for (std::size_t size = 0; size <= sample.bytes.size(); ++size)
      readOrThrow(sample.ending, sample.bytes.substr(0, size));
}

TEST(DamagedMesh, WithEveryByteChanged) {
  for (const Sample& sample : samples())
    for (std::size_t at = 0; at < sample.bytes.size(); ++at)
      for (const unsigned flip : {0x01u, 0x10u, 0x80u, 0xffu}) {
        std::string bytes = sample.bytes;
        bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ flip);
        readOrThrow(sample.ending, bytes);
      }
}

TEST(DamagedMesh, WhoseHeaderEndsTheFileWithoutAnEndOfLine) {
  const std::string head = test::plyHead("binary_little_endian");
  const TemporaryFile ply(".ply", head.substr(0, head.size() - 1));
  EXPECT_THROW(readMesh(ply.path), Error);
  const TemporaryFile empty(".ply",
                            "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint "
                            "double a\nproperty float x\n"
                            "property float y\nproperty float z\nend_header");
  EXPECT_THROW(readMesh(empty.path), Error);
  const TemporaryFile msh(".msh", "$MeshFormat\n4.1 1 8\n" + test::raw(1) + "\n$EndMeshFormat\n$Nodes");
  EXPECT_THROW(readMesh(msh.path), Error);
}

TEST(DamagedMesh, LineThatStandsStillBeforeOneThatIsClosed) {
  const TemporaryFile file(".obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 9 9 9\nl 4 4\nl 1 2 3 1\n");
  const std::vector<Vec3> line = lineOf(readMesh(file.path), "line");
  ASSERT_EQ(line.size(), 4u);
  EXPECT_EQ(line.front(), line.back());
  const TemporaryFile within(".obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 1 2 2 3 3\n");
  EXPECT_EQ(lineOf(readMesh(within.path), "line").size(), 3u);
}

}  // namespace
}  // namespace rubble::io
