#pragma once
/// A scene that runs in the viewer, and what the mouse does to it.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/picture.h"
#include "scenes/registry.h"

namespace rubble::viewer {

/// A scene, ready to run.
struct Opened {
  std::string title;
  scenes::Job job;
  WorldOptions world;
};
/// Opens a scene by name or file; throws Error if there is none.
using Opener = std::function<Opened(const std::string&)>;

class Player {
 public:
  explicit Player(Opener opener) : opener_(std::move(opener)) {}

  /// Throws Error and keeps the present scene if it cannot be opened.
  void open(const std::string& scene);
  void restart() { open(scene_); }
  /// Takes the steps that are due after `seconds` of wall clock; at most a few, so that a slow scene becomes slow motion.
  void play(double seconds);
  void step();

  World& world() { return runner_->world(); }
  const scenes::Job& job() const { return runner_->job(); }
  const std::string& scene() const { return scene_; }
  const std::string& title() const { return title_; }
  const StepReport& report() const { return report_; }
  const std::vector<float>& stepTimes() const { return stepTimes_; }  ///< the last ones [ms]
  std::optional<BodyId> bodyWithKey(std::uint32_t key) const;

  /// A ball from a point along a unit direction, a little larger and several times as dense as what the scene is made of.
  BodyId shoot(const Vec3& from, const Vec3& direction, double bodySize);

  /// Takes hold of a body at a point of the world with a ball joint of finite stiffness; bodies that do not move are left alone.
  bool grab(BodyId body, const Vec3& point);
  /// Pulls the held point here.
  void pull(const Vec3& point);
  void release();
  std::optional<BodyId> held() const { return held_; }

  bool paused = false;
  double speed = 1;  ///< seconds of the scene in a second

 private:
  Opener opener_;
  std::unique_ptr<scenes::Runner> runner_;
  std::string scene_, title_;
  StepReport report_;
  std::vector<float> stepTimes_;
  double due_ = 0;  ///< [s] of the scene
  std::optional<BodyId> held_;
  JointDef grip_;
  std::optional<JointId> gripJoint_;
};

}  // namespace rubble::viewer
