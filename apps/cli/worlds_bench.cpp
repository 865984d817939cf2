#include "apps/cli/worlds_bench.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <rubble/worlds.h>

namespace rubble::cli {

void benchWorlds(const JobOptions& options, const std::vector<std::string>& scenes, int worlds,
                 const std::vector<int>& threads, bool stages) {
  constexpr int kWarmUp = 20, kSteps = 100;
  using Clock = std::chrono::steady_clock;
  fmt::print("{:<28}{:>8}{:>5}{:>12}{:>12}{:>16}{:>10}\n", "many worlds", "worlds", "thr", "build ms",
             "ms/step", "world steps/s", "MB");
  for (const std::string& scene : scenes)
    for (const int count : threads) {
      JobOptions own = options;
      own.scene = scene, own.threads = count;
      const PreparedJob prepared = prepareJob(own);
      WorldOptions world = prepared.world;
      world.timings = stages;
      const auto begin = Clock::now();
      Worlds batch(world);
      batch.addCopies(prepared.job.scene, worlds);
      const auto built = Clock::now();
      batch.step(kWarmUp);
      const int steps = options.steps.value_or(kSteps);
      std::vector<StageTime> times;
      const auto start = Clock::now();
      for (int k = 0; k < steps; ++k) {
        const StepReport report = batch.step();
        for (const StageTime& stage : report.stages) {
          const auto found = std::ranges::find(times, stage.name, &StageTime::name);
          (found == times.end() ? times.emplace_back(StageTime{stage.name, 0}) : *found).ms += stage.ms /
                                                                                               steps;
        }
      }
      const auto ms = [](Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); };
      const double each = ms(Clock::now() - start) / steps;
      fmt::print("{:<28}{:>8}{:>5}{:>12.0f}{:>12.3f}{:>16.0f}{:>10.1f}\n", prepared.title, worlds, count,
                 ms(built - begin), each, 1e3 * worlds / each,
                 static_cast<double>(batch.memoryBytes()) / 1e6);
      std::ranges::sort(times, std::greater{}, &StageTime::ms);
      for (const StageTime& stage : times) fmt::print("  {:<26}{:>9.3f} ms\n", stage.name, stage.ms);
    }
}

}  // namespace rubble::cli
