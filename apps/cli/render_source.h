#pragma once
/// Drawn states of a running scene or of a recording.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli/job.h"
#include "io/picture.h"
#include "render/overlay.h"

namespace rubble::cli {

/// Everything that is drawn of one step.
struct Moment {
  std::int64_t step = 0;
  double time = 0;  ///< [s]
  std::vector<io::PictureBody> bodies;
  double stepMs = 0;                     ///< wall clock of the step [ms]; 0 where nothing was simulated
  std::vector<render::Line> lines = {};  ///< over the picture
  std::int64_t epoch = -1;  ///< of the world that the bodies are from (World::epoch); -1: from none
};

class MomentSource {
 public:
  virtual ~MomentSource() = default;
  /// Takes the next step. False at the end.
  virtual bool advance() = 0;
  /// All that is drawn of the present step, at first of the start, written into this moment or a new one. It
  /// visits every body, so call it only for drawn steps.
  virtual void look(Moment& moment) = 0;
  virtual double time() const = 0;      ///< [s]
  virtual double nextTime() const = 0;  ///< after the next step [s]
  virtual double stepMs() const = 0;    ///< wall clock of the last step [ms]; 0 where nothing was simulated
  /// Number of steps from the start to the end.
  virtual int steps() const = 0;
  virtual double dt() const = 0;  ///< [s]
  virtual Vec3 gravity() const = 0;
  /// Everything that a camera should show: bodies of some moments of the run, in order. A scene that is too
  /// large to be run twice has its start alone.
  virtual std::vector<std::vector<io::PictureBody>> course() const = 0;
  /// Camera of the scene; eye at target if it has none.
  virtual scenes::Camera camera() const = 0;
  virtual const Appearance& appearance() const = 0;
  virtual bool smashes() const = 0;
  virtual std::string title() const = 0;
  /// What it is run with: "cpu, 4 iterations"; "" for a recording.
  virtual std::string label() const = 0;
};

/// Is this the name of a recording?
bool isRecording(const std::string& scene);
/// Throws Error if there is no such scene or file, or a recording is empty or damaged.
/// `colorBy` and `overlays` say what its moments have; a recording has poses alone.
std::unique_ptr<MomentSource> momentSource(const JobOptions& options, io::ColorBy colorBy = io::ColorBy::Body,
                                           const render::Overlays& overlays = {});

/// Between two moments, at 0 to 1 of the way; `b` where their bodies differ.
Moment between(const Moment& a, const Moment& b, double at);

}  // namespace rubble::cli
