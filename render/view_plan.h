#pragma once
/// How a run is looked at: one camera that shows all that happens, or one that follows; a floor where the
/// scene has none; and walls that hide what moves, which are left out.
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "render/framing.h"

namespace rubble::render {

class Sightlines;

class ViewPlan {
 public:
  /// `moments`: all bodies at some moments of the run, in order; at least one moment. If `turns`, the
  /// direction of the framing is turned where walls hide what moves. Walls that hide most of it then are left
  /// out. `eye`: where the camera is in truth, if not where the framing has it.
  ViewPlan(std::span<const std::vector<io::PictureBody>> moments, const Vec3& gravity, const Framing& framing,
           bool turns = true, const std::optional<Vec3>& eye = {});

  /// Does what moves travel much farther than it is large?
  bool follows() const { return follows_; }
  /// The camera at a moment. Without follow it is the same at all of them.
  Camera camera(std::span<const io::PictureBody> bodies) const;
  /// Has a body gone so far away that the camera does not look for it?
  bool isGone(const io::PictureBody& body) const;
  /// What is drawn of these bodies: without hiding walls, with the floor. Deforming ones stay behind all
  /// others.
  std::vector<io::PictureBody> shown(std::vector<io::PictureBody> bodies) const;

  /// Key of the floor.
  static constexpr std::uint32_t kFloorKey = io::kSoftKeys - 1;

 private:
  void leaveWallsOut(Sightlines& sight, const Vec3& eye);
  /// Lengthens a post of a stand down to the floor.
  void reachTheFloor(io::PictureBody& stand) const;

  Camera camera_;     ///< of the whole run; with follow: of what moves about `middle_`
  Vec3 middle_;       ///< [m]
  Vec3 start_;        ///< middle of what moves, at the start [m]
  double reach_ = 0;  ///< what is farther from there is gone [m]
  bool follows_ = false;
  std::optional<io::PictureBody> floor_;
  std::unordered_set<std::uint32_t> hidden_;
};

}  // namespace rubble::render
