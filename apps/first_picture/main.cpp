/// Draws the pile of 10,000 bricks in the smash, as `./dev demo` does first: with the parts of the library
/// that this takes, it is built long before the whole program.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include <rubble/rubble.h>

#include "io/picture.h"
#include "render/painter.h"
#include "scenes/families.h"

namespace {

using namespace rubble;

constexpr const char* kScene = "pile-10k";
constexpr int kStepsAfterSmash = 58;
constexpr double kFieldOfView = .8;  ///< vertical [rad]
constexpr int kSamplesGpu = 32, kSamplesSoftware = 8;
constexpr int kStepsPerMark = 10;  ///< of the line of progress

scenes::Spec specOf(const std::string& name) {
  const std::vector<scenes::Spec> family = scenes::pileSpecs();
  return *std::ranges::find(family, name, &scenes::Spec::name);
}

void draw(const std::string& file) {
  const auto device = render::makePaintDevice();
  const scenes::Spec spec = specOf(kScene);
  const scenes::Arguments arguments = scenes::resolve(spec, {});
  const Scene scene = spec.build(arguments);
  const auto [eye, target] = spec.camera(arguments, scene);

  WorldOptions options;
  options.params.iterations = spec.iterations;
  World world(scene, options);
  render::PaintSettings settings;
  settings.samples = device->isSoftware() ? kSamplesSoftware : kSamplesGpu;
  const render::Camera camera{
      .eye = eye, .target = target, .up = -scene.gravity, .fieldOfView = kFieldOfView};
  const auto painter = device->painter(io::pictureBodies(world), scene.gravity, camera, settings);

  const int steps = spec.smashStep + kStepsAfterSmash;
  std::printf("%s, %d steps on the CPU: ", kScene, steps);
  for (int step = 0; step < steps; ++step) {
    world.step();
    if (step % kStepsPerMark == 0) std::putchar('.'), std::fflush(stdout);
  }
  std::putchar('\n');
  io::writePng(painter->paint(io::pictureBodies(world), camera), file);
  std::printf("the first picture: %s\n", file.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw Error("first_picture", "one argument, the .png to write", std::to_string(argc - 1));
    draw(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "first_picture: %s\n", error.what());
    return 2;
  }
}
