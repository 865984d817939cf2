#include <algorithm>
#include <chrono>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/command.h"
#include "apps/cli/job.h"
#include "apps/cli/output.h"
#include "apps/cli/processes.h"
#include "apps/cli/progress.h"
#include "apps/cli/render_job.h"
#include "apps/cli/render_view.h"
#include "apps/cli/session.h"
#include "convert/out/export.h"
#include "convert/out/scratch.h"
#include "render/palette.h"

namespace rubble::cli {
namespace {

struct ExportCommand {
  JobOptions job;
  std::string out, recordFile;
  convert::ExportOptions options;
  bool quiet = false, strict = false, json = false;
};

const std::vector<std::string> kFilms{".mp4", ".mkv", ".mov", ".webm", ".gif"};

bool hasEnding(const std::string& file, const std::vector<std::string>& endings) {
  return std::count(endings.begin(), endings.end(), std::filesystem::path(file).extension().string()) > 0;
}

/// A film of it, with the camera of the scene.
int exportFilm(const ExportCommand& command) {
  if (command.options.from > 0 || command.options.to >= 0 || command.options.resume)
    throw Error("--from, --to, --resume", "a format with frames; 'rubble render' cuts films", command.out);
  RenderOptions options;
  options.job = command.job;
  options.out = command.out;
  options.every = command.options.every > 1 ? command.options.every : 0;
  options.quiet = command.quiet;
  const RenderResult result = renderFilm(options);
  if (command.json)
    printWritten({command.out}, {{"pictures", result.frames}, {"device", result.device}});
  else if (!command.quiet)
    fmt::print("{}: {} pictures, {}\n", command.out, result.frames, result.device);
  return kHolds;
}

/// Writes frames of a recording. `camera`: of the scene; eye at target if it has none.
int exportFrames(const ExportCommand& command, const std::string& recordingFile,
                 const scenes::Camera& camera) {
  io::RecordingReader recording(recordingFile);
  if (!recording.complete())
    fmt::print(stderr, "rubble: {}: the recording was cut off; {} are there\n", recordingFile,
               io::remainder(recording));
  if (recording.frameCount() == 0) throw Error(recordingFile, "a recording with frames", "none");
  const Vec3 gravity = recording.header().gravity;
  const std::vector<io::PictureBody> bodies = io::pictureBodies(
      recording, std::clamp(command.options.from, 0, recording.frameCount() - 1));
  convert::ExportOptions options = command.options;
  const Look look;
  const render::Camera view = cameraOf("scene", {camera, gravity, bodies, true}, look.width, look.height,
                                       look.fieldOfView);
  options.camera = convert::ExportCamera{view.eye, view.target, view.fieldOfView};
  render::Palette palette(bodies, normalize(-gravity));
  options.color = [&palette](const io::PictureBody& body) {
    return Vec3(body.deforms ? palette.softColor(body.key) : palette.look(body).color);
  };
  const int last = options.to < 0 ? recording.frameCount() - 1 : options.to;
  Progress progress(command.out, std::max(1, (last - options.from) / std::max(1, options.every) + 1),
                    command.quiet);
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  Clock::time_point before = start;
  const auto milliseconds = [](Clock::duration d) {
    return std::chrono::duration<double, std::milli>(d).count();
  };
  options.progress = [&](int done, int) {
    const Clock::time_point now = Clock::now();
    progress.update(done, milliseconds(now - before));
    before = now;
  };
  const convert::ExportResult result = convert::exportRecording(recording, command.out, options);
  for (const std::string& note : result.notes) fmt::print(stderr, "rubble: {}: {}\n", command.out, note);
  if (command.json) {
    printWritten({command.out, command.recordFile},
                 {{"frames", result.frames}, {"kept", result.kept}, {"left_out", result.notes}});
  } else if (!command.quiet) {
    const double seconds = milliseconds(Clock::now() - start) / 1000;
    fmt::print("{}: {} frame{} in {:.2f} s, {:.2f} s of it writing", command.out, result.frames,
               result.frames == 1 ? "" : "s", seconds, result.writeSeconds);
    if (result.kept > 0) fmt::print(", {} were there", result.kept);
    std::error_code none;
    const std::uintmax_t size = std::filesystem::file_size(command.out, none);
    if (!none) fmt::print(", {:.1f} MB", static_cast<double>(size) / 1e6);
    fmt::print("\n");
  }
  if (command.strict && !result.notes.empty()) return kDoesNotHold;
  return kHolds;
}

int exportNow(const ExportCommand& command) {
  if (hasEnding(command.out, kFilms)) return exportFilm(command);
  if (!hasEnding(command.out, convert::exportEndings()))
    throw Error("--output",
                fmt::format("a name that ends in {} or {}", fmt::join(convert::exportEndings(), ", "),
                            fmt::join(kFilms, ", ")),
                command.out);
  if (isRecording(command.job.scene)) {
    if (!command.recordFile.empty()) throw Error("--record", "a scene to simulate", command.job.scene);
    return exportFrames(command, command.job.scene, {});
  }
  requireWritable(command.out);
  // A scene is recorded first: into the file that is named, or into one beside the output that goes away.
  PreparedJob prepared = withoutProbes(prepareJob(command.job));
  const scenes::Camera camera = prepared.job.camera;
  std::optional<convert::ScratchFile> scratch;
  if (command.recordFile.empty())
    scratch.emplace((std::filesystem::path(command.out).parent_path() / ".export.rubble").string());
  SessionOptions session;
  session.quiet = command.quiet || !Processes::isFirst();
  session.recordFile = scratch ? scratch->path() : command.recordFile;
  runSession(std::move(prepared), session);
  // the first process has written the recording
  if (!Processes::isFirst()) return kHolds;
  return exportFrames(command, session.recordFile, camera);
}

}  // namespace

void addExport(CLI::App& app, int& status) {
  auto command = std::make_shared<ExportCommand>();
  convert::ExportOptions& options = command->options;
  CLI::App* sub = app.add_subcommand(
      "export", "Write a trajectory or scene for other programs: USD, glTF, OBJ, CSV, NumPy");
  sub->add_option("scene", command->job.scene,
                  "A trajectory (.rubble), or a scene to run: a name, a file (.json) or a model (.xml, "
                  ".urdf, .usd, .glb)")
      ->required();
  sub->add_option(
         "-o,--output", command->out,
         fmt::format("The format is that of the ending: {}, .mp4; frame_%04d.obj for one file a frame",
                     fmt::join(convert::exportEndings(), ", ")))
      ->required()
      ->type_name("FILE");
  sub->add_option("--from", options.from, "First frame")->check(wholeNumber(0));
  sub->add_option("--to", options.to, "Last frame (default: the last one)")->check(wholeNumber(0));
  sub->add_option("--every", options.every, "One frame of so many")->check(wholeNumber(1));
  sub->add_flag("--resume", options.resume, "CSV and OBJ: go on after the frames that are there");
  sub->add_option("--record", command->recordFile, "Of a scene: keep its trajectory (.rubble)")
      ->type_name("FILE");
  sub->add_flag("--strict", command->strict, "Exit status 1 if the format does not hold everything");
  sub->add_flag("-q,--quiet", command->quiet, "No progress");
  addWrittenOption(*sub, command->json);
  addArgumentOptions(*sub, command->job);
  addSolverOptions(*sub, command->job);
  addBackendOptions(*sub, command->job);
  sub->footer("Exit status: 0 written, 1 with --strict if something was left out, 2 bad input.");
  sub->callback([command, &status] { status = exportNow(*command); });
}

}  // namespace rubble::cli
