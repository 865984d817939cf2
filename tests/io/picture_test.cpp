#include <filesystem>
#include <fstream>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "io/picture.h"
#include "rubble/error.h"

namespace rubble::io {
namespace {

TEST(Picture, DeformableObjectsKeepKeysOfTheirOwn) {
  Scene scene;
  CableDef rod = straightCable({-5, 0, -2}, {-5, 0, 2}, 8);
  rod.radius = .3;
  ParticlesDef particles;
  particles.vertices = {{4, 0, 0}};
  particles.radius = .5;
  scene.deformables = {clothSheet({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, 4, 4), rod, particles,
                       tetBox({6, 0, 0}, {1, 1, 1}, {1, 1, 1})};
  scene.bodies.emplace_back();
  std::set<std::uint32_t> keys;
  const std::vector<PictureBody> bodies = pictureBodies(World(scene));
  for (const PictureBody& body : bodies) keys.insert(body.key);
  EXPECT_EQ(keys.size(), 5u);
  // what deforms stands last
  EXPECT_FALSE(bodies[1].deforms);
  for (std::size_t i = 2; i < bodies.size(); ++i) EXPECT_TRUE(bodies[i].deforms);
}

TEST(Picture, PngFilesThatCannotBeWrittenAreErrors) {
  EXPECT_THROW(writePng({1, 1, {0, 0, 0}}, "/nowhere/at/all.png"), Error);
}

#if defined(RUBBLE_HAS_PNG)
TEST(Picture, PngFilesHaveTheirSignatureAndSize) {
  const std::string file = (std::filesystem::temp_directory_path() /
                            ("rubble_picture_" + std::to_string(std::random_device{}()) + ".png"))
                               .string();
  writePng({3, 2, std::vector<std::uint8_t>(18, 77)}, file);
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes.substr(16, 8), std::string("\0\0\0\3\0\0\0\2", 8));
  std::filesystem::remove(file);
}
#endif

}  // namespace
}  // namespace rubble::io
