#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "apps/cli/command.h"
#include "apps/cli/job.h"
#include "apps/cli/output.h"
#include "apps/cli/picture_writer.h"
#include "apps/cli/session.h"
#include "io/picture_values.h"
#include "io/recording.h"

namespace rubble::cli {
namespace {

struct PictureCommand {
  JobOptions job;
  PictureOptions picture;
  bool quiet = false, json = false;
};

bool isTrajectory(const std::string& name) { return std::filesystem::path(name).extension() == ".rubble"; }

/// The pictures that were written.
std::vector<PictureRequest> fromTrajectory(const PictureCommand& options, const Look& look) {
  requireWorldless(look.colorBy);
  io::RecordingReader recording(options.job.scene);
  if (recording.frameCount() == 0) throw Error(options.job.scene, "a trajectory with frames", "none");
  const int last = static_cast<int>(recording.frame(recording.frameCount() - 1).step);
  const std::vector<PictureRequest> requests = picturesOf(options.picture, last);
  PictureWriter pictures(requests, look, recording.header().gravity, {}, recording.header().appearance,
                         io::pictureBodies(recording, 0));
  for (const PictureRequest& request : requests)
    pictures.take(request.afterSteps,
                  io::pictureBodies(recording, io::frameAfter(recording, request.afterSteps)));
  return requests;
}

std::vector<io::PictureBody> bodiesAtStart(const PreparedJob& prepared, const Look& look) {
  if (look.colorBy != io::ColorBy::Body && io::knownWithoutWorld(look.colorBy))
    return io::pictureBodies(prepared.job.scene);
  return io::pictureBodies(World(prepared.job.scene, prepared.world), look.colorBy);
}

std::vector<PictureRequest> fromScene(const PictureCommand& options, const Look& look) {
  PreparedJob prepared = prepareJob(options.job);
  const bool atStart = options.picture.at.empty() && !options.job.steps;
  if (atStart) {
    const std::vector<io::PictureBody> bodies = bodiesAtStart(prepared, look);
    PictureWriter({{0, options.picture.file}}, look, prepared.job.scene.gravity, prepared.job.camera,
                  prepared.job.appearance, bodies)
        .take(0, bodies);
    return {{0, options.picture.file}};
  }
  SessionOptions session;
  session.quiet = options.quiet;
  session.look = look;
  session.pictures = picturesOf(options.picture, prepared.steps);
  prepared.steps = std::max_element(session.pictures.begin(), session.pictures.end(),
                                    [](const auto& a, const auto& b) { return a.afterSteps < b.afterSteps; })
                       ->afterSteps;
  runSession(std::move(prepared), session);
  return session.pictures;
}

int picture(const PictureCommand& options) {
  const Look look = lookOf(options.picture);
  const std::vector<PictureRequest> written = isTrajectory(options.job.scene) ? fromTrajectory(options, look)
                                                                              : fromScene(options, look);
  if (options.json) {
    std::vector<std::string> files;
    for (const PictureRequest& each : written) files.push_back(each.file);
    printWritten(files, {{"width", look.width}, {"height", look.height}});
  }
  return kHolds;
}

}  // namespace

void addPicture(CLI::App& app, int& status) {
  auto options = std::make_shared<PictureCommand>();
  CLI::App* command = app.add_subcommand(
      "picture", "Draw a scene (as it begins, or where --at says) or frames of a trajectory");
  command
      ->add_option("scene", options->job.scene,
                   "Name of a scene, a scene file (.json) or a trajectory (.rubble)")
      ->required();
  addPictureOptions(*command, options->picture, "-o,--out");
  command->get_option("--out")->required();
  addArgumentOptions(*command, options->job);
  addSolverOptions(*command, options->job);
  addBackendOptions(*command, options->job);
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  addWrittenOption(*command, options->json);
  command->callback([options, &status] { status = picture(*options); });
}

}  // namespace rubble::cli
