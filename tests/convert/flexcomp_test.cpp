/// <flexcomp> of MJCF: cables, cloth and solids.
#include <cmath>

#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Import;
using test::expectNear;
using test::importText;
using test::mjcf;

TEST(Flexcomp, PinsOfFlexcompsAreRangesAndPlaces) {
  const auto pinned = [](const std::string& pin) {
    const Import model = importText(
        mjcf("<flexcomp name='f' type='grid' dim='2' count='4 3 1' spacing='.1 .1 .1' "
             "mass='1' pos='0 0 1'><pin " +
             pin + "/><elasticity young='1e5'/></flexcomp>"));
    std::vector<int> fixed = common(model.file.scene.deformables.at(0)).fixed;
    std::sort(fixed.begin(), fixed.end());
    return fixed;
  };
  EXPECT_EQ(pinned("range='2 4'"), (std::vector<int>{2, 3, 4}));
  EXPECT_EQ(pinned("grid='0 2 3 1'"), (std::vector<int>{2, 10}));
  EXPECT_EQ(pinned("gridrange='1 0 2 1'"), (std::vector<int>{3, 4, 6, 7}));
  EXPECT_THROW(pinned("gridrange='1 0 4 1'"), Error);
}

TEST(Flexcomp, FlexcompsAreCablesClothAndSolidsOfTheirMass) {
  for (const int dimension : {1, 2, 3}) {
    const std::string count = dimension == 1 ? "5 1 1" : dimension == 2 ? "5 4 1" : "5 4 3";
    const Import model = importText(mjcf("<flexcomp name='f' type='grid' dim='" + std::to_string(dimension) +
                                         "' count='" + count +
                                         "' spacing='.1 .1 .1' mass='2' pos='0 0 1' radius='.01'><pin id='0 "
                                         "1'/><elasticity young='1e5'/></flexcomp>"));
    ASSERT_EQ(model.file.scene.deformables.size(), 1u);
    const Deformable& object = model.file.scene.deformables[0];
    EXPECT_EQ(object.index(), dimension == 1 ? 2u : dimension == 2 ? 1u : 0u);
    EXPECT_EQ(common(object).fixed, (std::vector{0, 1}));
    EXPECT_EQ(common(object).vertices.size(), dimension == 1 ? 5u : dimension == 2 ? 20u : 60u);
    expectNear(common(object).vertices[0], {-.2, dimension > 1 ? -.15 : 0, dimension > 2 ? .9 : 1});
  }
}

TEST(Flexcomp, ShellsAreTheOuterPointsOfAGridAboutTheirCenter) {
  // 57 points: 64 of the grid, less 8 inside, and the center
  const auto shell = [](const std::string& type, const std::string& more) {
    return importText(mjcf("<flexcomp name='f' type='" + type +
                           "' count='4 4 4' spacing='.2 .2 .2' radius='.01' mass='3'" + more + "/>"))
        .file.scene.deformables.at(0);
  };
  constexpr double kSide = 0.6;
  const auto box = std::get<TetSolidDef>(shell("box", ""));
  EXPECT_EQ(box.vertices.size(), 57u);
  EXPECT_EQ(box.tetrahedra.size(), 6u * 9 * 2);
  EXPECT_NEAR(box.density, 3 / (kSide * kSide * kSide), 1e-9);
  const auto ball = std::get<TetSolidDef>(shell("ellipsoid", ""));
  for (std::size_t k = 1; k < ball.vertices.size(); ++k)
    EXPECT_NEAR(length(ball.vertices[k]), kSide / 2, 1e-12);
  const auto tube = std::get<ClothDef>(shell("cylinder", " dim='2'"));
  EXPECT_EQ(tube.triangles.size(), 5u * 9 * 2) << "without its top";
  double most = 0;
  for (const Vec3& v : tube.vertices) most = std::max(most, std::hypot(v.x, v.y));
  EXPECT_NEAR(most, kSide / 2, 1e-12);
}

TEST(Flexcomp, AMeshIsASolidOfTetrahedraToItsOrigin) {
  const Import model = importText(
      mjcf("<flexcomp name='f' mesh='m' dim='3' origin='.25 .25 .25' mass='1' radius='.01'><pin id='0'/>"
           "</flexcomp>",
           "<asset><mesh name='m' scale='2 2 2' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/></asset>"));
  const auto& solid = std::get<TetSolidDef>(model.file.scene.deformables.at(0));
  EXPECT_EQ(solid.vertices.size(), 5u);
  EXPECT_EQ(solid.tetrahedra.size(), 4u);
  EXPECT_NEAR(solid.density, 6. / 8, 1e-9);
  EXPECT_EQ(solid.fixed, std::vector{0});
  expectNear(solid.vertices[0], {.25, .25, .25});
}

TEST(Flexcomp, ARingIsAClosedCable) {
  const Import model = importText(mjcf(
      "<flexcomp name='f' type='circle' dim='1' count='7 1 1' spacing='.5 .5 .5' radius='.01' mass='1'/>"));
  const auto& ring = std::get<CableDef>(model.file.scene.deformables.at(0));
  EXPECT_TRUE(ring.closed);
  ASSERT_EQ(ring.vertices.size(), 6u);
  for (const Vec3& v : ring.vertices)
    EXPECT_NEAR(length(v), .5, 1e-12) << "sides of a hexagon are its radius";
}

TEST(Flexcomp, SheetsBendOnlyIfTheirElasticityDoes) {
  const auto sheet = [](const std::string& kind) {
    const Import model = importText(mjcf(
        "<flexcomp name='f' dim='2' count='3 3 1' spacing='.1 .1 .1' radius='.01'><elasticity young='3e5' "
        "thickness='.02' elastic2d='" +
        kind + "'/><contact friction='.3' selfcollide='none'/></flexcomp>"));
    return std::get<ClothDef>(model.file.scene.deformables.at(0));
  };
  const double bending = 3e5 * std::pow(.02, 3) / 12;
  EXPECT_NEAR(sheet("both").bendingStiffness.value(), bending, 1e-12);
  EXPECT_NEAR(sheet("bend").bendingStiffness.value(), bending, 1e-12);
  EXPECT_NE(sheet("bend").youngsModulus, 3e5);
  EXPECT_EQ(sheet("stretch").bendingStiffness.value(), 0);
  EXPECT_EQ(sheet("stretch").youngsModulus, 3e5);
  EXPECT_EQ(sheet("both").material.dynamicFriction, .3);
  EXPECT_FALSE(sheet("both").collideSelf);
}

}  // namespace
}  // namespace rubble
