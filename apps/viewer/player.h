#pragma once
/// A scene that runs in the viewer, or two scenes that are compared, and the inputs to them.
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/history.h"
#include "apps/viewer/session.h"

namespace rubble::viewer {

/// A request to show a scene.
struct Request {
  std::string scene;            ///< a name, or a file
  scenes::Arguments arguments;  ///< that differ from the usual ones
  std::string backend;          ///< "": the usual one
};
/// A scene, ready to run.
struct OpenedScene {
  std::string title;
  std::string label;  ///< of one side: "cpu, 4 iterations"
  scenes::Job job;
  WorldOptions world;
  std::vector<scenes::Argument> arguments =
      {};  ///< that the scene can be built with, with the values that it has
};
/// Opens the scene of a side; throws Error if there is none.
using SceneOpener = std::function<OpenedScene(const Request&, int side)>;

/// Measurements of a step, for plots.
struct StepRecord {
  std::int64_t step = 0;
  double totalMs = 0;
  std::vector<StageTime> stages;
  // NaN unless the step is taken with measureEnergy
  double kinetic = std::numeric_limits<double>::quiet_NaN();    ///< [J]
  double potential = std::numeric_limits<double>::quiet_NaN();  ///< [J]
  double error = std::numeric_limits<double>::quiet_NaN();      ///< largest penetration or gap [m]
};

class Player final : public Session {
 public:
  /// Throws Error if the scene cannot be opened.
  Player(const SceneOpener& opener, const Request& request, int sides = 1);

  Player* live() override { return this; }
  const std::string& title() const override { return title_; }
  int sides() const override { return static_cast<int>(runners_.size()); }
  std::string label(int side) const override { return labels_[static_cast<std::size_t>(side)]; }
  std::vector<io::PictureBody> bodies(int side, io::ColorBy colorBy) override {
    return io::pictureBodies(world(side), colorBy);
  }
  std::vector<io::PictureBody> framed() override { return io::pictureBodies(job().scene, true); }
  Vec3 gravity() const override { return runners_.front()->world().gravity(); }
  scenes::Camera camera() const override { return runners_.front()->job().camera; }
  const Appearance& appearance() const override { return job().appearance; }
  double time() const override { return runners_.front()->world().time(); }
  double dt() const override { return runners_.front()->world().params().dt; }
  std::int64_t now() const override { return runners_.front()->world().stepCount(); }
  std::int64_t last() const override { return history_.branch().last; }
  bool step() override;
  void seek(std::int64_t step) override;
  /// Switches to the end of another branch.
  void choose(int branch);

  World& world(int side = 0) { return runners_[static_cast<std::size_t>(side)]->world(); }
  const scenes::Job& job() const { return runners_.front()->job(); }
  const Request& request() const { return request_; }
  const std::string& backend() const { return backend_; }
  const std::vector<scenes::Argument>& arguments() const { return arguments_; }
  const History& history() const { return history_; }
  const StepReport& report(int side = 0) const { return reports_[static_cast<std::size_t>(side)]; }
  const std::vector<StepRecord>& records() const { return records_; }
  bool measureEnergy = false;

  /// Applies an input to all worlds and records it in the branch. `replaces`: it replaces an input of the
  /// same name in the same step.
  void apply(const std::string& what, std::function<void(World&)> change, bool replaces = false);
  /// Changes parameters of all worlds.
  void changeParams(const std::string& what, std::function<void(Params&)> change);
  /// A new number on each call, for names.
  int nextNumber() { return ++numbers_; }
  std::optional<BodyId> bodyWithKey(std::uint32_t key) const;

 private:
  void measure();
  /// Restores the checkpoint at or before a step.
  void restore(std::int64_t step);
  /// Applies the recorded inputs of this step that are still due.
  void applyDue();

  std::vector<std::unique_ptr<scenes::Runner>> runners_;
  std::vector<std::string> labels_;
  std::string title_, backend_;
  Request request_;
  std::vector<scenes::Argument> arguments_;
  History history_;
  std::vector<StepReport> reports_;
  std::vector<StepRecord> records_;
  int numbers_ = 0;
};

/// How the next step converges: after 1, 2, ... iterations.
struct IterationError {
  double error = 0;   ///< largest penetration or gap of a joint [m]
  double change = 0;  ///< farthest that a body or vertex lies from where one iteration less leaves it [m]
};
/// Takes the next step with 1, 2, ... iterations, each from the present state, which is restored afterwards.
std::vector<IterationError> iterationErrors(World& world);

}  // namespace rubble::viewer
