#include <fmt/format.h>

#include "apps/cli/command.h"
#include "apps/cli/job.h"
#include "apps/cli/output.h"

#if defined(RUBBLE_HAS_VIEWER)
#include "apps/viewer/viewer.h"
#endif

namespace rubble::cli {
namespace {

struct ViewCommand {
  JobOptions job;
  std::string size = "1280x720";
  int frames = 0;
  std::vector<std::string> compare;
  std::string screenshot, stateFile;
};

#if defined(RUBBLE_HAS_VIEWER)
/// The requested scene. Arguments of the command line apply only to the scene that they were given for.
viewer::OpenedScene opened(JobOptions job, const viewer::Request& request) {
  if (request.scene != job.scene) job.arguments.clear(), job.file.reset();
  job.scene = request.scene;
  for (const auto& [name, value] : request.arguments) {
    const std::string setting = name + "=";
    std::erase_if(job.arguments, [&](const std::string& text) { return text.rfind(setting, 0) == 0; });
    job.arguments.push_back(fmt::format("{}{}", setting, value));
  }
  if (!request.backend.empty()) job.backend = request.backend;
  PreparedJob prepared = prepareJob(job);
  const int iterations = prepared.world.params.iterations;
  viewer::OpenedScene out{
      prepared.title,
      fmt::format("{}, {} iteration{}", prepared.world.backend, iterations, iterations == 1 ? "" : "s"),
      std::move(prepared.job), prepared.world};
  if (!isSceneFile(job.scene)) {
    out.arguments = scenes::find(job.scene).arguments;
    for (const std::string& text : job.arguments) {
      const auto [name, value] = parseAssignment(text, "--arg");
      for (scenes::Argument& argument : out.arguments)
        if (argument.name == name) argument.value = value;
    }
  }
  return out;
}

int view(const ViewCommand& command) {
  viewer::ViewerOptions options;
  PictureOptions look;
  look.size = command.size;
  options.width = lookOf(look).width;
  options.height = lookOf(look).height;
  options.first = {command.job.scene, {}, ""};
  options.frames = command.frames;
  options.screenshot = command.screenshot;
  options.stateFile = command.stateFile;
  const std::vector<JobOptions> jobs = comparedJobs(command.job, command.compare);
  options.sides = static_cast<int>(jobs.size());
  for (const scenes::Spec& spec : scenes::registry()) options.scenes.push_back(spec.name);
  options.open = [jobs](const viewer::Request& request, int side) {
    return opened(jobs[static_cast<std::size_t>(side)], request);
  };
  viewer::runViewer(options);
  return kHolds;
}
#else
int view(const ViewCommand&) {
  throw Error(
      "view",
      "a build with GLFW and Dear ImGui (Debian: apt-get install libglfw3-dev libimgui-dev libepoxy-dev)",
      "one without");
}
#endif

}  // namespace

int viewJob(const JobOptions& job) {
  ViewCommand command;
  command.job = job;
  return view(command);
}

void addView(CLI::App& app, int& status) {
  auto command = std::make_shared<ViewCommand>();
  CLI::App* sub = app.add_subcommand("view", "Open a window on a running scene; ? shows the keys");
  sub->add_option(
         "scene", command->job.scene,
         "Name of a scene, a scene file (.json) a model (.xml, .urdf, .usd, .glb) or a trajectory (.rubble)")
      ->required();
  sub->add_option("--size", command->size, "Size of the window in pixels")
      ->type_name("WxH")
      ->capture_default_str();
  sub->add_option("--compare", command->compare,
                  "Side by side: two backends (cpu,reference) or two numbers of iterations (4,16)")
      ->delimiter(',');
  sub->add_option("--frames", command->frames, "Close after so many frames")->check(wholeNumber(1));
  sub->add_option("--screenshot", command->screenshot, "Write the last frame (PNG)")->type_name("FILE");
  sub->add_option("--state", command->stateFile,
                  "Write what the window shows, anew in every frame (JSON; for tests)")
      ->type_name("FILE");
  addArgumentOptions(*sub, command->job);
  addSolverOptions(*sub, command->job);
  addBackendOptions(*sub, command->job);
  sub->callback([command, &status] { status = view(*command); });
}

}  // namespace rubble::cli
