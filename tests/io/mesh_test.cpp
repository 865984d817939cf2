/// Mesh files: what is written comes back, every format gives the same mesh, and faults say where they are.
#include <filesystem>
#include <random>

#include <gtest/gtest.h>
#include <rubble/error.h>

#include "io/mesh_file.h"
#include "io/scene_json.h"
#include "tests/support/mesh_files.h"
#include "tests/support/meshes.h"

namespace rubble::io {
namespace {

using test::raw, test::raws, test::TemporaryFile;

MeshFile meshOf(const std::string& ending, const std::string& content) {
  return readMesh(TemporaryFile(ending, content).path);
}

/// What the error says behind the name of the file, or "".
std::string faultOf(const std::string& ending, const std::string& content) {
  const TemporaryFile file(ending, content);
  try {
    readMesh(file.path);
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find(file.path), 0u) << text;
    return text.substr(std::min(text.size(), file.path.size()));
  }
  return "";
}

constexpr const auto& kCorners = test::kMeshCorners;

void expectCorners(const MeshFile& mesh) {
  ASSERT_EQ(mesh.vertices.size(), kCorners.size());
  for (std::size_t i = 0; i < kCorners.size(); ++i) EXPECT_EQ(mesh.vertices[i], kCorners[i]);
}

TEST(MeshFile, ObjHasFacesOfAnyKindAndLines) {
  const MeshFile mesh = meshOf(".obj",
                               "# a comment\nv 0 0 0\nv 1 0 0\nv 0 2 0\r\nv 0 0 3\nvn 0 0 1\nvt 0 0\nusemtl "
                               "x\nf 1/1/1 2//1 3/2\nf -4 -3 -2 -1\nl 1 2 4\n");
  expectCorners(mesh);
  const std::vector<std::array<int, 3>> wanted{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(mesh.triangles, wanted);
  EXPECT_EQ(mesh.lines, (std::vector<std::vector<int>>{{0, 1, 3}}));
}

TEST(MeshFile, ObjComesBackAsItWasWritten) {
  const TriangleMesh ring = test::torusMesh(1, .4, 12, 7);
  const TemporaryFile file(".obj");
  writeObj(file.path, ring);
  const MeshFile mesh = readMesh(file.path);
  EXPECT_EQ(mesh.triangles, ring.triangles);
  EXPECT_EQ(mesh.vertices, ring.vertices) << "to the last bit";
}

TEST(MeshFile, StlAsTextAndBinaryIsWelded) {
  const MeshFile text = meshOf(
      ".stl",
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\nendloop\nendfacet\n"
      "facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 0 2 0\n vertex 0 0 "
      "3\nendloop\nendfacet\nendsolid s\n");
  expectCorners(text);
  const MeshFile binary = meshOf(".stl", test::binaryStl());
  expectCorners(binary);
  EXPECT_EQ(binary.triangles, text.triangles);
}

TEST(MeshFile, PlyAsTextAndBinaryOfEitherOrder) {
  const MeshFile text = meshOf(
      ".ply", test::plyHead("ascii") + "0 0 0 9\n1 0 0 9\n0 2 0 9\n0 0 3 9\n3 0 1 2\n4 0 1 2 3\n");
  expectCorners(text);
  EXPECT_EQ(text.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
  for (const bool big : {false, true}) {
    const MeshFile binary = meshOf(".ply", test::binaryPly(big));
    expectCorners(binary);
    EXPECT_EQ(binary.triangles, text.triangles);
  }
}

const char* const kMsh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n$Nodes\n4\n10 "
    "0 0 0\n20 1 0 0\n30 0 2 0\n"
    "40 0 0 3\n$EndNodes\n$Elements\n4\n1 15 2 0 1 10\n2 1 2 0 1 10 20\n3 2 2 0 1 10 30 20\n4 4 2 0 1 10 20 "
    "30 40\n$EndElements\n";
const char* const kMsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 2 3 0 0\n$EndEntities\n$Nodes\n2 4 "
    "10 40\n0 1 0 1\n10\n0 0 0\n3 1 "
    "0 3\n20\n30\n40\n"
    "1 0 0\n0 2 0\n0 0 3\n$EndNodes\n$Elements\n4 4 1 4\n0 1 15 1\n1 10\n1 1 1 1\n2 10 20\n2 1 2 1\n3 10 30 "
    "20\n3 1 4 1\n4 10 20 30 "
    "40\n$EndElements\n";

void expectGmsh(const MeshFile& mesh) {
  expectCorners(mesh);
  EXPECT_EQ(mesh.lines, (std::vector<std::vector<int>>{{0, 1}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{0, 2, 1}}));
  EXPECT_EQ(mesh.tetrahedra, (std::vector<std::array<int, 4>>{{0, 1, 2, 3}}));
}

TEST(MeshFile, GmshOfBothVersionsAsTextAndBinary) {
  expectGmsh(meshOf(".msh", kMsh2));
  expectGmsh(meshOf(".msh", kMsh4));
  for (const bool swap : {false, true}) {
    expectGmsh(meshOf(".msh", test::binaryMsh2(swap)));
    expectGmsh(meshOf(".msh", test::binaryMsh4(swap)));
  }
}

TEST(MeshFile, TetrahedraComeBackAsTheyWereWritten) {
  const TetrahedronMesh solid = tetrahedralize(test::cubeMesh(), .3);
  const TemporaryFile file(".msh");
  writeMsh(file.path, solid);
  const MeshFile mesh = readMesh(file.path);
  EXPECT_EQ(mesh.vertices, solid.vertices) << "to the last bit";
  EXPECT_EQ(mesh.tetrahedra, solid.tetrahedra);
}

TEST(MeshFile, FaultsSayWhereTheyAre) {
  EXPECT_NE(faultOf(".xyz", "").find("expected a name that ends in .obj"), std::string::npos);
  EXPECT_NE(faultOf(".obj", "").find("expected triangles, tetrahedra or lines, got none"), std::string::npos);
  EXPECT_EQ(faultOf(".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
            " line 4: expected the number of one of 3 vertices, got 4");
  EXPECT_EQ(faultOf(".obj", "v 0 0\n"), " line 1: expected three coordinates, got \"\"");
  EXPECT_EQ(faultOf(".obj", "v 0 0 nan\n"), " line 1: expected three coordinates, got \"nan\"");
  EXPECT_EQ(faultOf(".obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"), " line 3: expected at least 3 vertices, got 2");
  EXPECT_NE(faultOf(".stl", "solid x\nfacet\nvertex 0 0 0\nendfacet\n")
                .find(" line 4: expected a facet of three vertices"),
            std::string::npos);
  EXPECT_NE(faultOf(".stl", "rubbish").find("binary STL"), std::string::npos);
  EXPECT_NE(faultOf(".ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n")
                .find("the properties x, y and z"),
            std::string::npos);
  EXPECT_NE(faultOf(".ply", "ply\nformat ascii 1.0\nelement vertex 99999999\nend_header\n").find("line 3"),
            std::string::npos);
  EXPECT_NE(
      faultOf(".msh", "$MeshFormat\n3 0 8\n$EndMeshFormat\n").find(" line 2: expected version 2.2 or 4.1"),
      std::string::npos);
  std::string text = kMsh2;
  EXPECT_NE(faultOf(".msh", text.replace(text.find("30 40\n$End"), 2, "31")).find("which there is none of"),
            std::string::npos);
}

TEST(MeshFile, CutOffAndDamagedFilesAreErrorsAndNoCrash) {
  std::mt19937 random(4);
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n" +
      std::string(36, '\0') + raws(false, std::uint8_t{3}, 0, 1, 2);
  for (const auto& [ending, whole] : {std::pair<std::string, std::string>{".msh", kMsh2},
                                      {".msh", kMsh4},
                                      {".ply", ply},
                                      {".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}}) {
    for (int round = 0; round < 150; ++round) {
      std::string bytes = whole;
      if (round % 2 == 0)
        bytes.resize(random() % bytes.size());
      else
        for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      const TemporaryFile file(ending, bytes);
      try {
        const MeshFile mesh = readMesh(file.path);
        for (const auto& t : mesh.tetrahedra)
          for (const int v : t) ASSERT_TRUE(v >= 0 && static_cast<std::size_t>(v) < mesh.vertices.size());
      } catch (const Error&) {
      }
    }
  }
}

TEST(MeshFile, LinesJoinToOne) {
  const MeshFile open{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {}, {}, {{2, 1}, {3, 2}, {0, 1}}};
  EXPECT_EQ(lineOf(open, "x").size(), 4u);
  EXPECT_EQ(length(lineOf(open, "x").front() - lineOf(open, "x").back()), 3);
  MeshFile closed = open;
  closed.lines.push_back({3, 0});
  EXPECT_EQ(lineOf(closed, "x").size(), 5u);
  MeshFile branched = open;
  branched.vertices.push_back({1, 1, 0});
  branched.lines.push_back({1, 4});
  EXPECT_THROW(lineOf(branched, "x"), Error);
}

TEST(SceneFile, DeformableObjectsAreReadFromMeshFiles) {
  const TemporaryFile ring(".obj"), rope(".obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\n"),
      solid(".msh", kMsh4);
  writeObj(ring.path, test::torusMesh(1, .4, 24, 12));
  const auto name = [](const TemporaryFile& f) { return std::filesystem::path(f.path).filename().string(); };
  std::vector<Fault> faults;
  const SceneFile scene = parseScene(
      R"({"bodies": [], "deformables": [
        {"type": "tet_solid", "mesh": {"file": ")" +
          name(ring) + R"(", "cell": 0.2, "position": [0, 0, 5], "scale": 2}, "density": 500},
        {"type": "cloth", "mesh": {"file": ")" +
          name(ring) + R"("}},
        {"type": "cable", "mesh": {"file": ")" +
          name(rope) + R"(", "segment": 0.1}},
        {"type": "tet_solid", "mesh": {"file": ")" +
          name(solid) + R"("}}]})",
      faults, std::filesystem::temp_directory_path().string());
  for (const Fault& fault : faults) ADD_FAILURE() << fault.text();
  ASSERT_EQ(scene.scene.deformables.size(), 4u);
  double lowest = 9;
  for (const Vec3& x : common(scene.scene.deformables[0]).vertices) lowest = std::min(lowest, x.z);
  EXPECT_NEAR(lowest, 4.2, .02);
  EXPECT_EQ(common(scene.scene.deformables[1]).vertices.size(), 24u * 12u);
  EXPECT_EQ(common(scene.scene.deformables[2]).vertices.size(), 21u);
  EXPECT_EQ(std::get<TetSolidDef>(scene.scene.deformables[3]).tetrahedra.size(), 1u);

  const auto faultIn = [&](const std::string& object) {
    std::vector<Fault> found;
    parseScene(R"({"bodies": [], "deformables": [)" + object + "]}", found,
               std::filesystem::temp_directory_path().string());
    return found.empty() ? std::string() : found[0].text();
  };
  EXPECT_NE(faultIn(R"({"type": "tet_solid", "mesh": {"file": ")" + name(ring) + R"("}})")
                .find("deformables[0].mesh: expected \"cell\""),
            std::string::npos);
  EXPECT_NE(faultIn(R"({"type": "tet_solid", "mesh": {"file": "none.obj", "cell": 1}})")
                .find("deformables[0].mesh.file"),
            std::string::npos);
  EXPECT_NE(faultIn(R"({"type": "tet_solid", "mesh": {"file": ")" + name(ring) + R"(", "cell": 9}})")
                .find("cells that fit"),
            std::string::npos);
  EXPECT_NE(
      faultIn(R"({"type": "cable", "mesh": {"file": ")" + name(ring) + R"("}})").find("expected a line"),
      std::string::npos);
  EXPECT_NE(
      faultIn(R"({"type": "cloth", "mesh": {"file": "x.obj", "cell": 1}})").find("deformables[0].mesh.cell"),
      std::string::npos);
  EXPECT_NE(faultIn(R"({"type": "particles", "mesh": {"file": ")" + name(ring) + R"("}})").find("no mesh"),
            std::string::npos);
}

}  // namespace
}  // namespace rubble::io
