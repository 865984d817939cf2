#pragma once
/// What the window shows: a running scene, two of them side by side, or a recording. All of them can seek to
/// a step.
#include <cstdint>
#include <string>
#include <vector>

#include "io/picture.h"
#include "scenes/registry.h"

namespace rubble::viewer {

class Player;

class Session {
 public:
  virtual ~Session() = default;

  virtual const std::string& title() const = 0;
  /// The running scene; null for a recording.
  virtual Player* live() { return nullptr; }
  /// Pictures beside one another: 1 or 2.
  virtual int sides() const { return 1; }
  virtual std::string label(int) const { return ""; }

  /// Bodies of a side as they are now.
  virtual std::vector<io::PictureBody> bodies(int side, io::ColorBy colorBy) = 0;
  /// All that a camera should show.
  virtual std::vector<io::PictureBody> framed() = 0;
  virtual Vec3 gravity() const = 0;
  virtual scenes::Camera camera() const { return {}; }
  virtual const Appearance& appearance() const = 0;

  virtual double time() const = 0;        ///< [s]
  virtual double dt() const = 0;          ///< [s]
  virtual std::int64_t now() const = 0;   ///< step
  virtual std::int64_t last() const = 0;  ///< step that is known
  /// To the next step; false at the end of a recording.
  virtual bool step() = 0;
  /// To a step from 0 to last().
  virtual void seek(std::int64_t step) = 0;

  /// Takes the steps that are due after `seconds` of wall clock; at most a few, so that a slow scene becomes
  /// slow motion.
  void play(double seconds);

  bool paused = false;
  double speed = 1;  ///< seconds of the scene in a second

 protected:
  double due_ = 0;  ///< [s] of the scene
};

}  // namespace rubble::viewer
