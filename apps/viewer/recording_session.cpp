#include "apps/viewer/recording_session.h"

#include <algorithm>
#include <filesystem>

#include <rubble/error.h>

namespace rubble::viewer {

RecordingSession::RecordingSession(const std::string& file) : reader_(file) {
  if (reader_.frameCount() == 0) throw Error(file, "a trajectory with frames", "none");
  title_ = reader_.header().scene + " (" + std::filesystem::path(file).filename().string() + ")";
  last_ = reader_.frame(reader_.frameCount() - 1).step;
  showFrame(0);
}

void RecordingSession::showFrame(int index) {
  // Decodes before it changes anything: a damaged frame leaves the shown one.
  std::vector<io::PictureBody> bodies = io::pictureBodies(reader_, index);
  frame_ = reader_.frame(index);
  bodies_ = std::move(bodies);
  index_ = index;
}

std::vector<io::PictureBody> RecordingSession::bodies(int, io::ColorBy) { return bodies_; }

bool RecordingSession::step() {
  if (index_ + 1 >= reader_.frameCount()) return false;
  showFrame(index_ + 1);
  return true;
}

void RecordingSession::seek(std::int64_t step) {
  showFrame(io::frameAfter(reader_, std::clamp<std::int64_t>(step, 0, last_)));
}

}  // namespace rubble::viewer
