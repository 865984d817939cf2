#include "apps/cli/edit_bench.h"

#include <chrono>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "apps/cli/output.h"
#include "apps/cli/statistics.h"
#include "apps/cli/system.h"
#include "io/json_text.h"

namespace rubble::cli {
namespace {

using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

constexpr int kManyRays = 100000;

/// A world whose edits leave the scene as it is, so that all steps do the same work.
struct EditedWorld {
  explicit EditedWorld(const PreparedJob& job) : world(job.job.scene, job.world), params(world.params()) {
    for (const BodyId id : world.bodies())
      if (world.definition(id).motion == Motion::Dynamic) dynamic.push_back(id);
    for (const BodyId id : dynamic) {
      const Vec3 x = world.state(id).position;
      low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
      high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    }
    gravity = world.gravity();
  }
  BodyId body() const { return dynamic[static_cast<std::size_t>(turn * 7919) % dynamic.size()]; }
  /// A ray from outside through the scene, another one each time.
  RayQuery ray(int k) const {
    const double angle = 2 * std::numbers::pi * std::fmod(k * std::numbers::phi, 1.0);
    const Vec3 middle = (low + high) / 2, size = high - low;
    const double reach = length(size) + 1;
    RayQuery ray;
    const Vec3 target = low + Vec3{std::fmod(k * .371, 1.0) * size.x, std::fmod(k * .617, 1.0) * size.y,
                                   std::fmod(k * .853, 1.0) * size.z};
    ray.origin = middle + reach * Vec3{std::cos(angle), std::sin(angle), std::sin(3 * angle)};
    ray.direction = target - ray.origin;
    return ray;
  }

  World world;
  Params params;
  Vec3 gravity, low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
  std::vector<BodyId> dynamic, added;
  JointId dragJoint;
  int turn = 0;
  std::vector<RayQuery> rays;
  std::vector<RayHit> hits = std::vector<RayHit>(kManyRays);
};

struct EditCase {
  const char* name;
  const char* what;
  std::function<void(EditedWorld&)> edit;
};

const std::vector<EditCase>& editCases() {
  static const std::vector<EditCase> cases = {
      {"none", "no edit", [](EditedWorld&) {}},
      {"gravity", "another gravity",
       [](EditedWorld& w) { w.world.setGravity(w.gravity * (1 + 1e-7 * (w.turn % 2))); }},
      {"dt", "another time step",
       [](EditedWorld& w) {
         Params params = w.params;
         params.dt *= 1 + 1e-7 * (w.turn % 2);
         w.world.setParams(params);
       }},
      {"body", "one body added",
       [](EditedWorld& w) {
         BodyDef ball;
         ball.shape = Shape::sphere(.05);
         ball.position = w.high + Vec3{1., 1., 1.} * (10. + w.turn);
         w.added.push_back(w.world.addBody(ball));
       }},
      {"drag", "a drag joint replaced",
       [](EditedWorld& w) {
         if (w.world.alive(w.dragJoint)) w.world.removeJoint(w.dragJoint);
         w.dragJoint = w.world.addDragJoint(w.body(), w.world.state(w.body()).position, 1e-3);
       }},
      {"state", "the state of one body written",
       [](EditedWorld& w) { w.world.setState(w.body(), w.world.state(w.body())); }},
      {"force", "a force on one body",
       [](EditedWorld& w) {
         w.world.applyForce(w.body(), {1e-6, 0, 0});
       }},
      {"ray", "one ray",
       [](EditedWorld& w) {
         w.world.castRays({&w.rays[static_cast<std::size_t>(w.turn)], 1});
       }},
      {"rays", "100,000 rays", [](EditedWorld& w) { w.world.castRays(w.rays, w.hits); }},
  };
  return cases;
}

struct EditTimes {
  std::vector<double> edit, whole;  ///< of the edit, and with the step [ms]
};

nlohmann::ordered_json benchScene(const JobOptions& options, int steps) {
  PreparedJob job = prepareJob(options);
  job.world.timings = false;
  EditedWorld w(job);
  for (int k = 0; k < kManyRays; ++k) w.rays.push_back(w.ray(k));
  constexpr int kWarmSteps = 60, kTurns = 4;
  for (int k = 0; k < kWarmSteps; ++k) w.world.step();
  std::vector<EditTimes> times(editCases().size());
  // by turns, so that a drift of the machine meets all of them
  for (int turn = 0; turn < kTurns; ++turn)
    for (std::size_t c = 0; c < times.size(); ++c) {
      for (int k = 0; k < std::max(2, steps / kTurns); ++k, ++w.turn) {
        const auto begin = Clock::now();
        editCases()[c].edit(w);
        const double edit = msSince(begin);
        w.world.step();
        // the first step of a kind may enlarge tables
        if (k == 0) continue;
        times[c].edit.push_back(edit), times[c].whole.push_back(msSince(begin));
      }
      w.world.removeBodies(std::exchange(w.added, {}));
      if (w.world.alive(w.dragJoint)) w.world.removeJoint(w.dragJoint);
      w.world.setGravity(w.gravity), w.world.setParams(w.params);
      w.world.step(), w.world.step();
    }
  nlohmann::ordered_json cases = nlohmann::ordered_json::array();
  std::FILE* const out = stderr;
  fmt::print(out, "{}, {} bodies, {}\n{:<34}{:>14}{:>14}{:>12}\n", job.title, w.dynamic.size(),
             options.backend, "edit before every step", "edit [us]", "with step [ms]", "of no edit");
  const double none = summarize(times[0].whole).median;
  for (std::size_t c = 0; c < times.size(); ++c) {
    const double edit = 1e3 * summarize(times[c].edit).median, whole = summarize(times[c].whole).median;
    fmt::print(out, "{:<34}{:>14.1f}{:>14.3f}{:>12.3f}\n", editCases()[c].what, edit, whole, whole / none);
    cases.push_back({{"edit", editCases()[c].name}, {"edit_us", edit}, {"with_step_ms", whole}});
  }
  return {{"scene", job.title},       {"bodies", w.dynamic.size()}, {"backend", options.backend},
          {"machine", machineName()}, {"date", timestamp()},        {"edits", std::move(cases)}};
}

}  // namespace

void benchEdits(const JobOptions& options, const std::vector<std::string>& scenes, int steps,
                const std::string& jsonFile) {
  nlohmann::ordered_json records = nlohmann::ordered_json::array();
  for (const std::string& scene : scenes) {
    JobOptions job = options;
    job.scene = scene;
    records.push_back(benchScene(job, steps));
  }
  if (!jsonFile.empty()) writeOutput(jsonFile, records.dump(2) + "\n");
}

}  // namespace rubble::cli
