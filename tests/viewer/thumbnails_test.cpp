#include <cstdlib>

#include <gtest/gtest.h>

#include <rubble/error.h>

#include "apps/viewer/thumbnails.h"
#include "render/headless.h"

namespace rubble::viewer {
namespace {

TEST(Thumbnails, AreDrawnOnceWhenASceneHasBeenLookedAtForAMoment) {
  setenv("RUBBLE_GL", "software", 1);
  const render::HeadlessContext context;
  Thumbnails thumbnails;
  EXPECT_EQ(thumbnails.of("pendulum", 1), 0u);
  EXPECT_EQ(thumbnails.of("tower", 1.1), 0u) << "the list scrolls";
  EXPECT_EQ(thumbnails.of("pendulum", 1.2), 0u);
  const GLuint texture = thumbnails.of("pendulum", 1.5);
  EXPECT_NE(texture, 0u);
  EXPECT_EQ(thumbnails.of("pendulum", 9), texture);
  EXPECT_EQ(thumbnails.drawn(), 1u);
  EXPECT_EQ(thumbnails.of("no-such-scene", 10), 0u);
  EXPECT_THROW(thumbnails.of("no-such-scene", 11), Error);
  EXPECT_EQ(thumbnails.of("no-such-scene", 12), 0u) << "said once";
  EXPECT_NE(thumbnailOf("tower", 64, 36).rgb, thumbnailOf("pyramid", 64, 36).rgb);
}

}  // namespace
}  // namespace rubble::viewer
