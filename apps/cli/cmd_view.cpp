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
  std::string screenshot, stateFile;
};

#if defined(RUBBLE_HAS_VIEWER)
int view(const ViewCommand& command) {
  viewer::ViewerOptions options;
  PictureOptions look;
  look.size = command.size;
  options.width = lookOf(look).width;
  options.height = lookOf(look).height;
  options.scene = command.job.scene;
  options.frames = command.frames;
  options.screenshot = command.screenshot;
  options.stateFile = command.stateFile;
  for (const scenes::Spec& spec : scenes::registry()) options.scenes.push_back(spec.name);
  options.open = [job = command.job](const std::string& scene) {
    JobOptions wanted = job;
    wanted.scene = scene;
    // Arguments belong to the scene that they were given for.
    if (scene != job.scene) wanted.arguments.clear();
    PreparedJob prepared = prepareJob(wanted);
    return viewer::Opened{prepared.title, std::move(prepared.job), prepared.world};
  };
  viewer::runViewer(options);
  return kHolds;
}
#else
int view(const ViewCommand&) {
  throw Error("view", "a build with GLFW and Dear ImGui (Debian: apt-get install libglfw3-dev libimgui-dev libepoxy-dev)", "one without");
}
#endif

}  // namespace

void addView(CLI::App& app, int& status) {
  auto command = std::make_shared<ViewCommand>();
  CLI::App* sub = app.add_subcommand("view", "Open a window on a running scene; ? shows the keys");
  sub->add_option("scene", command->job.scene, "Name of a scene, or a scene file (.json)")->required();
  sub->add_option("--size", command->size, "Size of the window in pixels")->type_name("WxH")->capture_default_str();
  sub->add_option("--frames", command->frames, "Close after so many frames")->check(CLI::PositiveNumber);
  sub->add_option("--screenshot", command->screenshot, "Write the last frame (PNG)")->type_name("FILE");
  sub->add_option("--state", command->stateFile, "Write what the window shows, anew in every frame (JSON; for tests)")->type_name("FILE");
  addArgumentOptions(*sub, command->job);
  addSolverOptions(*sub, command->job);
  addBackendOptions(*sub, command->job);
  sub->callback([command, &status] { status = view(*command); });
}

}  // namespace rubble::cli
