#include "apps/cli/make_bench.h"

#include <fmt/format.h>
#include <rubble/info.h>

#include "apps/cli/output.h"
#include "apps/cli/statistics.h"
#include "apps/cli/system.h"
#include "io/json_text.h"

namespace rubble::cli {
namespace {

/// The time that f() takes [ms].
template <class F> double msOf(F&& f) {
  const double begin = secondsNow();
  f();
  return 1e3 * (secondsNow() - begin);
}

struct Making {
  std::vector<double> scene, world, bodies, write, read, step;  ///< [ms]
};

/// One round: the scene is built, becomes a world, that takes a step; it is written and read as a file.
void makeOnce(const JobOptions& options, Making& times, nlohmann::ordered_json& record) {
  PreparedJob prepared;
  times.scene.push_back(msOf([&] { prepared = prepareJob(options); }));
  const Scene& scene = prepared.job.scene;
  prepared.world.timings = false;
  {
    const double before = residentMb();
    std::optional<World> world;
    times.world.push_back(msOf([&] { world.emplace(scene, prepared.world); }));
    record["world_mb"] = residentMb() - before;
    times.step.push_back(msOf([&] { world->step(); }));
  }
  {
    Scene empty;
    empty.gravity = scene.gravity;
    World world(empty, prepared.world);
    times.bodies.push_back(msOf([&] { world.addBodies(scene.bodies); }));
  }
  io::SceneFile file;
  std::string text;
  file.scene = scene;
  times.write.push_back(msOf([&] { text = io::toJson(file); }));
  std::vector<io::Fault> faults;
  times.read.push_back(msOf([&] { file = io::parseScene(text, faults); }));
  if (!faults.empty()) throw Error(io::faultText(prepared.title, faults));
  record["scene"] = prepared.title;
  record["bodies"] = scene.bodies.size(), record["joints"] = scene.joints.size();
  record["text_mb"] = static_cast<double>(text.size()) / 1e6;
}

nlohmann::ordered_json benchScene(const JobOptions& options, int rounds) {
  Making times;
  nlohmann::ordered_json record{{"kind", "making"}};
  for (int k = 0; k < rounds; ++k) makeOnce(options, times, record);
  const auto put = [&](const char* name, const std::vector<double>& values) {
    record[name] = summarize(values).median;
  };
  put("scene_ms", times.scene), put("world_ms", times.world), put("add_bodies_ms", times.bodies);
  put("first_step_ms", times.step), put("write_ms", times.write), put("read_ms", times.read);
  record["backend"] = options.backend, record["threads"] = threadCount(options.threads);
  record["rounds"] = rounds, record["commit"] = buildInfo().commit;
  record["machine"] = machineName(), record["date"] = timestamp();
  return record;
}

}  // namespace

void benchMaking(const JobOptions& options, const std::vector<std::string>& scenes, int rounds,
                 const std::string& jsonFile) {
  std::FILE* const out = jsonFile == "-" ? stderr : stdout;
  fmt::print(out, "{:<24}{:>10}{:>10}{:>10}{:>10}{:>12}{:>11}{:>9}{:>12}{:>12}\n", "making a world", "bodies",
             "joints", "scene ms", "world ms", "addBodies", "1st step", "MB", "write MB/s", "read MB/s");
  nlohmann::ordered_json records = nlohmann::ordered_json::array();
  for (const std::string& scene : scenes) {
    JobOptions job = options;
    job.scene = scene;
    const nlohmann::ordered_json& r = records.emplace_back(benchScene(job, rounds));
    const auto number = [&](const char* name) { return r[name].get<double>(); };
    const auto rate = [&](const char* time) { return 1e3 * number("text_mb") / number(time); };
    fmt::print(out, "{:<24}{:>10}{:>10}{:>10.1f}{:>10.1f}{:>12.1f}{:>11.1f}{:>9.0f}{:>12.1f}{:>12.1f}\n",
               r["scene"].get<std::string>(), r["bodies"].get<int>(), r["joints"].get<int>(),
               number("scene_ms"), number("world_ms"), number("add_bodies_ms"), number("first_step_ms"),
               number("world_mb"), rate("write_ms"), rate("read_ms"));
  }
  if (!jsonFile.empty()) writeOutput(jsonFile, records.dump(2) + "\n");
}

}  // namespace rubble::cli
