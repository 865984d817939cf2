#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/cli/command.h"
#include "apps/cli/job.h"
#include "apps/cli/system.h"
#include "apps/cli/text_report.h"

namespace rubble::cli {
namespace {

struct CompareOptions {
  JobOptions job;
  std::vector<std::string> backends{"cpu", "reference"};
  std::vector<int> threads{0};
  std::optional<double> within;
  int every = 0;
  bool json = false;
};

struct Difference {
  double position = 0;  ///< largest distance between the two places of a body or vertex [m]
  double angle = 0;     ///< largest angle between the two orientations of a body [rad]
  std::string what;     ///< the one that is farthest apart
};

std::string bodyText(const World& world, BodyId id) {
  const std::string& name = world.definition(id).name;
  return name.empty() ? fmt::format("body {}", id.index) : name;
}

/// Vertices of a deformable object that both have.
std::size_t commonVertices(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return std::min(a.size(), b.size());
}
std::string vertexText(DeformableId id, std::size_t vertex) {
  return fmt::format("vertex {} of deformable object {}", vertex, id.index);
}

Difference differenceOf(const World& a, const World& b) {
  Difference result;
  // Written so that a distance that is no number counts as the largest.
  const auto take = [&](double distance, const auto& text) {
    if (distance <= result.position || std::isnan(result.position)) return;
    result.position = distance;
    result.what = text();
  };
  for (const BodyId id : a.bodies()) {
    if (!b.alive(id)) continue;
    const BodyState sa = a.state(id), sb = b.state(id);
    const double distance = length(sa.position - sb.position);
    const Quat turn = conjugate(sa.orientation) * sb.orientation;
    result.angle = std::max(result.angle, 2 * std::atan2(length(turn.v), std::fabs(turn.s)));
    take(distance, [&] { return bodyText(a, id); });
  }
  for (const DeformableId id : a.deformables()) {
    if (!b.alive(id)) continue;
    const std::vector<Vec3> pa = a.positions(id), pb = b.positions(id);
    for (std::size_t i = 0; i < commonVertices(pa, pb); ++i)
      take(length(pa[i] - pb[i]), [&] { return vertexText(id, i); });
  }
  return result;
}

/// The first body or vertex whose state has other bits, and in what; "" if there is none.
std::string firstOtherBits(const World& a, const World& b) {
  for (const BodyId id : a.bodies()) {
    if (!b.alive(id)) return bodyText(a, id) + ", which is gone in one of them";
    const BodyState s = a.state(id), t = b.state(id);
    const char* const what = s.position != t.position                 ? "position"
                             : s.orientation != t.orientation         ? "orientation"
                             : s.velocity != t.velocity               ? "velocity"
                             : s.angularVelocity != t.angularVelocity ? "angular velocity"
                                                                      : nullptr;
    if (what) return fmt::format("{} of {}", what, bodyText(a, id));
  }
  for (const DeformableId id : a.deformables()) {
    if (!b.alive(id)) return fmt::format("deformable object {}, which is gone in one of them", id.index);
    const auto otherOf = [&](const char* what, const std::vector<Vec3>& x,
                             const std::vector<Vec3>& y) -> std::string {
      for (std::size_t i = 0; i < commonVertices(x, y); ++i)
        if (x[i] != y[i]) return fmt::format("{} of {}", what, vertexText(id, i));
      return "";
    };
    if (const std::string other = otherOf("position", a.positions(id), b.positions(id)); !other.empty())
      return other;
    if (const std::string other = otherOf("velocity", a.velocities(id), b.velocities(id)); !other.empty())
      return other;
  }
  return "";
}

/// Steps 1, 2, 5, 10, 20, 50 and so on, or every so many.
bool isShown(int step, int steps, int every) {
  if (step == steps) return true;
  if (every > 0) return step % every == 0;
  int decade = 1;
  while (decade * 10 <= step) decade *= 10;
  return step == decade || step == 2 * decade || step == 5 * decade;
}

PreparedJob prepared(const CompareOptions& options, std::size_t side) {
  JobOptions job = options.job;
  job.backend = options.backends[std::min(side, options.backends.size() - 1)];
  job.threads = options.threads[std::min(side, options.threads.size() - 1)];
  return prepareJob(job);
}

int compareTwo(const CompareOptions& options) {
  PreparedJob jobs[2] = {prepared(options, 0), prepared(options, 1)};
  const int steps = jobs[0].steps;
  scenes::Runner a(std::move(jobs[0].job), jobs[0].world), b(std::move(jobs[1].job), jobs[1].world);
  nlohmann::ordered_json shown = nlohmann::ordered_json::array();
  if (!options.json) {
    fmt::print("{}: {} ({} threads) against {} ({} threads)\n", jobs[0].title, jobs[0].world.backend,
               threadCount(jobs[0].world.threads), jobs[1].world.backend, threadCount(jobs[1].world.threads));
    fmt::print("{:>8}{:>16}{:>16}   {}\n", "step", "position [m]", "angle [rad]", "farthest apart");
  }
  double worst = 0;
  int parted = 0;     // first step after which the states have other bits
  std::string other;  // whose
  for (int step = 1; step <= steps; ++step) {
    a.step();
    b.step();
    const Difference difference = differenceOf(a.world(), b.world());
    worst = std::isnan(difference.position) ? difference.position : std::max(worst, difference.position);
    if (parted == 0) {
      other = firstOtherBits(a.world(), b.world());
      if (!other.empty()) parted = step;
    }
    if (!isShown(step, steps, options.every)) continue;
    if (options.json)
      shown.push_back({{"step", step},
                       {"position_m", difference.position},
                       {"angle_rad", difference.angle},
                       {"farthest", difference.what}});
    else
      fmt::print("{:>8}{:>16.3e}{:>16.3e}   {}\n", step, difference.position, difference.angle,
                 difference.what);
  }
  const bool holds = !options.within || worst <= *options.within;
  if (options.json) {
    nlohmann::ordered_json record{{"scene", jobs[0].title},
                                  {"backends", {jobs[0].world.backend, jobs[1].world.backend}}};
    record["steps"] = std::move(shown);
    record["largest_m"] = worst, record["identical"] = parted == 0, record["holds"] = holds;
    if (parted > 0) record["first_difference"] = {{"step", parted}, {"what", other}};
    fmt::print("{}\n", record.dump(2));
    return holds ? kHolds : kDoesNotHold;
  }
  if (parted > 0)
    fmt::print("not the same bits: the first difference is after step {}, in the {}\n", parted, other);
  else
    fmt::print("identical bits: {}\n", a.world().hash() == b.world().hash()
                                           ? "every state of every step, and all that lasts at the end"
                                           : "every state of every step, though not all that lasts");
  if (!options.within) return kHolds;
  fmt::print("verdict: {}: largest difference {}, wanted at most {}\n", holds ? "holds" : "does not hold",
             lengthText(worst), lengthText(*options.within));
  return holds ? kHolds : kDoesNotHold;
}

int lockstep(const CompareOptions& options) {
  PreparedJob job = prepared(options, 0);
  scenes::Runner runner(std::move(job.job), job.world);
  for (int step = 1; step <= job.steps; ++step) {
    runner.step();
    const std::string found = runner.world().firstDifference();
    if (found.empty()) continue;
    fmt::print("{}: first difference in step {}: {}\n", job.title, step, found);
    return kDoesNotHold;
  }
  fmt::print("{}: no difference in {} steps\n", job.title, job.steps);
  return kHolds;
}

int compare(const CompareOptions& options) {
  if (options.backends.size() == 1 && options.backends[0].starts_with("lockstep")) return lockstep(options);
  if (options.backends.size() > 2)
    throw Error("--backends", "two backends, or lockstep alone", fmt::format("{}", options.backends.size()));
  if (options.threads.size() > 2)
    throw Error("--threads", "one or two numbers", fmt::format("{}", options.threads.size()));
  return compareTwo(options);
}

}  // namespace

void addCompare(CLI::App& app, int& status) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command = app.add_subcommand(
      "compare", "Run a scene on two backends side by side and show how far apart they come");
  command->add_option("scene", options->job.scene, "Name of a scene, or a scene file (.json)")->required();
  addArgumentOptions(*command, options->job);
  addSolverOptions(*command, options->job);
  command
      ->add_option("-b,--backends", options->backends,
                   "The two backends; one name stands for both; 'lockstep' or 'lockstep-cuda' alone "
                   "compares kernel by kernel")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("-t,--threads", options->threads, "Worker threads of each; 0 is one a core")
      ->delimiter(',')
      ->check(wholeNumber(0))
      ->capture_default_str();
  command
      ->add_option("--every", options->every, "Show every so many steps (default: 1, 2, 5, 10, 20, 50 ...)")
      ->check(wholeNumber(1));
  command
      ->add_option("--within", options->within,
                   "Wanted: no body farther apart than this [m]; else the exit status is 1")
      ->check(notBelowZero());
  command->add_flag("--json", options->json, "As JSON");
  command->callback([options, &status] { status = compare(*options); });
}

}  // namespace rubble::cli
