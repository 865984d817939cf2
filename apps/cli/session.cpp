#include "apps/cli/session.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include "apps/cli/measure.h"
#include "apps/cli/picture_writer.h"
#include "apps/cli/processes.h"
#include "apps/cli/progress.h"
#include "backend/distributed/transport.h"
#include "io/crc32.h"
#include "io/input_log.h"
#include "io/output_file.h"
#include "io/picture_poses.h"
#include "io/recording.h"
#include "io/scene_json.h"

namespace rubble::cli {
namespace {

/// Feeds a recording, if there is one.
class Recorder {
 public:
  Recorder(const std::string& file, const std::string& title, const Appearance& appearance, int threads,
           World& world) {
    if (file.empty()) return;
    transport_ = Processes::transport();
    io::requireRecordingName(file);
    learn(world);
    const double resolution = io::recordingResolution(bodies_, io::recordedSofts(world));
    writer_.emplace(file,
                    io::RecordingHeader{title, world.params().dt, world.gravity(), resolution, appearance},
                    io::RecordingOptions{threads, transport_.get()});
    record(world);
  }

  /// Fetches poses and nothing else, while bodies neither come nor go.
  void record(World& world) {
    if (!writer_) return;
    if (world.epoch() != epoch_) learn(world);
    // sheets tear
    writer_->write(bodies_, io::recordedFrame(world, sources_), io::recordedSofts(world));
  }

  void finish() {
    if (writer_) writer_->finish();
  }

 private:
  void learn(World& world) {
    epoch_ = world.epoch();
    bodies_ = io::recordedBodies(world);
    sources_ = io::poseSources(world);
  }

  std::unique_ptr<Transport> transport_;
  std::optional<io::RecordingWriter> writer_;
  std::int64_t epoch_ = -1;
  std::vector<io::PoseSource> sources_;
  std::vector<io::RecordedBody> bodies_;
};

}  // namespace

namespace {

std::vector<std::byte> readBytes(const std::string& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  std::vector<std::byte> out(stream ? static_cast<std::size_t>(stream.tellg()) : 0);
  stream.seekg(0);
  if (!stream.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size())))
    throw Error(file, "a file that can be read", "none");
  return out;
}

/// A checkpoint is this line, which names the scene of its run, the activations of its actuators and a save
/// game.
constexpr std::string_view kCheckpoint = "rubble checkpoint 1, scene ";

/// Scene of a run, by a checksum of all that it says, and its title.
std::string sceneOf(const scenes::Job& job, const std::string& title) {
  io::SceneFile file;
  file.scene = job.scene;
  file.actuators = job.actuators;
  const std::string text = io::toJson(file);
  return fmt::format("{:08x} ({})", io::crc32(text.data(), text.size()), title);
}
/// Without the title, which may have arguments in another order.
std::string checksumOf(const std::string& scene) { return scene.substr(0, scene.find(' ')); }

/// Resumes from a checkpoint of a run of the same scene. Throws Error for another file.
void resume(scenes::Runner& runner, const std::string& file, const std::string& scene) {
  const std::vector<std::byte> bytes = readBytes(file);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t end = text.starts_with(kCheckpoint) ? text.find('\n') : text.npos;
  if (end == text.npos) throw Error(file, "a checkpoint that 'rubble run' wrote", "another file");
  const std::string found(text.substr(kCheckpoint.size(), end - kCheckpoint.size()));
  if (checksumOf(found) != checksumOf(scene)) throw Error(file, "a checkpoint of scene " + scene, found);
  std::vector<double> activations(runner.actuators().activations().size());
  const std::size_t size = activations.size() * sizeof(double);
  if (bytes.size() - (end + 1) < size) throw Error(file, "a whole checkpoint", "a part of one");
  std::memcpy(activations.data(), bytes.data() + end + 1, size);
  runner.resume(Snapshot::fromBytes(std::span(bytes).subspan(end + 1 + size)), activations);
}

/// Replaces the checkpoint, or leaves the one before. Without a file the state is gathered, as other ranks
/// need it.
void writeCheckpoint(const std::string& file, const std::string& scene, scenes::Runner& runner) {
  const std::vector<std::byte> state = runner.world().snapshot().bytes();
  if (file.empty()) return;
  io::OutputFile out(file);
  out.stream() << kCheckpoint << scene << '\n';
  const std::span<const double> activations = runner.actuators().activations();
  out.stream().write(reinterpret_cast<const char*>(activations.data()),
                     static_cast<std::streamsize>(activations.size_bytes()));
  out.stream().write(reinterpret_cast<const char*>(state.data()), static_cast<std::streamsize>(state.size()));
  out.finish();
}

/// Writes the readings of all sensors, a row for each step.
class SensorLog {
 public:
  SensorLog(const std::string& file, const std::vector<SensorDef>& sensors, World& world) {
    if (file.empty()) return;
    if (sensors.empty()) throw Error("--sensors", "a scene with sensors", "one without");
    sensors_.emplace(sensors, world);
    out_.emplace(file);
    out_->stream() << "time";
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const std::string name = sensors[i].name.empty() ? fmt::format("sensor_{}", i) : sensors[i].name;
      const int size = readingSize(sensors[i].type);
      const char* const parts = size == 4 ? "wxyz" : "xyz";
      for (int k = 0; k < size; ++k)
        out_->stream() << ',' << (size == 1 ? name : fmt::format("{}.{}", name, parts[k]));
    }
    out_->stream() << '\n';
    write(world);
  }
  void write(World& world) {
    if (!sensors_) return;
    sensors_->update(world);
    out_->stream() << fmt::format("{}", world.time());
    for (const double value : sensors_->values()) out_->stream() << fmt::format(",{}", value);
    out_->stream() << '\n';
  }
  void finish() {
    if (out_) out_->finish();
  }

 private:
  std::optional<Sensors> sensors_;
  std::optional<io::OutputFile> out_;
};

}  // namespace

SessionResult runSession(PreparedJob prepared, const SessionOptions& options) {
  scenes::Runner runner(std::move(prepared.job), prepared.world);
  std::string scene;
  if (options.checkpointInterval > 0 || !options.resumeFile.empty())
    scene = sceneOf(runner.job(), prepared.title);
  if (!options.resumeFile.empty()) resume(runner, options.resumeFile, scene);
  // steps are counted from the start of the run that the checkpoint is of
  const int taken = static_cast<int>(runner.world().stepCount());
  if (taken > 0 && taken >= prepared.steps)
    throw Error("--steps", fmt::format("more than the {} of the checkpoint", taken),
                std::to_string(prepared.steps));
  prepared.steps -= taken;
  const int smashStep = runner.job().smashStep >= taken ? runner.job().smashStep - taken : -1;
  std::optional<io::InputLog> inputs;
  if (!options.inputsFile.empty())
    inputs.emplace(options.inputsFile, runner.job().scene, prepared.world, runner.world());
  Recorder recorder(options.recordFile, prepared.title, runner.job().appearance, prepared.world.threads,
                    runner.world());
  SensorLog sensors(options.sensorFile, runner.job().sensors, runner.world());
  Progress progress(prepared.title, prepared.steps, options.quiet);
  const bool draws = !options.pictures.empty();
  PictureWriter pictures(options.pictures, options.look, runner.world().gravity(), runner.job().camera,
                         runner.job().appearance,
                         draws ? io::pictureBodies(runner.world()) : std::vector<io::PictureBody>());
  const auto takePictures = [&](const World& world, int stepsTaken) {
    if (pictures.isDue(stepsTaken)) pictures.take(stepsTaken, io::pictureBodies(world, options.look.colorBy));
  };
  takePictures(runner.world(), taken);

  const int quoted = qualityStep(smashStep, prepared.steps, prepared.world.params.dt);
  const int settledEnd = phasesOf(smashStep, prepared.steps).settled.end;
  std::optional<Quality> quality;
  double bytesPerBody = 0;
  io::RunSeries series;
  const scenes::RunResult result = runner.run(
      prepared.steps, [&](const World& world, const StepReport& report, int step, int) {
        if (step == quoted) quality = world.quality();
        if (step + 1 == settledEnd)
          bytesPerBody = static_cast<double>(world.memoryBytes()) / std::max(1, report.bodies);
        if (options.series) {
          const Quality now = world.quality();
          series.time.push_back(world.time());
          series.stepMs.push_back(report.totalMs);
          series.energy.push_back(now.kineticEnergy + now.potentialEnergy);
          series.gapMean.push_back(now.jointGapMean), series.gapMax.push_back(now.jointGapMax);
          series.penetration.push_back(now.penetration.max);
        }
        recorder.record(runner.world());
        sensors.write(runner.world());
        if (options.checkpointInterval > 0 && (taken + step + 1) % options.checkpointInterval == 0)
          writeCheckpoint(options.checkpointFile, scene, runner);
        takePictures(world, taken + step + 1);
        progress.update(step + 1, report.totalMs);
        return true;
      });
  recorder.finish();
  sensors.finish();
  if (inputs) inputs->finish();
  io::RunRecord record = makeRecord(prepared, runner.job(), smashStep, result,
                                    quality.value_or(result.quality));
  record.engineMb = static_cast<double>(runner.world().memoryBytes()) / 1e6;
  record.bytesPerBody = bytesPerBody;
  if (options.hash) record.hash = fmt::format("{:016x}", runner.world().hash());
  if (options.series) record.series = std::move(series);
  return {std::move(record), result.reports};
}

}  // namespace rubble::cli
