#include "render/pose_feed.h"

#if !defined(RUBBLE_HAS_POSE_FEED)
namespace rubble::render {

std::unique_ptr<PoseFeed> makePoseFeed(std::string& why) {
  why = "built without CUDA";
  return nullptr;
}

}  // namespace rubble::render
#endif
