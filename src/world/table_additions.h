#pragma once
/// Entries that new bodies add to the tables of shapes and materials.
#include "world/world_impl.h"

namespace rubble {

/// A cooked shape, valid until the next one is placed.
struct PlacedShape {
  const CookedShape& cooked;
  int indexBase;  ///< of its indices in the tables of the engine

  CookedData data() const {
    CookedData own = cooked.shape;
    if (own.data >= 0) own.data += indexBase;
    return own;
  }
};

/// They are not in the tables before the edits are applied and commit() is called.
class TableAdditions {
 public:
  /// `cooked`: shapes of other worlds, or null.
  explicit TableAdditions(const Registry& registry, CookedShapes* cooked = nullptr)
      : registry_(registry), cooked_(cooked) {}

  /// Index into the materials of the engine, or -1 if the material needs no entry. `axes`: of the engine
  /// frame in that of the material.
  int surfaceOf(const Material& authored, const Quat& axes);
  /// Cooks a shape and gives it a place, unless the tables have its geometry already. Throws Error with
  /// `path` for geometry that cannot be cooked.
  PlacedShape place(const Shape& shape, const Path& path);
  std::vector<Edit> edits() const;
  /// All materials with those that are added.
  std::vector<Material> surfaces() const;
  /// Makes room, so that commit() needs no memory.
  void prepare(Registry& registry) const;
  void commit(Registry& registry) noexcept;

 private:
  int addSurface(const Material& material);

  const Registry& registry_;
  CookedShapes* const cooked_;
  std::vector<Material> surfaces_;
  CookedShapes shapes_;
  std::vector<std::vector<int>> partSurfaces_;  ///< of each shape
  int indices_ = 0;
  std::optional<Shape> plain_;  ///< the last shape without geometry, and what it has become
  CookedShape plainCooked_;
};

}  // namespace rubble
