/// Meshes and broken solids as scenes.
#include <gtest/gtest.h>

#include <rubble/world.h>

#include "convert/mesh/mesh_import.h"
#include "io/mesh_file.h"
#include "tests/convert/model_file.h"
#include "tests/support/meshes.h"

namespace rubble::test {
namespace {

std::string writeMesh(const ModelFolder& folder, const TriangleMesh& mesh,
                      const std::string& name = "mesh.obj") {
  const std::string file = (folder.path() / name).string();
  io::writeObj(file, mesh);
  return file;
}

convert::MeshScene imported(const TriangleMesh& mesh, convert::MeshAs as) {
  const ModelFolder folder;
  convert::MeshOptions options;
  options.as = as;
  return convert::importMesh(writeMesh(folder, mesh), options);
}

/// Of the body [kg].
double massOf(const convert::MeshScene& scene) {
  const BodyDef& body = scene.file.scene.bodies.at(1);
  return massProperties(body.shape, body.density).mass;
}

TEST(MeshImport, HasTheMassOfWhatTheMeshBecomes) {
  const TriangleMesh mesh = ell();  // 3 m3; its hull has 3.5
  EXPECT_NEAR(massOf(imported(mesh, convert::MeshAs::Hull)), 3500, 1e-6);
  EXPECT_NEAR(massOf(imported(mesh, convert::MeshAs::Parts)), 3000, 1e-6);
  EXPECT_NEAR(massOf(imported(mesh, convert::MeshAs::Distance)), 3000, 60);
  EXPECT_EQ(imported(mesh, convert::MeshAs::Mesh).file.scene.bodies.at(1).motion, Motion::Static);
}

TEST(MeshImport, StandsOnTheGroundInEveryForm) {
  constexpr double kSpacing = 2.7 / 12;
  // A hull of fewer corners than the mesh has leans a little.
  const std::pair<convert::MeshAs, double> wanted[] = {{convert::MeshAs::Hull, 0.03},
                                                       {convert::MeshAs::Parts, 0.002},
                                                       {convert::MeshAs::Distance, 0.5 * kSpacing},
                                                       {convert::MeshAs::Solid, 0.1 * kSpacing},
                                                       {convert::MeshAs::Cloth, 0.02}};
  for (const auto& [as, sinks] : wanted) {
    SCOPED_TRACE(convert::meshKinds()[static_cast<std::size_t>(as)]);
    const ModelFolder folder;
    convert::MeshOptions options;
    options.as = as, options.cells = 12;
    const Scene scene = convert::importMesh(writeMesh(folder, torusMesh(1, 0.35, 24, 12)), options)
                            .file.scene;
    WorldOptions oneThread;
    oneThread.threads = 1;
    World world(scene, oneThread);
    for (int k = 0; k < 20; ++k) world.step();
    if (scene.deformables.empty()) {
      EXPECT_NEAR(world.state(world.bodies().at(1)).position.z, scene.bodies[1].position.z, sinks);
      continue;
    }
    double low = 1e30;
    for (const Vec3& x : world.positions(world.deformables().at(0))) low = std::min(low, x.z);
    EXPECT_NEAR(low, 0, sinks);
  }
}

TEST(MeshImport, TurnsAndScalesTheFile) {
  const ModelFolder folder;
  const std::string file = writeMesh(folder, prism({{0, 0}, {100, 0}, {100, 200}, {0, 200}}, 300));
  const auto sizeOf = [&](const std::string& up) {
    const TriangleMesh mesh = convert::readSurface(file, 0.01, up);
    Vec3 low = mesh.vertices[0], high = low;
    for (const Vec3& x : mesh.vertices)
      for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], x[i]), high[i] = std::max(high[i], x[i]);
    EXPECT_NEAR(volumeOf(mesh), 6, 1e-9) << "turned inside out";
    return high - low;
  };
  EXPECT_NEAR(length(sizeOf("") - Vec3{1, 2, 3}), 0, 1e-9);
  EXPECT_NEAR(length(sizeOf("y") - Vec3{1, 3, 2}), 0, 1e-9);
}

TEST(MeshImport, TellsWhatIsWrong) {
  const ModelFolder folder;
  TriangleMesh open = ell();
  open.triangles.pop_back();
  const std::string file = writeMesh(folder, open);
  convert::MeshOptions options;
  for (const convert::MeshAs as :
       {convert::MeshAs::Parts, convert::MeshAs::Distance, convert::MeshAs::Solid}) {
    options.as = as;
    EXPECT_NE(messageOf([&] { convert::importMesh(file, options); }), "");
  }
  EXPECT_NE(messageOf([&] { convert::importFracture(file); }).find("mesh.obj"), std::string::npos);
  EXPECT_NE(messageOf([&] { convert::readSurface(file, -1); }).find("--scale"), std::string::npos);
  EXPECT_NE(messageOf([&] { convert::readSurface(file, 1, "x"); }).find("--up"), std::string::npos);
  EXPECT_NE(messageOf([&] { convert::readSurface((folder.path() / "none.dae").string()); }), "");
}

#if defined(RUBBLE_HAS_ASSIMP)
/// A triangle in a buffer of its own.
std::string gltfWith(const std::string& buffer) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0,"scale":[2,2,2]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":")" +
         buffer + R"("}]})";
}

TEST(MeshImport, ReadsOtherFormatsFromTheirFolderAlone) {
  const ModelFolder folder;
  const float points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string bytes(reinterpret_cast<const char*>(points), sizeof points);
  folder.write("inside/points.bin", bytes), folder.write("outside.bin", bytes);
  const TriangleMesh mesh = convert::readSurface(folder.write("inside/a.gltf", gltfWith("points.bin")));
  ASSERT_EQ(mesh.triangles.size(), 1u);
  // Up is y in glTF: the corner at y = 2 is at z = 2 here.
  EXPECT_EQ(mesh.vertices[2], (Vec3{0, 0, 2}));
  const std::string wrong = folder.write("inside/b.gltf", gltfWith("../outside.bin"));
  EXPECT_NE(messageOf([&] { convert::readSurface(wrong); }), "");
}
#endif

/// A broken solid after so many steps: joints that broke, and the farthest way of a piece [m].
struct Outcome {
  int broken = 0;
  double moved = 0;
};
Outcome run(const convert::MeshScene& scene, int steps) {
  WorldOptions options;
  options.params.iterations = scene.file.iterations;
  options.threads = 1;
  World world(scene.file.scene, options);
  Outcome out;
  const std::vector<BodyId> pieces = world.bodies();
  std::vector<Vec3> start;
  for (const BodyId id : pieces) start.push_back(world.state(id).position);
  for (int step = 0; step < steps; ++step) world.step();
  for (const JointId id : world.joints()) out.broken += world.state(id).broken;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    out.moved = std::max(out.moved, length(world.state(pieces[i]).position - start[i]));
  return out;
}

TEST(BrokenSolid, StandsUntilItIsStruck) {
  const ModelFolder folder;
  for (const TriangleMesh& mesh : {ell(), torusMesh(1, 0.35, 24, 12)}) {
    const std::string file = writeMesh(folder, mesh);
    for (const unsigned seed : {1u, 2u}) {
      SCOPED_TRACE(testing::Message() << mesh.triangles.size() << " triangles, seed " << seed);
      convert::FractureOptions how;
      how.pieces = 40, how.seed = seed, how.strike = 40;
      const convert::MeshScene scene = convert::importFracture(file, {}, how);
      EXPECT_GE(scene.file.scene.joints.size(), 40u);
      const Outcome rest = run(scene, 60), struck = run(scene, 100);
      EXPECT_EQ(rest.broken, 0);
      EXPECT_LT(rest.moved, 1e-3);
      EXPECT_GT(struck.broken, 5);
      EXPECT_GT(struck.moved, 0.05);
    }
  }
}

}  // namespace
}  // namespace rubble::test
