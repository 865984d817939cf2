#include <filesystem>

#include <fmt/format.h>

#include "apps/cli/command.h"
#include "apps/cli/job.h"
#include "apps/cli/render_job.h"
#include "apps/cli/session.h"
#include "apps/cli/text_report.h"
#include "render/film.h"
#include "render/painter.h"

namespace rubble::cli {
namespace {

constexpr int kDemoSteps = 600;
constexpr int kDemoIterations = 4;
/// When the pictures are taken: so many steps after the smash.
constexpr int kImpact = 45;
constexpr int kAfter = 150;

struct DemoOptions {
  JobOptions job;
  std::string folder = "out";
  bool quiet = false;
  bool noFilm = false;
  bool json = false;
};

std::vector<PictureRequest> demoPictures(const std::filesystem::path& folder, int smashStep, int steps) {
  const auto file = [&](const char* name) { return (folder / name).string(); };
  std::vector<PictureRequest> requests;
  const auto add = [&](int after, const char* name) {
    if (after >= 0 && after < steps) requests.push_back({after, file(name)});
  };
  add(0, "1-start.png");
  if (smashStep >= 0) {
    add(smashStep, "2-settled.png");
    add(smashStep + kImpact, "3-impact.png");
    add(smashStep + kAfter, "4-after.png");
  }
  requests.push_back({steps, file("5-end.png")});
  return requests;
}

/// What the renderer lacks; "" if it can draw.
std::string whyNoPictures() {
  try {
    render::makePaintDevice();
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

/// Makes a film of the trajectory. Throws Error where there can be none.
void filmOf(const std::filesystem::path& folder, bool quiet) {
  if (render::ffmpegProgram().empty()) throw Error("ffmpeg is not on PATH");
  RenderOptions film;
  film.job.scene = (folder / "trajectory.rubble").string();
  film.out = (folder / "film.mp4").string();
  film.overlay = true;
  film.quiet = quiet;
  if (render::makePaintDevice()->isSoftware()) film.samples = 1;
  renderFilm(film);
}

int demo(DemoOptions options) {
  if (options.job.scene.empty()) options.job.scene = options.job.backend == "cuda" ? "ring-110k" : "pile-10k";
  PreparedJob prepared = prepareJob(options.job);
  const std::filesystem::path folder = options.folder;
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw Error("--out", "a folder that can be made", failed.message());

  SessionOptions session;
  session.quiet = options.quiet;
  session.recordFile = (folder / "trajectory.rubble").string();
  const std::string noPictures = whyNoPictures();
  if (noPictures.empty()) session.pictures = demoPictures(folder, prepared.job.smashStep, prepared.steps);
  const SessionResult result = runSession(std::move(prepared), session);
  const std::string text = textReport(result.record, result.reports);
  const std::string report = (folder / "report.json").string(), textFile = (folder / "report.txt").string();
  writeOutput(report, io::toJson(result.record));
  writeOutput(textFile, text);
  std::vector<std::string> files{report, textFile, session.recordFile}, missing;
  for (const PictureRequest& request : session.pictures) files.push_back(request.file);
  if (!noPictures.empty()) missing.push_back("no pictures: " + noPictures);
  if (!options.noFilm && noPictures.empty()) {
    try {
      filmOf(folder, options.quiet);
      files.push_back((folder / "film.mp4").string());
    } catch (const Error& error) {
      missing.push_back(fmt::format("no film: {}", error.what()));
    }
  }
  if (options.json) {
    printWritten(files, {{"missing", missing}, {"holds", result.record.holds}});
  } else {
    fmt::print("{}\nwritten to {}:\n", text, folder.string());
    for (const std::string& file : files)
      fmt::print("  {}\n", std::filesystem::path(file).filename().string());
    for (const std::string& line : missing) fmt::print("  {}\n", line);
  }
  return result.record.holds ? kHolds : kDoesNotHold;
}

}  // namespace

void addDemo(CLI::App& app, int& status) {
  auto options = std::make_shared<DemoOptions>();
  options->job.steps = kDemoSteps;
  options->job.iterations = kDemoIterations;
  CLI::App* command = app.add_subcommand(
      "demo", "Smash a 40-level pile; write a report, a trajectory, pictures and a film");
  command->add_option("--scene", options->job.scene,
                      "Another scene or scene file (default: ring-110k on cuda, else pile-10k)");
  command->add_option("-o,--out", options->folder, "Folder to write to")->capture_default_str();
  addArgumentOptions(*command, options->job);
  addSolverOptions(*command, options->job);
  auto* backend = command->add_option("-b,--backend", options->job.backend,
                                      "Where the step runs (default: cuda where there is a GPU, else cpu)");
  command->add_option("-t,--threads", options->job.threads, "Worker threads; 0 is one a core")
      ->check(wholeNumber(0))
      ->capture_default_str();
  command->add_flag("--no-film", options->noFilm, "Pictures only");
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  addWrittenOption(*command, options->json);
  command->callback([options, backend, &status] {
    if (backend->count() == 0) options->job.backend = bestBackend();
    status = demo(*options);
  });
}

}  // namespace rubble::cli
