#pragma once
/// Scenes that are samples, tests and benchmarks at once: a builder, arguments, probes and a verdict.
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <rubble/actuators.h>
#include <rubble/appearance.h>
#include <rubble/rubble.h>
#include <rubble/sensors.h>

namespace rubble::scenes {

/// A number that a scene can be built with.
struct Argument {
  std::string name;
  double value;  ///< default
  double min, max;
  std::string unit;  ///< "1" for none
  std::string doc;
  bool whole = false;  ///< a count: whole numbers only
};
using Arguments = std::map<std::string, double>;

/// What was measured in a run, by name with a unit suffix: "top_drop_m", "fall_ratio".
using Metrics = std::map<std::string, double>;

/// Watches a run and measures.
class Probe {
 public:
  virtual ~Probe() = default;
  virtual void start(const World& world) { (void)world; }
  virtual void afterStep(const World& world, const StepReport& report) { (void)world, (void)report; }
  virtual void finish(const World& world, Metrics& metrics) = 0;
};
using Probes = std::vector<std::unique_ptr<Probe>>;

/// One statement of a verdict: `metric` lies in [min, max].
struct Claim {
  std::string metric;
  double min, max;
  std::string why;
};

struct ClaimResult {
  Claim claim;
  double value = 0;
  bool holds = false;  ///< false also when the metric is missing or not finite
};

struct Verdict {
  bool holds = true;
  std::vector<ClaimResult> results;
};
Verdict judge(const std::vector<Claim>& claims, const Metrics& metrics);

/// Where a picture is taken from. Up is against gravity.
struct Camera {
  Vec3 eye, target;
};

/// Acts on a world before each step, as a player would. It keeps nothing between calls, so a run may be set
/// back.
using Drive = std::function<void(World&)>;

struct Spec {
  std::string name;
  std::string doc;  ///< one sentence; source of the scene
  std::vector<Argument> arguments;
  std::function<Scene(const Arguments&)> build;
  std::function<Probes(const Arguments&, const Scene&)> probes;
  std::function<std::vector<Claim>(const Arguments&)> claims;
  std::function<Camera(const Arguments&, const Scene&)> camera;
  std::function<Drive(const Arguments&, const Scene&)> driver = {};  ///< none if empty
  int steps = 600;        ///< of a full run at dt 1/60; scaled with dt
  int iterations = 4;     ///< what the verdict is stated for
  int substeps = 1;       ///< likewise
  int smashStep = -1;     ///< first step of the smash phase, or -1
  bool sleeping = false;  ///< its bodies may sleep: what the verdict is about
  bool events = false;    ///< its probes read events
  bool travels = false;   ///< its bodies leave the starting region: pictures use the camera and do not frame
                          ///< the beginning
  Arguments testArguments;        ///< a size that a test can afford
  int testSteps = 0;              ///< 0: as `steps`
  std::vector<std::string> tags;  ///< "stack", "joint", "friction", "scale" ...
};

const std::vector<Spec>& registry();
/// Throws Error (and names near matches) if there is none.
const Spec& find(const std::string& name);
/// Defaults of a scene with `overrides` on top. Throws Error for an unknown name or a value out of range.
Arguments resolve(const Spec& spec, const Arguments& overrides);

/// A scene that is ready to run, from the registry or from a file.
struct Job {
  Scene scene;
  Probes probes;
  std::vector<Claim> claims;
  Drive drive;  ///< may be empty
  Camera camera;
  Appearance appearance;
  std::vector<SensorDef> sensors;
  std::vector<ActuatorDef> actuators;
  int steps = 600;
  int iterations = 4;
  int substeps = 1;
  int smashStep = -1;
  bool sleeping = false, events = false;
  double dt = 1.0 / 60;  ///< time step that `steps`, `smashStep` and the events are counted in [s]; a runner
                         ///< at another one scales them
};
/// Builds the scene and its probes (those of the spec, and qualityProbe of probes.h).
Job prepare(const Spec& spec, const Arguments& arguments);

struct RunResult {
  Metrics metrics;
  Verdict verdict;
  std::vector<StepReport> reports;
  Quality quality;  ///< at the end
};

/// Called after each step; returns false to stop.
using Observer = std::function<bool(const World&, const StepReport&, int step, int steps)>;

/// Runs a job: applies events, steps, feeds probes, judges.
class Runner {
 public:
  Runner(Job job, const WorldOptions& options);
  World& world() { return world_; }
  const Job& job() const { return job_; }
  Actuators& actuators() { return actuators_; }
  StepReport step();  ///< events of this step, the driver, the actuators, then one step
  RunResult run(int steps, const Observer& observer = {});
  /// Continues from a snapshot of a run of the same job, with the activations that its actuators had. Throws
  /// Error if its parameters are others.
  void resume(const Snapshot& checkpoint, std::span<const double> activations = {});

 private:
  static WorldOptions optionsOf(const Job& job, WorldOptions options);

  Job job_;
  World world_;
  Actuators actuators_;
  bool started_ = false;
};

}  // namespace rubble::scenes
