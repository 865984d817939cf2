#include "apps/cli/output.h"
#include "apps/cli/job.h"

#include <cstdio>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "io/output_file.h"
#include "io/picture_values.h"
#include "io/scene_json.h"

namespace rubble::cli {
namespace {

constexpr int kLargestSide = 16384;

std::optional<Vec3> pointOf(const std::vector<double>& numbers) {
  if (numbers.empty()) return std::nullopt;
  return Vec3{numbers[0], numbers[1], numbers[2]};
}

void parseSize(const std::string& text, int& width, int& height) {
  int read = 0;
  const bool good = std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &read) == 2 &&
                    read == static_cast<int>(text.size());
  if (!good || width < 1 || height < 1 || width > kLargestSide || height > kLargestSide)
    throw Error("--size", fmt::format("WIDTHxHEIGHT of 1 to {} pixels", kLargestSide), text);
}

}  // namespace

void addPictureOptions(CLI::App& app, PictureOptions& options, const std::string& fileOption) {
  app.add_option(fileOption, options.file, "Write a picture (PNG) at the end, or where --at says")
      ->type_name("FILE");
  app.add_option("--at", options.at,
                 "Take the picture after these numbers of steps (0: the start); several files are numbered")
      ->delimiter(',')
      ->check(wholeNumber(0));
  addViewOptions(app, options);
}

std::vector<std::string> colorKeys() {
  std::vector<std::string> keys;
  for (const io::Quantity& quantity : io::quantities()) keys.emplace_back(quantity.key);
  return keys;
}

void requireWorldless(io::ColorBy colorBy) {
  if (!io::knownWithoutWorld(colorBy))
    throw Error("--color-by", "body or speed for a trajectory, which has poses alone",
                io::quantity(colorBy).key);
}

void addViewOptions(CLI::App& app, PictureOptions& options) {
  app.add_option("--eye", options.eye, "Where the camera is [m] (default: as the scene says)")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  app.add_option("--target", options.target, "What the camera looks at [m]")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  app.add_option("--fov", options.fieldOfView, "Vertical field of view [degrees]")
      ->check(CLI::Range(1.0, 150.0))
      ->capture_default_str();
  app.add_option("--size", options.size, "Size of the picture in pixels")
      ->type_name("WxH")
      ->capture_default_str();
  app.add_option("--color-by", options.colorBy, "What the colors show")
      ->check(CLI::IsMember(colorKeys()))
      ->capture_default_str();
}

Look lookOf(const PictureOptions& options) {
  Look look;
  look.eye = pointOf(options.eye);
  look.target = pointOf(options.target);
  parseSize(options.size, look.width, look.height);
  look.fieldOfView = options.fieldOfView * std::numbers::pi / 180;
  look.colorBy = io::colorByNamed(options.colorBy);
  return look;
}

std::vector<PictureRequest> picturesOf(const PictureOptions& options, int steps) {
  if (options.file.empty()) {
    if (!options.at.empty()) throw Error("--at", "a file for the pictures as well (--picture FILE)", "none");
    return {};
  }
  if (options.at.empty()) return {{steps, options.file}};
  const std::filesystem::path path(options.file);
  std::vector<PictureRequest> requests;
  for (const int at : options.at) {
    if (at > steps)
      throw Error("--at", fmt::format("at most the number of steps, {}", steps), std::to_string(at));
    const std::string numbered = fmt::format("{}-{:06}{}", path.stem().string(), at,
                                             path.extension().string());
    requests.push_back(
        {at, options.at.size() == 1 ? options.file : (path.parent_path() / numbered).string()});
  }
  return requests;
}

void requireWritable(const std::string& file) {
  if (!file.empty() && file != "-") const io::NewFile canBeWritten(file);
}

void writeOutput(const std::string& file, const std::string& text) {
  if (file == "-") {
    fmt::print("{}", text);
  } else {
    io::writeText(file, text);
  }
}

void addWrittenOption(CLI::App& app, bool& json) {
  app.add_flag("--json", json, "Say what was written as JSON");
}

void printWritten(const std::vector<std::string>& files, const nlohmann::ordered_json& facts) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const std::string& file : files) {
    if (file.empty()) continue;
    std::error_code none;
    const std::uintmax_t bytes = std::filesystem::file_size(file, none);
    list.push_back(
        {{"file", file}, {"bytes", none ? nlohmann::ordered_json() : nlohmann::ordered_json(bytes)}});
  }
  nlohmann::ordered_json record{{"files", std::move(list)}};
  record.update(facts);
  fmt::print("{}\n", record.dump(2));
}

}  // namespace rubble::cli
