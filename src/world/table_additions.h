#pragma once
/// Entries that new bodies add to the tables of shapes and materials.
#include "world/world_impl.h"

namespace rubble {

/// They are not in the tables before the edits are applied and commit() is called.
class TableAdditions {
 public:
  explicit TableAdditions(const Registry& registry) : registry_(registry) {}

  /// Index into the materials of the engine, or -1 if the material needs no entry. `axes`: of the engine
  /// frame in that of the material.
  int surfaceOf(const Material& authored, const Quat& axes);
  /// Offset of its indices in the tables of the engine. Equal geometry is stored once.
  int placeShape(const Shape& shape, const std::shared_ptr<const CookedShape>& cooked);
  std::vector<Edit> edits() const;
  /// All materials with those that are added.
  std::vector<Material> surfaces() const;
  /// Makes room, so that commit() needs no memory.
  void prepare(Registry& registry) const;
  void commit(Registry& registry) noexcept;

 private:
  int addSurface(const Material& material);

  const Registry& registry_;
  std::vector<Material> surfaces_;
  std::vector<CookedEntry> shapes_;
  std::vector<std::vector<int>> partSurfaces_;  ///< of each shape
  int indices_ = 0;
};

}  // namespace rubble
