/// Scene files: what is read cooks or is an Error, is written and read again as it is, and takes a few
/// steps with its actuators.
#include <rubble/rubble.h>

#include "io/scene_json.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/target.h"

namespace rubble::fuzz {
namespace {

constexpr int kSteps = 3;
/// What is larger is read and written alone.
constexpr std::size_t kMostBodies = 64, kMostVertices = 256, kMostNumbers = 4096;

bool isSmall(const Scene& scene) {
  std::size_t numbers = 0, vertices = 0, bodies = scene.bodies.size();
  const auto count = [&](const BodyDef& body) {
    if (body.shape.geometry) {
      const ShapeGeometry& g = *body.shape.geometry;
      numbers += g.points.size() + g.triangles.size() + g.samples.size() + g.parts.size();
    }
  };
  for (const BodyDef& body : scene.bodies) count(body);
  for (const Event& event : scene.events) {
    bodies += event.add.size();
    for (const BodyDef& body : event.add) count(body);
  }
  for (const Deformable& deformable : scene.deformables) vertices += common(deformable).vertices.size();
  return bodies <= kMostBodies && vertices <= kMostVertices && numbers <= kMostNumbers;
}

void writeAndReadAgain(const io::SceneFile& file) {
  const std::string text = io::toJson(file);
  std::vector<io::Fault> faults;
  const io::SceneFile again = io::parseScene(text, faults);
  if (!faults.empty()) fail("a scene that was read is written with a fault: " + faults.front().text());
  expect(io::toJson(again) == text, "a scene is written in another way after it was read again");
}

/// Sets controls from the bytes and acts. Activations stay within their bounds.
void act(Actuators& actuators, World& world, ByteSource& in) {
  for (double& control : actuators.controls())
    if (in.flag()) control = in.seldom() ? in.bits() : in.between(-2, 2);
  actuators.apply(world);
  for (std::size_t i = 0; i < actuators.definitions().size(); ++i) {
    const ActuatorDef& a = actuators.definitions()[i];
    const double now = actuators.activations()[i];
    expect(a.dynamics == ActuatorDynamics::None || (now >= a.minActivation && now <= a.maxActivation),
           "an activation beyond its bounds");
  }
}

void simulate(const io::SceneFile& file, ByteSource in) {
  try {
    WorldOptions options;
    options.threads = 1;
    options.events = true;
    World world(file.scene, options);
    Actuators actuators(file.actuators, world);
    for (int i = 0; i < kSteps; ++i) {
      act(actuators, world, in);
      world.step();
    }
    for (const BodyId id : world.bodies()) {
      const BodyState state = world.state(id);
      expect(dot(state.position, state.position) >= 0, "a body is nowhere");
    }
  } catch (const Error&) {
  }
}

}  // namespace

void testInput(std::span<const std::uint8_t> bytes) {
  std::vector<io::Fault> faults;
  const std::string text(bytes.begin(), bytes.end());
  const io::SceneFile file = io::parseScene(text, faults, "no-such-folder");
  for (const io::Fault& fault : faults) expect(!fault.message.empty(), "a fault without a message");
  if (!faults.empty() || !isSmall(file.scene)) return;
  writeAndReadAgain(file);
  simulate(file, ByteSource(bytes));
}

}  // namespace rubble::fuzz
