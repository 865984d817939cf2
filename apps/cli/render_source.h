#pragma once
/// Moments of a scene that is being simulated, or of a recording.
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
  double stepMs = 0;  ///< wall clock of the step [ms]; 0 where nothing was simulated
  std::vector<render::Line> lines = {};  ///< over the picture
};

class MomentSource {
 public:
  virtual ~MomentSource() = default;
  /// Takes the next step. False at the end; the moment is then as it was.
  virtual bool advance(Moment& moment) = 0;
  /// The scene as it begins, without what comes later.
  virtual Moment start() = 0;
  /// Number of steps from the start to the end.
  virtual int steps() const = 0;
  virtual double dt() const = 0;  ///< [s]
  virtual Vec3 gravity() const = 0;
  /// Everything that a camera should show.
  virtual std::vector<io::PictureBody> framed() const = 0;
  /// Camera of the scene; eye at target if it has none.
  virtual scenes::Camera camera() const = 0;
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
