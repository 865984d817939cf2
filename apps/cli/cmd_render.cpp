#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/command.h"
#include "apps/cli/job.h"
#include "apps/cli/layer_files.h"
#include "apps/cli/output.h"
#include "apps/cli/render_job.h"
#include "apps/cli/render_view.h"

namespace rubble::cli {
namespace {

struct RenderCommand {
  RenderOptions options;
  PictureOptions look;
  double orbitDegrees = 0;
  std::vector<std::string> show;
  int measure = 0;
  bool live = false, json = false;
  std::string background, path, sunColor;
  std::vector<double> sun;
  std::vector<std::string> lights;
};

/// Color of "RRGGBB", 0 to 1 (sRGB).
Vec3 colorNamed(std::string text, const std::string& option) {
  if (text.starts_with('#')) text.erase(0, 1);
  std::uint32_t rgb = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rgb, 16);
  if (text.size() != 6 || error != std::errc{} || end != text.data() + text.size())
    throw Error(option, "a color RRGGBB, such as ffffff", text);
  const auto channel = [&](int shift) { return ((rgb >> shift) & 255u) / 255.; };
  return {channel(16), channel(8), channel(0)};
}
Vec3T<float> linear(const Vec3& color) {
  const auto channel = [](double s) {
    return static_cast<float>(s <= .04045 ? s / 12.92 : std::pow((s + .055) / 1.055, 2.4));
  };
  return {channel(color.x), channel(color.y), channel(color.z)};
}

/// A light of "X,Y,Z,INTENSITY" or "X,Y,Z,INTENSITY,RRGGBB".
PointLight lightNamed(const std::string& text) {
  const std::vector<std::string> parts = CLI::detail::split(text, ',');
  std::array<double, 4> numbers{};
  bool good = parts.size() == 4 || parts.size() == 5;
  for (std::size_t i = 0; good && i < numbers.size(); ++i) {
    const char* const last = parts[i].data() + parts[i].size();
    const auto [end, error] = std::from_chars(parts[i].data(), last, numbers[i]);
    good = error == std::errc{} && end == last && std::isfinite(numbers[i]);
  }
  if (!good || !(numbers[3] > 0))
    throw Error("--light", "X,Y,Z [m], an intensity above 0 [m2] and perhaps a color RRGGBB", text);
  PointLight light{{numbers[0], numbers[1], numbers[2]}, {1, 1, 1}, numbers[3]};
  if (parts.size() == 5) light.color = colorNamed(parts[4], "--light");
  return light;
}

void printMeasure(const RenderMeasure& m, const RenderOptions& options) {
  fmt::print("{} bodies, {}x{}, {}\n", grouped(static_cast<long long>(m.bodies)), options.width,
             options.height, m.device);
  fmt::print(
      "  frame: mean {:.2f} ms, median {:.2f} ms, 95 % {:.2f} ms ({:.1f} frames per second), {} frames\n  "
      "processor time of all threads: "
      "{:.1f} ms per frame\n",
      m.meanMs, m.medianMs, m.p95Ms, 1000 / m.meanMs, m.frames, m.cpuMs);
  if (m.stepMs > 0) {
    constexpr double kFrames = 60, kSteps = 30;
    const double busy = (kFrames * m.meanMs + kSteps * m.stepMs) / 1000;
    fmt::print(
        "  step: mean {:.2f} ms ({:.1f} per second); a step and a frame: {:.2f} ms ({:.1f} per second)\n",
        m.stepMs, 1000 / m.stepMs, m.stepMs + m.meanMs, 1000 / (m.stepMs + m.meanMs));
    fmt::print("  {:.0f} frames and {:.0f} steps take {:.3f} s: {} real time\n", kFrames, kSteps, busy,
               busy <= 1 ? "within" : "slower than");
  }
  fmt::print("  poses {}; boxes {}; stage by stage, waiting after each:\n", m.poses, m.boxes);
  double sum = 0;
  for (const auto& [name, ms] : m.passes) {
    fmt::print("  {:<12}{:>9.2f} ms\n", name, ms);
    sum += ms;
  }
  fmt::print("  {:<12}{:>9.2f} ms\n", "sum", sum);
}

int renderNow(RenderCommand& command) {
  RenderOptions& options = command.options;
  const Look look = lookOf(command.look);
  options.width = look.width;
  options.height = look.height;
  options.fieldOfView = look.fieldOfView;
  options.eye = look.eye;
  options.target = look.target;
  options.colorBy = look.colorBy;
  options.orbit = command.orbitDegrees * std::numbers::pi / 180;
  options.show = render::overlaysNamed(command.show);
  if (!command.background.empty())
    options.background = linear(colorNamed(command.background, "--background"));
  if (!command.sunColor.empty()) options.light.sunColor = colorNamed(command.sunColor, "--sun-color");
  for (const std::string& text : command.lights) options.light.lights.push_back(lightNamed(text));
  if (!command.path.empty()) options.path = std::make_shared<const render::CameraPath>(command.path);
  if (options.transparent &&
      (std::filesystem::path(options.out).extension() != ".png" || !options.compare.empty()))
    throw Error("--transparent", "one run, into .png files", options.out);
  checkLayerFile("--depth", options.depthFile);
  checkLayerFile("--normals", options.normalsFile);
  if (!command.sun.empty())
    options.sun = {command.sun[0] * std::numbers::pi / 180, command.sun[1] * std::numbers::pi / 180};
  if (command.live && command.measure == 0) throw Error("--live", "--measure as well", "none");
  if (command.measure > 0) {
    printMeasure(measureRender(options, command.measure, command.live), options);
    return kHolds;
  }
  if (options.out.empty()) throw Error("--out", "a file for the film or the pictures", "none");
  const RenderResult result = renderFilm(options);
  if (command.json)
    printWritten({options.out, options.depthFile, options.normalsFile},
                 {{"pictures", result.frames}, {"device", result.device}});
  else if (!options.quiet)
    fmt::print("{}: {} picture{}, {}\n", options.out, result.frames, result.frames == 1 ? "" : "s",
               result.device);
  return kHolds;
}

}  // namespace

void addRender(CLI::App& app, int& status) {
  auto command = std::make_shared<RenderCommand>();
  command->look.fieldOfView = 28;
  RenderOptions& options = command->options;
  CLI::App* sub = app.add_subcommand("render",
                                     "Make a film or pictures of a scene or a trajectory, without a display");
  sub->add_option("scene", options.job.scene,
                  "Name of a scene, a scene file (.json) or a trajectory (.rubble)")
      ->required();
  sub->add_option(
         "-o,--out", options.out,
         "film.mp4 (.mkv, .mov, .webm, .gif), frame_%04d.png, or picture.png (.jpg) for the end alone")
      ->type_name("FILE");
  sub->add_option("--camera", options.camera,
                  fmt::format("{}, or one of the scene", fmt::join(cameraNames(), ", ")))
      ->capture_default_str();
  addViewOptions(*sub, command->look);
  sub->add_option("--orbit", command->orbitDegrees, "Turn the camera about its target [degrees/s of film]");
  sub->add_option(
         "--camera-path", command->path,
         "Key frames of the camera: a JSON list of {\"time\" [s of film], \"eye\", \"target\" [m], \"fov\"}")
      ->type_name("FILE");
  sub->add_option("--background", command->background, "A color in place of the sky")->type_name("RRGGBB");
  sub->add_flag("--transparent", options.transparent, "Sky and ground planes are transparent (.png)");
  sub->add_option(
         "--depth", options.depthFile,
         "Also write the view depth of each pixel: [m] as an array of NumPy (depth.npy, depth_%04d.npy) or "
         "as channel Z (.exr), or [mm] as 16 bits of gray (.png)")
      ->type_name("FILE");
  sub->add_option("--normals", options.normalsFile,
                  "Also write the normal of each pixel, world axes: an array of NumPy (.npy), channels N.X, "
                  "N.Y and N.Z (.exr), or 16 bits of red, green and blue (.png)")
      ->type_name("FILE");
  sub->add_option(
         "--sun", command->sun,
         "Where the sun stands [degrees]: angle from the right of the picture (90: behind the scene), "
         "height above the horizon")
      ->delimiter(',')
      ->expected(2)
      ->check(CLI::Range(-360.0, 360.0))
      ->type_name("ANGLE,HEIGHT");
  sub->add_option("--sun-color", command->sunColor, "Color of sunlight")->type_name("RRGGBB");
  sub->add_option("--sun-strength", options.light.sunStrength, "Factor on sunlight")
      ->check(CLI::Range(0.0, 1e6));
  sub->add_option("--sky-strength", options.light.skyStrength, "Factor on the sky and its light")
      ->check(CLI::Range(0.0, 1e6));
  sub->add_option("--light", command->lights,
                  "A lamp at a point [m]: at a distance d it lights as INTENSITY / d^2 suns do; repeatable")
      ->type_name("X,Y,Z,INTENSITY[,RRGGBB]");
  sub->add_option("--motion-blur", options.shutter, "Share of the time of a frame for which it is exposed")
      ->check(CLI::Range(0.0, 1.0));
  sub->add_option("--fps", options.fps, "Frames per second of film")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  sub->add_option("--slow", options.slow, "Slow motion: seconds of film per second of the scene")
      ->check(CLI::Range(.01, 1000.0))
      ->capture_default_str();
  sub->add_option("--every", options.every, "A frame every so many steps, whatever the time")
      ->check(wholeNumber(1));
  sub->add_option("--from", options.from, "Begin after this step")->check(wholeNumber(0));
  sub->add_option("--samples", options.samples,
                  "Samples a pixel (default: 32 for a picture; 4 for a film, 16 on a GPU)")
      ->check(CLI::Range(1, 4096));
  sub->add_option("--compare", options.compare,
                  "Side by side: two backends (cpu,reference) or two numbers of iterations (4,16)")
      ->delimiter(',');
  sub->add_flag("--overlay", options.overlay, "Write scene, bodies, time and step time on the picture");
  sub->add_option("--color-max", options.colorMax,
                  "Value of the hottest color (default: the largest of each picture)")
      ->check(aboveZero());
  sub->add_option("--show", command->show, "Draw over the picture: contacts, forces, joints, bounds")
      ->delimiter(',');
  sub->add_option("--measure", command->measure,
                  "Write nothing: draw this many frames of the start and report milliseconds")
      ->check(wholeNumber(1));
  sub->add_flag("--live", command->live,
                "With --measure: take a step of the scene before each frame, and report it as well");
  addArgumentOptions(*sub, options.job);
  addSolverOptions(*sub, options.job);
  addBackendOptions(*sub, options.job);
  sub->add_flag("-q,--quiet", options.quiet, "No progress");
  addWrittenOption(*sub, command->json);
  sub->callback([command, &status] { status = renderNow(*command); });
}

}  // namespace rubble::cli
