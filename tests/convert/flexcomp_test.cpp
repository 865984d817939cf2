/// <flexcomp> of MJCF: cables, cloth and solids.
#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using convert::Effect;
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

}  // namespace
}  // namespace rubble
