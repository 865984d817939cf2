/// Models of all formats, from memory: MJCF, URDF, USD as text and as crates, glTF.
#include <rubble/error.h>

#include "convert/import.h"
#include "tests/fuzz/target.h"

namespace rubble::fuzz {
namespace {

/// Larger scenes are imported, and not written.
constexpr std::size_t kMostBodies = 200;

}  // namespace

void testInput(std::span<const std::uint8_t> bytes) {
  const std::string content(bytes.begin(), bytes.end());
  try {
    const convert::Import import = convert::importContent(content, "model");
    expect(!import.report.format.empty(), "a model is imported without a report");
    const Scene& scene = import.file.scene;
    if (scene.bodies.size() > kMostBodies) return;
    std::vector<io::Fault> faults;
    const io::SceneFile again = io::parseScene(io::toJson(import.file), faults);
    expect(faults.empty(), "an imported scene is no valid file");
    expect(
        again.scene.bodies.size() == scene.bodies.size() && again.scene.joints.size() == scene.joints.size(),
        "an imported scene changes in its file");
  } catch (const Error&) {
  }
}

}  // namespace rubble::fuzz
