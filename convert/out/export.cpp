#include "convert/out/export.h"

#include <array>
#include <chrono>
#include <filesystem>
#include <future>

#include <rubble/error.h>

#include "convert/out/frames.h"

namespace rubble::convert {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::unique_ptr<FrameWriter> writerFor(const ExportJob& job) {
  const std::string ending = std::filesystem::path(job.file).extension().string();
  if (ending == ".usda" || ending == ".usdc") return usdWriter(job, ending == ".usda");
  if (ending == ".glb") return gltfWriter(job);
  if (ending == ".obj") return objWriter(job);
  if (ending == ".csv") return csvWriter(job);
  if (ending == ".npz") return npzWriter(job);
  std::string known;
  for (const std::string& one : exportEndings()) known += (known.empty() ? "" : ", ") + one;
  throw Error(job.file, "a name that ends in " + known, "\"" + ending + "\"");
}

}  // namespace

const std::vector<std::string>& exportEndings() {
  static const std::vector<std::string> endings{".usda", ".usdc", ".glb", ".obj", ".csv", ".npz"};
  return endings;
}

ExportResult exportRecording(io::RecordingReader& recording, const std::string& file,
                             const ExportOptions& options) {
  ExportResult result;
  if (recording.frameCount() == 0) throw Error("recording", "frames", "none");
  ExportOptions chosen = options;
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending == ".obj" && !isNumbered(file)) {
    // One file holds one frame: the last one.
    if (chosen.to < 0) chosen.to = recording.frameCount() - 1;
    chosen.from = chosen.to;
  }
  const bool isTable = ending == ".csv" || ending == ".npz";
  FrameSource source(recording, chosen, !isTable);
  const ExportJob job{file, chosen, source, result.notes};
  const std::unique_ptr<FrameWriter> writer = writerFor(job);
  const int count = source.count();
  result.kept = writer->kept();
  // The next frame is decoded while one is written.
  std::array<ExportFrame, 2> frames;
  const auto readFrame = [&](int number) {
    ExportFrame& into = frames[static_cast<std::size_t>(number % 2)];
    return std::async(std::launch::async, [&source, number, &into] { source.read(number, into); });
  };
  std::future<void> next;
  if (result.kept < count) next = readFrame(result.kept);
  for (int number = result.kept; number < count; ++number) {
    next.get();
    if (number + 1 < count) next = readFrame(number + 1);
    const Clock::time_point start = Clock::now();
    writer->write(frames[static_cast<std::size_t>(number % 2)]);
    result.writeSeconds += secondsSince(start);
    ++result.frames;
    if (options.progress) options.progress(number + 1, count);
  }
  const Clock::time_point start = Clock::now();
  writer->finish();
  result.writeSeconds += secondsSince(start);
  return result;
}

}  // namespace rubble::convert
