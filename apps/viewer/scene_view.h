#pragma once
/// The scene in the window, once or twice side by side, and picking.
#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/orbit.h"
#include "apps/viewer/ui_state.h"
#include "render/stage.h"

namespace rubble::viewer {

/// Result of picking at a pixel.
struct PickResult {
  int side = 0;
  Vec3 point;  ///< [m]
  bool something = false;
  Selection what;  ///< body or vertex; nothing for recordings
};

class SceneView {
 public:
  /// A new scene: light, colors and camera are taken from it.
  void begin(Session& session, int width, int height);
  /// Draws into the window.
  void draw(Session& session, UiState& uiState, int width, int height);

  /// `x`, `y`: pixels from the upper left of the window.
  PickResult pick(Session& session, double x, double y) const;
  /// The joint whose anchor is seen within some pixels.
  std::optional<JointId> jointAt(Player& player, double x, double y) const;
  Vec3 ray(double x, double y) const;
  /// The point of the plane through `depth` that faces the camera.
  Vec3 pointAt(double x, double y, double depth) const;
  double depthOf(const Vec3& point) const;
  /// Shows the selection, or everything.
  void frame(Session& session, const Selection& selection);

  Orbit orbit;
  double bodySize() const { return stages_.front()->setting().bodySize; }

 private:
  double aspect() const { return static_cast<double>(sideWidth()) / height_; }
  int sideWidth() const { return std::max(1, width_ / static_cast<int>(stages_.size())); }
  double across(double x) const;

  std::vector<std::unique_ptr<render::Stage>> stages_;
  render::Quality quality_;
  int width_ = 1, height_ = 1;
};

}  // namespace rubble::viewer
