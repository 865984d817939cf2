#pragma once
/// Bodies on their way into a world.
#include "world/table_additions.h"

namespace rubble {

/// The record of a body. Throws Error for a mass or moments of inertia that the engine cannot have.
BodyRecord recordOf(const BodyDef& def, const PlacedShape& shape, const Path& path);
/// The body for the engine. `shape`, `surface`: as they are in its tables.
EngineBody engineBody(const BodyRecord& record, const CookedData& shape, int surface);

/// A change of the definition of a body that the engine does not have yet. Until it is applied its world must
/// not be edited.
struct BodyChange {
  BodyId id;
  TableAdditions tables;
  BodyRecord after;
  std::vector<Edit> edits;
  std::vector<int> planes;
  std::vector<std::pair<JointId, EngineJoint>> joints;  ///< of the body, which see its new mass and frame
  bool swaps;                                           ///< another shape
};

/// New bodies of a world. Until commit() the engine does not have them, and the end of this object takes them
/// out of the registry. One record of each is made, where it stays, since memory that is touched for the
/// first time costs more than all else that a body takes.
class BodyAdditions {
 public:
  BodyAdditions(Registry& registry, CookedShapes& cooked, std::size_t count);
  ~BodyAdditions();
  BodyAdditions(const BodyAdditions&) = delete;
  BodyAdditions& operator=(const BodyAdditions&) = delete;

  /// Adds a valid body. Throws Error for a name that another body has, and for a shape or mass that cannot
  /// be.
  void add(const BodyDef& def, const Path& path);
  std::vector<BodyId> commit(Engine& engine);

 private:
  /// What the engine is told of a body besides its record.
  struct InTables {
    CookedData shape;
    int surface;
  };

  Registry& registry_;
  TableAdditions tables_;
  std::vector<BodyId> ids_;
  std::vector<InTables> inTables_;
  std::vector<int> planes_;  ///< of the world, with the new ones
  std::vector<int> reused_;  ///< slots of removed bodies
  bool committed_ = false;
};

}  // namespace rubble
