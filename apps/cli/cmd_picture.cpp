#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "apps/cli/command.h"
#include "apps/cli/job.h"
#include "apps/cli/output.h"
#include "apps/cli/session.h"
#include "io/recording.h"

namespace rubble::cli {
namespace {

struct PictureCommand {
  JobOptions job;
  PictureOptions picture;
  bool quiet = false;
};

bool isTrajectory(const std::string& name) { return std::filesystem::path(name).extension() == ".rubble"; }

/// The first frame that was taken after so many steps or more; the last one if there is none.
int frameAfter(io::RecordingReader& recording, int steps) {
  int low = 0, high = recording.frameCount() - 1;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (recording.frame(middle).step >= steps) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

/// Bodies of a frame; speeds come from the frame before, or the one after the first.
std::vector<io::PictureBody> bodiesOfFrame(io::RecordingReader& recording, int index) {
  const std::vector<io::RecordedBody> bodies = recording.bodies(index);
  const io::RecordedFrame frame = recording.frame(index);
  const int other = index > 0 ? index - 1 : std::min(1, recording.frameCount() - 1);
  const io::RecordedFrame neighbour = recording.frame(other);
  const double apart = std::fabs(frame.time - neighbour.time);
  const bool moved = apart > 0 && recording.bodies(other) == bodies;
  std::vector<io::PictureBody> drawn;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double speed = moved ? length(frame.poses[i].position - neighbour.poses[i].position) / apart : 0;
    drawn.push_back({bodies[i].shape, frame.poses[i].position, frame.poses[i].orientation, speed,
                     static_cast<std::uint32_t>(bodies[i].id.index), bodies[i].motion});
  }
  return drawn;
}

void fromTrajectory(const PictureCommand& options, const Look& look) {
  io::RecordingReader recording(options.job.scene);
  if (recording.frameCount() == 0) throw Error(options.job.scene, "a trajectory with frames", "none");
  const int last = static_cast<int>(recording.frame(recording.frameCount() - 1).step);
  for (const PictureRequest& request : picturesOf(options.picture, last)) {
    const auto bodies = bodiesOfFrame(recording, frameAfter(recording, request.afterSteps));
    takePicture(bodies, recording.header().gravity, {}, look, request.file);
  }
}

void fromScene(const PictureCommand& options, const Look& look) {
  PreparedJob prepared = prepareJob(options.job);
  const bool atStart = options.picture.at.empty() && !options.job.steps;
  if (atStart) {
    takePicture(io::pictureBodies(prepared.job.scene), prepared.job.scene.gravity, prepared.job.camera, look, options.picture.file);
    return;
  }
  SessionOptions session;
  session.quiet = options.quiet;
  session.look = look;
  session.pictures = picturesOf(options.picture, prepared.steps);
  prepared.steps = std::max_element(session.pictures.begin(), session.pictures.end(), [](const auto& a, const auto& b) {
                     return a.afterSteps < b.afterSteps;
                   })->afterSteps;
  runSession(std::move(prepared), session);
}

int picture(const PictureCommand& options) {
  const Look look = lookOf(options.picture);
  isTrajectory(options.job.scene) ? fromTrajectory(options, look) : fromScene(options, look);
  return kHolds;
}

}  // namespace

void addPicture(CLI::App& app, int& status) {
  auto options = std::make_shared<PictureCommand>();
  CLI::App* command = app.add_subcommand("picture", "Draw a scene (as it begins, or where --at says) or frames of a trajectory");
  command->add_option("scene", options->job.scene, "Name of a scene, a scene file (.json) or a trajectory (.rubble)")->required();
  addPictureOptions(*command, options->picture, "-o,--out");
  command->get_option("--out")->required();
  addArgumentOptions(*command, options->job);
  addSolverOptions(*command, options->job);
  addBackendOptions(*command, options->job);
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  command->callback([options, &status] { status = picture(*options); });
}

}  // namespace rubble::cli
