#include "apps/viewer/playback.h"

#include <algorithm>
#include <filesystem>

#include <rubble/error.h>

namespace rubble::viewer {

Playback::Playback(const std::string& file) : reader_(file) {
  if (reader_.frameCount() == 0) throw Error(file, "a trajectory with frames", "none");
  title_ = reader_.header().scene + " (" + std::filesystem::path(file).filename().string() + ")";
  last_ = reader_.frame(reader_.frameCount() - 1).step;
  show(0);
}

void Playback::show(int index) {
  // What can fail comes first: a damaged frame leaves the one that is shown.
  std::vector<io::PictureBody> bodies = io::pictureBodies(reader_, index);
  frame_ = reader_.frame(index);
  bodies_ = std::move(bodies);
  index_ = index;
}

std::vector<io::PictureBody> Playback::bodies(int, io::ColorBy) { return bodies_; }

bool Playback::step() {
  if (index_ + 1 >= reader_.frameCount()) return false;
  show(index_ + 1);
  return true;
}

void Playback::seek(std::int64_t step) {
  show(io::frameAfter(reader_, std::clamp<std::int64_t>(step, 0, last_)));
}

}  // namespace rubble::viewer
