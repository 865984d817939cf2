#pragma once
/// Pictures at chosen steps of a run or a trajectory.
#include <memory>
#include <vector>

#include "apps/cli/output.h"
#include "render/film.h"
#include "render/painter.h"
#include "render/view_plan.h"

namespace rubble::cli {

class PictureWriter {
 public:
  /// `atStart` is the scene as it begins, for light and colors. A camera whose eye is at its target stands
  /// for one that shows everything, around walls. Walls that hide what moves are left out. Throws Error if
  /// the pictures cannot be drawn or written. Nothing is made ready if there are no requests.
  PictureWriter(const std::vector<PictureRequest>& requests, const Look& look, const Vec3& gravity,
                const scenes::Camera& camera, const Appearance& appearance,
                const std::vector<io::PictureBody>& atStart);

  /// Is a picture due after so many steps?
  bool isDue(int steps) const;
  /// Draws the bodies into every file that is due after so many steps.
  void take(int steps, const std::vector<io::PictureBody>& bodies);

 private:
  struct View {
    std::vector<io::PictureBody> bodies;  ///< that are drawn
    render::Camera camera;
  };
  /// Of the scene as it begins and as it is at some moment.
  View viewOf(const std::vector<io::PictureBody>& bodies) const;

  struct Due {
    int steps;
    std::unique_ptr<render::PictureSink> sink;
  };
  std::vector<Due> due_;
  Look look_;
  Vec3 gravity_;  ///< [m/s2]
  scenes::Camera camera_;
  std::vector<io::PictureBody> start_;
  std::unique_ptr<render::PaintDevice> device_;
  std::unique_ptr<render::Painter> painter_;
};

}  // namespace rubble::cli
