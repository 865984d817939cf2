#include "render/bodies.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <rubble/error.h>

namespace rubble::render {
namespace {

/// Vertices of one instanced draw element: enough to keep the GPU's units full, few enough to leave out what
/// is not seen.
constexpr std::size_t kChunkVertices = 2048;
constexpr std::size_t kLargestChunk = 64;
constexpr int kPlaneSectors = 48, kPlaneRings = 12;
/// A body whose radius is below so many pixels takes the coarsest level of detail, and so on up [pixels].
constexpr float kLevelPixels[] = {60, 12};

float boundingRadius(const BodyLook& look, float meshRadius) {
  switch (look.geometry) {
    case kBox:
      return length(look.size);
    case kRound:
      return look.size.x + look.halfLength;
    case kCylinder:
      return std::hypot(look.size.x, look.size.z);
    case kPlane:
      return 0;
    default:
      return meshRadius * std::max({look.size.x, look.size.y, look.size.z});
  }
}

std::vector<std::uint32_t> planeTriangles() {
  std::vector<std::uint32_t> indices;
  for (std::uint32_t ring = 0; ring + 1 < kPlaneRings; ++ring) {
    for (std::uint32_t sector = 0; sector < kPlaneSectors; ++sector) {
      const std::uint32_t next = (sector + 1) % kPlaneSectors;
      const std::uint32_t a = ring * kPlaneSectors + sector, b = ring * kPlaneSectors + next;
      indices.insert(indices.end(), {a, a + kPlaneSectors, b + kPlaneSectors, a, b + kPlaneSectors, b});
    }
  }
  return indices;
}

}  // namespace

struct Bodies::Level {
  gl::TexelBuffer vertices{GL_RGBA32F};
  gl::Buffer indices{GL_ELEMENT_ARRAY_BUFFER};
  int verticesPerBody = 0;
  GLsizei indicesPerChunk = 0;
};

struct Bodies::Shape {
  std::vector<Level> levels;  ///< finest first
  std::size_t chunkBodies = 1;
  float radius = 1;  ///< of the mesh at scale 1 [m]
};

std::size_t Bodies::chunkBodies(int geometry) const {
  return shapes_[static_cast<std::size_t>(geometry)]->chunkBodies;
}

Bodies::Bodies()
    : boxRaster_(gl::wantsCompute() ? std::make_unique<BoxRaster>() : nullptr),
      boxes_("bodies.vert", "body.frag"),
      boxDepths_("bodies.vert", "nothing.frag"),
      meshes_("bodies.vert", "body.frag", {"MESH"}),
      meshDepths_("bodies.vert", "nothing.frag", {"MESH"}),
      planeProgram_("plane.vert", "body.frag") {
  addShape({boxFaces()});
  addShape({roundMesh(48), roundMesh(20), roundMesh(8)});
  addShape({cylinderMesh(64), cylinderMesh(24), cylinderMesh(10)});
  shapes_.push_back(std::make_unique<Shape>());  // planes are drawn separately
  glBindVertexArray(planeArray_.id());
  const std::vector<std::uint32_t> triangles = planeTriangles();
  planeIndices_.upload(triangles.data(), triangles.size() * sizeof triangles[0]);
  glBindVertexArray(0);
}

Bodies::~Bodies() = default;

void Bodies::addShape(std::vector<MeshData> levels) {
  auto shape = std::make_unique<Shape>();
  shape->chunkBodies = std::clamp(kChunkVertices / levels.back().vertexCount(), std::size_t{1},
                                  kLargestChunk);
  shape->radius = 0;
  for (std::size_t v = 0; v < levels.front().vertexCount(); ++v) {
    const float* p = &levels.front().texels[8 * v];
    shape->radius = std::max(shape->radius, length(Vec3f{p[0], p[1], p[2]}));
  }
  glBindVertexArray(vertexArray_.id());
  for (const MeshData& mesh : levels) {
    Level& level = shape->levels.emplace_back();
    level.verticesPerBody = static_cast<int>(mesh.vertexCount());
    std::vector<std::uint32_t> indices;
    for (std::size_t body = 0; body < shape->chunkBodies; ++body)
      for (const std::uint32_t index : mesh.indices)
        indices.push_back(index + static_cast<std::uint32_t>(body * mesh.vertexCount()));
    level.indicesPerChunk = static_cast<GLsizei>(indices.size());
    level.indices.upload(indices.data(), indices.size() * sizeof indices[0]);
    level.vertices.buffer().upload(mesh.texels.data(), mesh.texels.size() * sizeof mesh.texels[0]);
  }
  glBindVertexArray(0);
  shapes_.push_back(std::move(shape));
}

int Bodies::addMesh(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  addShape({meshOf(vertices, triangles)});
  return static_cast<int>(shapes_.size()) - 1;
}

void Bodies::setLooks(std::span<const BodyLook> looks) {
  std::vector<std::uint32_t> order(looks.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto coarseSize = [&](std::uint32_t i) { return std::ilogb(std::max(1e-9f, looks[i].size.x)); };
  // Bodies of like size lie together, so that a chunk is far or near, large or small, as a whole.
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (looks[a].geometry != looks[b].geometry) return looks[a].geometry < looks[b].geometry;
    return looks[a].geometry != kBox && coarseSize(a) > coarseSize(b);
  });
  slotOfBody_.assign(looks.size(), 0);
  bodyInSlot_.clear();
  chunks_.clear();
  planes_.clear();
  boxSlots_ = 0;
  for (std::size_t i = 0; i < order.size();) {
    const int geometry = looks[order[i]].geometry;
    if (geometry < 0 || geometry >= static_cast<int>(shapes_.size()))
      throw Error("look.geometry", "one that the renderer knows", std::to_string(geometry));
    const std::size_t chunkBodies = shapes_[static_cast<std::size_t>(geometry)]->chunkBodies;
    const auto first = static_cast<std::uint32_t>(bodyInSlot_.size());
    for (std::size_t k = 0; k < chunkBodies; ++k) {
      const bool filled = i < order.size() && looks[order[i]].geometry == geometry;
      if (filled) slotOfBody_[order[i]] = static_cast<std::uint32_t>(bodyInSlot_.size());
      bodyInSlot_.push_back(filled ? static_cast<int>(order[i++]) : -1);
    }
    if (geometry == kBox) boxSlots_ = static_cast<std::uint32_t>(bodyInSlot_.size());
    if (geometry == kPlane) {
      planes_.push_back(first);
    } else {
      chunks_.push_back({first, geometry, 0, {}});
    }
  }
  surfaceSlot_ = static_cast<std::uint32_t>(bodyInSlot_.size());
  looks_.assign(looks.begin(), looks.end());
  poses_.assign(bodyInSlot_.size(), kNoPose);
  radii_.assign(bodyInSlot_.size(), 0);
  for (std::size_t slot = 0; slot < bodyInSlot_.size(); ++slot) {
    if (bodyInSlot_[slot] < 0) continue;
    const BodyLook& look = looks[static_cast<std::size_t>(bodyInSlot_[slot])];
    radii_[slot] = boundingRadius(look, shapes_[static_cast<std::size_t>(look.geometry)]->radius);
  }
  for (Chunk& chunk : chunks_) {
    const std::size_t bodies = shapes_[static_cast<std::size_t>(chunk.geometry)]->chunkBodies;
    chunk.largest = *std::max_element(radii_.begin() + chunk.firstSlot,
                                      radii_.begin() + static_cast<std::ptrdiff_t>(chunk.firstSlot + bodies));
  }
  uploadTables();
}

void Bodies::setColors(std::span<const Vec3f> colors) {
  for (std::size_t i = 0; i < looks_.size() && i < colors.size(); ++i) looks_[i].color = colors[i];
  uploadTables();
}

void Bodies::setSurfaceLooks(std::span<const BodyLook> looks) {
  surfaceLooks_.assign(looks.begin(), looks.end());
  uploadTables();
}

void Bodies::uploadTables() {
  const std::size_t slots = bodyInSlot_.size() + surfaceLooks_.size();
  if (slots == 0) return;
  auto* out = static_cast<float*>(lookTable_.buffer().map(slots * 8 * sizeof(float)));
  for (std::size_t slot = 0; slot < slots; ++slot) {
    const int body = slot < bodyInSlot_.size() ? bodyInSlot_[slot] : -1;
    const BodyLook look = slot >= bodyInSlot_.size() ? surfaceLooks_[slot - bodyInSlot_.size()]
                          : body >= 0                ? looks_[static_cast<std::size_t>(body)]
                                                     : BodyLook{};
    const bool isSurface = slot >= bodyInSlot_.size();
    const int shape = isSurface                 ? (look.heated ? 96 : 32)
                      : look.geometry == kBox   ? 8
                      : look.geometry == kRound ? 16
                                                : 0;
    const float texels[8] = {
        look.size.x,  look.size.y,  look.size.z,  look.halfLength,
        look.color.x, look.color.y, look.color.z, static_cast<float>(static_cast<int>(look.finish) + shape)};
    std::copy_n(texels, 8, out + 8 * slot);
  }
  lookTable_.buffer().unmap();
}

int Bodies::bodyOfSlot(std::uint32_t slot) const {
  return slot < bodyInSlot_.size() ? bodyInSlot_[slot] : -1;
}

void Bodies::bindTables(int firstUnit) const {
  poseTable_.bind(firstUnit);
  lookTable_.bind(firstUnit + 1);
}

void Bodies::draw(const DrawView& view) {
  drawn_ = 0;
  if (bodyInSlot_.empty()) return;
  bindTables(0);
  if (boxRaster_) {
    boxRaster_->draw(boxSlots_, view.rays, view.viewProjection, view.nearest, view.withIds);
    drawn_ += boxSlots_;
  }
  for (int geometry = boxRaster_ ? kBox + 1 : kBox; geometry < static_cast<int>(shapes_.size()); ++geometry)
    if (geometry != kPlane) drawGeometry(geometry, view);
  if (view.withIds) drawPlanes(view);
  glBindVertexArray(0);
}

void Bodies::drawGeometry(int geometry, const DrawView& view) {
  const Shape& shape = *shapes_[static_cast<std::size_t>(geometry)];
  struct Seen {
    float distance;
    std::uint32_t slot;
    std::size_t level;
  };
  std::vector<Seen> seen;
  const auto byGeometry = [](const Chunk& chunk, int wanted) { return chunk.geometry < wanted; };
  auto chunk = std::lower_bound(chunks_.begin(), chunks_.end(), geometry, byGeometry);
  for (; chunk != chunks_.end() && chunk->geometry == geometry; ++chunk) {
    if (chunk->bounds.empty() || !touches(chunk->bounds, view.visible)) continue;
    const float distance = view.parallel ? -dot(chunk->bounds.middle(), view.viewer)
                                         : distanceTo(chunk->bounds, view.viewer);
    const float pixels = chunk->largest /
                         (view.pixelSize * (view.parallel ? 1.f : std::max(distance, 1e-6f)));
    std::size_t level = 0;
    for (const float limit : kLevelPixels) level += pixels < limit;
    seen.push_back({distance, chunk->firstSlot, std::min(level, shape.levels.size() - 1)});
  }
  if (seen.empty()) return;
  // Front to back, so that hidden pixels are not shaded.
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
    return a.level != b.level         ? a.level < b.level
           : a.distance != b.distance ? a.distance < b.distance
                                      : a.slot < b.slot;
  });
  gl::Program& program = geometry == kBox ? (view.withIds ? boxes_ : boxDepths_)
                                          : (view.withIds ? meshes_ : meshDepths_);
  program.use();
  program.setMatrices("viewProjection", view.viewProjection.columns.data());
  program.set("viewer", view.viewer.x, view.viewer.y, view.viewer.z, view.parallel ? 0.f : 1.f);
  program.set("poses", 0);
  program.set("looks", 1);
  program.set("meshVertices", 2);
  glBindVertexArray(vertexArray_.id());
  std::vector<std::uint32_t> slots;
  for (std::size_t begin = 0; begin < seen.size();) {
    const std::size_t level = seen[begin].level;
    slots.clear();
    for (; begin < seen.size() && seen[begin].level == level; ++begin) slots.push_back(seen[begin].slot);
    chunkList_.upload(slots.data(), slots.size() * sizeof slots[0]);
    glEnableVertexAttribArray(0);
    glVertexAttribIPointer(0, 1, GL_UNSIGNED_INT, 0, nullptr);
    glVertexAttribDivisor(0, 1);
    const Level& drawn = shape.levels[level];
    drawn.vertices.bind(2);
    drawn.indices.bind();
    program.set("verticesPerBody", drawn.verticesPerBody);
    glDrawElementsInstanced(GL_TRIANGLES, drawn.indicesPerChunk, GL_UNSIGNED_INT, nullptr,
                            static_cast<GLsizei>(slots.size()));
    drawn_ += slots.size() * shape.chunkBodies;
  }
}

void Bodies::drawPlanes(const DrawView& view) {
  planeProgram_.use();
  planeProgram_.setMatrices("viewProjection", view.viewProjection.columns.data());
  planeProgram_.set("eye", view.viewer.x, view.viewer.y, view.viewer.z);
  planeProgram_.set("poses", 0);
  planeProgram_.set("looks", 1);
  glBindVertexArray(planeArray_.id());
  for (const std::uint32_t slot : planes_) {
    const Pose& p = poses_[slot];
    const Vec3f normal = rotate(QuatT<float>{p.qs, p.qx, p.qy, p.qz}, Vec3f{0, 0, 1});
    planeProgram_.set("reach", std::max(1e-6f, std::fabs(dot(view.viewer - Vec3f{p.x, p.y, p.z}, normal))));
    planeProgram_.set("planeSlot", static_cast<int>(slot));
    glDrawElements(GL_TRIANGLES, 6 * kPlaneSectors * (kPlaneRings - 1), GL_UNSIGNED_INT, nullptr);
  }
}

}  // namespace rubble::render
