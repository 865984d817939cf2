// The one file that knows which cores a build has, by RUBBLE_HAS_...: a program may be linked with fewer than
// the library (cmake/RubbleFirst.cmake).
#include <algorithm>

#include <rubble/info.h>

#include "world/world_impl.h"

namespace rubble {

namespace f32 {
void stepAvx2(CpuExecutor& executor);
}

namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// The step of the core in float for one of instructionSets(); null: as the core is compiled.
decltype(CpuOptions::variant) variantOf([[maybe_unused]] const std::string& instructionSet) {
#if defined(RUBBLE_HAS_AVX2)
  if (instructionSet == "avx2") return &f32::stepAvx2;
#endif
  return nullptr;
}

/// Multiprocessors of the device that "small-cuda" lays kernels out for.
constexpr int kSmallDevice = 16;

}  // namespace

bool runsOnDevice(const std::string& backend) {
  return backend == "cuda" || backend == "small-cuda" || backend == "lockstep-cuda";
}

std::vector<std::string> backends() {
  std::vector<std::string> names = {"cpu"};
#if defined(RUBBLE_HAS_REFERENCE)
  names.emplace_back("reference");
#endif
#if defined(RUBBLE_HAS_DISTRIBUTED)
  names.emplace_back("distributed");
#endif
  names.emplace_back("backward");
#if defined(RUBBLE_HAS_LOCKSTEP)
  names.insert(names.end(), {"lockstep", "lockstep-backward"});
#endif
  if (cudaReady()) names.insert(names.end(), {"cuda", "small-cuda", "lockstep-cuda"});
  return names;
}

std::vector<std::string> instructionSets() {
  std::vector<std::string> names = {"baseline"};
#if defined(RUBBLE_HAS_AVX2) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx2")) names.emplace_back("avx2");
#endif
  return names;
}

std::unique_ptr<Engine> makeEngine(const WorldOptions& options) {
  const std::string& given = options.instructionSet;
  const CpuOptions cpu{.threads = options.threads,
                       .timings = options.timings,
                       .variant = variantOf(given.empty() ? instructionSets().back() : given),
                       .tasks = options.tasks,
                       .memory = options.memory};
  CpuOptions backward = cpu;
  backward.backward = true;
  if (options.backend == "cpu") return f32::makeCpuEngine(cpu);
  if (options.backend == "backward") return f32::makeCpuEngine(backward);
#if defined(RUBBLE_HAS_REFERENCE)
  if (options.backend == "reference") return f64::makeCpuEngine(cpu);
#endif
#if defined(RUBBLE_HAS_DISTRIBUTED)
  if (options.backend == "distributed") return f32::makeDistributedEngine(options.ranks, cpu);
#endif
#if defined(RUBBLE_HAS_LOCKSTEP)
  if (options.backend == "lockstep")
    // two instruction sets where there are two
    return f32::makeLockstepEngine(
        f32::makeCpuEngine({.threads = 1, .timings = options.timings, .variant = variantOf(given)}),
        f32::makeCpuEngine({.threads = options.threads, .timings = false, .variant = cpu.variant}));
  if (options.backend == "lockstep-backward")
    return f32::makeLockstepEngine(f32::makeCpuEngine(cpu), f32::makeCpuEngine(backward));
#endif
  if (runsOnDevice(options.backend)) {
    if (!cudaReady()) throw Error("backend", "a machine and a build with CUDA", cudaStatus());
    if (options.backend == "cuda") return makeCudaEngine({.timings = options.timings});
    if (options.backend == "small-cuda")
      return makeCudaEngine({.timings = options.timings, .processors = kSmallDevice});
#if defined(RUBBLE_HAS_LOCKSTEP)
    return f32::makeLockstepEngine(f32::makeCpuEngine(cpu), makeCudaEngine({.timings = false}));
#endif
  }
  throw Error("backend", "one of " + joined(backends()), "\"" + options.backend + "\"");
}

void validate(const WorldOptions& options) {
  validate(options.params);
  if (options.threads < 0 || options.threads > kMostThreads)
    throw Error("threads", "a number from 0 to " + std::to_string(kMostThreads),
                std::to_string(options.threads));
  const bool isHost = options.backend == "cpu" || options.backend == "reference";
  if (options.memory.allocate && !isHost)
    throw Error("memory", "none with the backend \"" + options.backend + "\"", "an allocator");
  if (bool(options.memory.allocate) != bool(options.memory.release))
    throw Error("memory", "both functions or none", "one of them");
  if (options.tasks.run) {
    if (!isHost) throw Error("tasks", "none with the backend \"" + options.backend + "\"", "a task system");
    if (options.tasks.parts < 1 || options.tasks.parts > kMostThreads)
      throw Error("tasks.parts", "a number from 1 to " + std::to_string(kMostThreads),
                  std::to_string(options.tasks.parts));
  }
  if (const std::vector<std::string> sets = instructionSets();
      !options.instructionSet.empty() && std::ranges::find(sets, options.instructionSet) == sets.end())
    throw Error("instructionSet", "one of " + joined(sets), "\"" + options.instructionSet + "\"");
  const RankOptions& ranks = options.ranks;
  if (ranks.count < 0 || ranks.count > kMostThreads)
    throw Error("ranks.count", "a number from 0 to " + std::to_string(kMostThreads),
                std::to_string(ranks.count));
  if (ranks.cutInterval < 0) throw Error("ranks.cutInterval", "0 or more", std::to_string(ranks.cutInterval));
  if (!(ranks.maxImbalance >= 0))
    throw Error("ranks.maxImbalance", "0 or more", std::to_string(ranks.maxImbalance));
  if (!(ranks.timeout > 0)) throw Error("ranks.timeout", "more than 0", std::to_string(ranks.timeout));
}

}  // namespace rubble
