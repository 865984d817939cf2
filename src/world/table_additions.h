#pragma once
/// Entries that new bodies add to the tables of shapes and materials.
#include "world/world_impl.h"

namespace rubble {

/// A shape of the world, valid until the next one is placed.
struct PlacedShape {
  const CookedShape* cooked;
  ShapeId id;
  int indices;  ///< where those of it begin in the tables of the engine

  CookedData data() const {
    CookedData own = cooked->shape;
    if (own.data >= 0) own.data += indices;
    return own;
  }
};

/// They are not in the tables before the edits are applied and commit() is called.
class TableAdditions {
 public:
  TableAdditions(const Registry& registry, CookedShapes& cooked) : registry_(registry), cooked_(cooked) {}

  /// Index into the materials of the engine, or -1 if the material needs no entry. `axes`: of the engine
  /// frame in that of the material.
  int surfaceOf(const Material& authored, const Quat& axes);
  /// Finds a shape, or cooks it and gives it a place. Throws Error with `path` for geometry that cannot be
  /// cooked.
  PlacedShape place(const Shape& shape, const Path& path);
  std::vector<Edit> edits() const;
  /// All materials with those that are added.
  std::vector<Material> surfaces() const;
  /// Makes room, so that commit() and the end of `dropped` shapes need no memory.
  void prepare(Registry& registry, int dropped = 0);
  void commit(Registry& registry) noexcept;

 private:
  int addSurface(const Material& material);
  /// Id in `shapes_`.
  ShapeId addShape(const Shape& shape, const Path& path);

  const Registry& registry_;
  CookedShapes& cooked_;
  std::vector<Material> surfaces_;
  WorldShapes shapes_;               ///< new ones, in the order of their ids
  std::vector<AddShape> addShapes_;  ///< those with geometry
  std::optional<ShapeSpace> space_;  ///< with their places
  std::optional<Shape> last_;        ///< the last one that was placed, and what it has become
  PlacedShape lastPlaced_{};
  CookedShape plain_;  ///< the last one without geometry
};

}  // namespace rubble
