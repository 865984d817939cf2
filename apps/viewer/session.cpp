#include "apps/viewer/session.h"

#include <algorithm>

namespace rubble::viewer {
namespace {

constexpr int kMostStepsAFrame = 4;

}  // namespace

void Session::play(double seconds) {
  if (paused) return;
  due_ = std::min(due_ + seconds * speed, kMostStepsAFrame * dt());
  for (; due_ >= dt(); due_ -= dt()) {
    if (step()) continue;
    paused = true;
    return;
  }
}

}  // namespace rubble::viewer
