#pragma once
/// A recording in the window.
#include "apps/viewer/session.h"
#include "io/recording.h"

namespace rubble::viewer {

class RecordingSession final : public Session {
 public:
  /// Throws Error if the file is none, is damaged or has no frames.
  explicit RecordingSession(const std::string& file);

  const std::string& title() const override { return title_; }
  std::vector<io::PictureBody> bodies(int side, io::ColorBy colorBy) override;
  std::vector<io::PictureBody> framed() override { return io::pictureBodies(reader_, 0); }
  Vec3 gravity() const override { return reader_.header().gravity; }
  const Appearance& appearance() const override { return reader_.header().appearance; }
  double time() const override { return frame_.time; }
  double dt() const override { return reader_.header().dt; }
  std::int64_t now() const override { return frame_.step; }
  std::int64_t last() const override { return last_; }
  bool step() override;
  void seek(std::int64_t step) override;
  int frame() const { return index_; }
  int frames() const { return reader_.frameCount(); }
  /// False if the run was cut off: the frames are those that had been written by then.
  bool complete() const { return reader_.complete(); }

 private:
  void showFrame(int index);

  io::RecordingReader reader_;
  std::string title_;
  std::int64_t last_ = 0;
  int index_ = 0;
  io::RecordedFrame frame_;
  std::vector<io::PictureBody> bodies_;
};

}  // namespace rubble::viewer
