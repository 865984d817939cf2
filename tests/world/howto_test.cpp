/// The programs of the how-to pages do what the pages say.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

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

TEST(HowTo, WallGameIsWon) { EXPECT_EQ(wallGame::main(), 0); }
TEST(HowTo, SaveAndLoadComeToTheSameEnd) { EXPECT_EQ(saveLoad::main(), 0); }
TEST(HowTo, CarDrivesOverTheHills) { EXPECT_EQ(hills::main(), 0); }
