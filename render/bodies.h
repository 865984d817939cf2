#pragma once
/// Rigid bodies and particles as the GPU draws them: one draw for each geometry, whatever their number.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/body_look.h"
#include "render/box_raster.h"
#include "render/camera.h"
#include "render/geometry.h"
#include "render/gl.h"
#include "render/pose_feed.h"

namespace rubble::render {

/// Where a body is, as the shaders read it: 32 bytes. A body whose pose is not finite is not drawn.
struct Pose {
  float x = 0, y = 0, z = 0, unused = 0;  ///< center, in the renderer's frame [m]
  float qx = 0, qy = 0, qz = 0, qs = 1;   ///< unit quaternion, body -> world, scalar last
};

/// Of padding, and of bodies whose pose is not finite: outside of any view.
inline constexpr Pose kNoPose{kNowhere, kNowhere, kNowhere, 0, 0, 0, 0, 1};

/// What one pass draws of the bodies.
struct DrawView {
  Matrix viewProjection;
  Vec3f viewer;  ///< the eye, or for parallel rays the direction to where they come from
  bool parallel = false;
  std::vector<HalfSpace> visible;  ///< chunks outside are left out
  float pixelSize = 0;             ///< [m], at view depth 1 or, for parallel rays, anywhere
  bool withIds = true;             ///< false: depth alone
  Rays rays;
  float nearest = 0;  ///< view depth that the picture begins at [m]; 0 if parallel
};

class Bodies {
 public:
  Bodies();

  /// A geometry of one's own; bodies name it by what this returns.
  int addMesh(std::span<const Vec3f> vertices, std::span<const Triangle> triangles);
  /// Replaces all bodies. Poses must follow.
  void setLooks(std::span<const BodyLook> looks);
  /// New colors for the same bodies.
  void setColors(std::span<const Vec3f> colors);
  /// Places of all bodies, in the order of the looks.
  void setPoses(std::span<const Pose> poses);
  /// Gives a feed the sources of the poses of these bodies, in the order of the looks. To be repeated when
  /// looks or surfaces change.
  void setSources(std::span<const PoseSource> sources, PoseFeed& feed);
  /// Places of all bodies from there. Planes must not have moved since the last setPoses of the host.
  void setPoses(PoseFeed& feed, const PoseArrays& arrays);
  std::size_t count() const { return slotOfBody_.size(); }

  /// Bounds of what is neither a plane nor far from all else.
  const Bounds& core() const { return core_; }
  /// Distance from a point to the nearest chunk of bodies within the half spaces, and to planes [m].
  float nearestTo(const Vec3f& point, const std::vector<HalfSpace>& visible) const;

  void draw(const DrawView& view);
  /// Are boxes drawn by compute shaders?
  bool computesBoxes() const { return boxRaster_ != nullptr; }
  /// Bodies that the last draw sent to the GPU.
  std::size_t drawn() const { return drawn_; }
  void bindTables(int firstUnit) const;
  /// Body of a slot as it stands in the picture of ids, or -1.
  int bodyOfSlot(std::uint32_t slot) const;
  /// Slot of a body in the tables.
  std::uint32_t slotOf(std::size_t body) const { return slotOfBody_[body]; }
  /// Slots that are left to deformable surfaces: their looks follow those of the bodies.
  void setSurfaceLooks(std::span<const BodyLook> looks);
  std::uint32_t surfaceSlot(std::size_t surface) const {
    return surfaceSlot_ + static_cast<std::uint32_t>(surface);
  }

 private:
  struct Level;  ///< one level of detail of a geometry
  struct Shape;  ///< a geometry
  struct Chunk {
    std::uint32_t firstSlot = 0;
    int geometry = 0;
    float largest = 0;  ///< bounding radius of its largest body [m]
    Bounds bounds;
  };
  void addShape(std::vector<MeshData> levels);
  void uploadTables();
  void updateCore();
  void setCore(std::vector<float> (&lows)[3], std::vector<float> (&highs)[3]);
  std::size_t chunkBodies(int geometry) const;
  void drawGeometry(int geometry, const DrawView& view);
  void drawPlanes(const DrawView& view);

  std::vector<std::unique_ptr<Shape>> shapes_;
  std::vector<std::uint32_t> slotOfBody_;
  std::vector<int> bodyInSlot_;  ///< -1: padding
  std::vector<BodyLook> looks_, surfaceLooks_;
  std::vector<float> radii_;           ///< by slot [m]
  std::vector<Pose> poses_;            ///< by slot
  std::vector<Chunk> chunks_;          ///< by geometry, then by slot
  std::vector<std::uint32_t> planes_;  ///< slots
  std::uint32_t boxSlots_ = 0;         ///< they come first
  std::uint32_t surfaceSlot_ = 0;
  Bounds core_;
  std::vector<Bounds> fedBounds_;
  std::size_t drawn_ = 0;

  gl::TexelBuffer poseTable_{GL_RGBA32F}, lookTable_{GL_RGBA32F};
  gl::Buffer chunkList_{GL_ARRAY_BUFFER}, planeIndices_{GL_ELEMENT_ARRAY_BUFFER};
  gl::VertexArray vertexArray_, planeArray_;
  std::unique_ptr<BoxRaster> boxRaster_;  ///< null: boxes are triangles
  gl::Program boxes_, boxDepths_, meshes_, meshDepths_, planeProgram_;

 public:
  ~Bodies();
};

}  // namespace rubble::render
