/// What is seen of USD scenes: geometry with its colors, and cameras.
#include <algorithm>
#include <cmath>

#include "convert/colors.h"
#include "convert/geometry.h"
#include "convert/usd_reader.h"

namespace rubble::convert {
namespace {

const std::vector<std::string> kGeometry{"Cube",     "Sphere",     "Capsule", "Capsule_1",
                                         "Cylinder", "Cylinder_1", "Cone",    "Mesh"};

/// Focal length and aperture of a camera that does not say them [mm].
constexpr double kFocalLength = 50, kVerticalAperture = 15.2908;

/// The mean of a list of colors.
std::optional<Vec3> meanOf(const std::vector<double>* colors) {
  if (!colors || colors->size() < 3) return std::nullopt;
  Vec3 sum;
  for (std::size_t i = 0; i + 2 < colors->size(); i += 3)
    sum += {(*colors)[i], (*colors)[i + 1], (*colors)[i + 2]};
  return sum / static_cast<double>(colors->size() / 3);
}

}  // namespace

void UsdReader::addCamera(const UsdPrim& prim, const Affine& world) {
  const double focal = prim.number("focalLength", kFocalLength),
               aperture = prim.number("verticalAperture", kVerticalAperture);
  ModelCamera camera{prim.prim().name, world.rigid(), std::nullopt};
  if (focal > 0 && aperture > 0) camera.fieldOfView = 2 * std::atan(aperture / (2 * focal));
  model_.cameras.push_back(std::move(camera));
}

bool UsdReader::isVisible(const std::string& path) {
  // what is above hides what is below; the nearest purpose counts
  std::string purpose;
  for (std::string at = path; !at.empty(); at.erase(at.rfind('/'))) {
    const auto found = byPath_.find(at);
    if (found == byPath_.end()) continue;
    const UsdPrim prim = this->at(*placed_[found->second].prim);
    if (prim.text("visibility") == "invisible") return false;
    if (purpose.empty()) purpose = prim.text("purpose");
  }
  return purpose != "guide" && purpose != "proxy";
}

std::optional<Vec3> UsdReader::colorOf(const UsdPrim& prim, const std::string& path) {
  const std::optional<UsdPrim> material = boundMaterial(prim, path, false);
  if (material)
    for (const auto& child : material->prim().children) {
      const UsdPrim shader = at(*child);
      if (shader.text("info:id") == "UsdPreviewSurface")
        if (const auto color = shader.numbers("inputs:diffuseColor", 3))
          return Vec3{(*color)[0], (*color)[1], (*color)[2]};
    }
  return meanOf(prim.list("primvars:displayColor"));
}

void UsdReader::addDrawn(const UsdPrim& prim, const Placed& placed) {
  if (std::find(kGeometry.begin(), kGeometry.end(), prim.prim().type) == kGeometry.end()) return;
  if (!isVisible(placed.path) || !placed.world.isFinite()) return;
  FreeShape shape;
  Report unheard;
  const std::size_t notes = report_.notes.size();
  if (!shapeOf(prim, shape)) return report_.notes.resize(notes);
  Link& link = model_.links[static_cast<std::size_t>(std::max(placed.link, 0))];
  const Affine toLink = Affine::of(inverse(link.pose)) * placed.world;
  Link seen;
  Geom like;
  SolidSums solid;
  shape.as = FreeShape::Mesh::Triangles;
  if (!addShape(seen, shape, toLink, like, true, solid, unheard)) return;
  std::optional<Vec3> color = colorOf(prim, placed.path);
  if (color) color = srgbOf(*color);
  for (Geom& geom : seen.geoms) {
    DrawnShape& drawn = link.drawn.emplace_back(
        DrawnShape{std::move(geom.shape), geom.pose, color, placed.geom});
    if (placed.geom < 0 || placed.geom >= static_cast<int>(link.geoms.size())) {
      drawn.geom = -1;
      continue;
    }
    // triangles that collide are shared with the picture
    const Geom& own = link.geoms[static_cast<std::size_t>(placed.geom)];
    if (own.shape.type == drawn.shape.type) drawn.shape = own.shape, drawn.pose = own.pose;
  }
}

}  // namespace rubble::convert
