/// The programs of the how-to pages do what the pages say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <future>
#include <iterator>
#include <string>
#include <vector>

#include <rubble/mesh.h>
#include <rubble/rubble.h>

// their headers are included already
namespace wallGame {
#include "examples/wall_game.cpp"
}
namespace saveLoad {
#include "examples/save_load.cpp"
}
namespace hills {
#include "examples/hills.cpp"
}
namespace recipes {
#include "examples/recipes.cpp"
}
namespace knockWall {
#include "examples/knock_wall.cpp"
}

TEST(HowTo, WallGameIsWon) { EXPECT_EQ(wallGame::main(), 0); }
TEST(HowTo, SaveAndLoadComeToTheSameEnd) { EXPECT_EQ(saveLoad::main(), 0); }
TEST(HowTo, CarDrivesOverTheHills) { EXPECT_EQ(hills::main(), 0); }
TEST(HowTo, RecipesDoWhatTheirPagesSay) { EXPECT_EQ(recipes::main(), 0); }

/// Each part of the tutorial prints what its page says.
TEST(Tutorial, PrintsWhatItsPageShows) {
  std::ifstream file(RUBBLE_SOURCE_DIR "/docs/tutorial.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  for (int part = 1; part <= 6; ++part) {
    std::string program = "knock_wall", number = std::to_string(part);
    char* arguments[] = {program.data(), number.data()};
    testing::internal::CaptureStdout();
    knockWall::main(2, arguments);
    const std::string said = testing::internal::GetCapturedStdout();
    EXPECT_NE(page.find("<!-- prints " + number + " -->\n```\n" + said + "```\n"), std::string::npos) << said;
  }
}
