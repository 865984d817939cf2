#pragma once
/// The state of one world of a batch, in numbers of its own: bodies, vertices and joints count from 0. Equal
/// states of two worlds have equal bytes, wherever the worlds lie in the tables.
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "tables/contact_lists.h"
#include "tables/host_tables.h"
#include "tables/records.h"

namespace rubble::RUBBLE_CORE {

/// The elements of a world in the tables. All but joints are consecutive.
struct WorldPart {
  int firstBody = 0, bodies = 0;
  int firstVertex = 0, vertices = 0;
  int firstEdge = 0, edges = 0;
  int firstFace = 0, faces = 0;  ///< of the triangles
  int firstAttachment = 0, attachments = 0;
  int firstElement[ElementTypes::kSize] = {}, elements[ElementTypes::kSize] = {};
  std::vector<int> joints[JointTypes::kSize];  ///< slots
  std::vector<WorldShape> shapes;
  std::vector<int> surfaces;
};

/// Owners of pairs of points.
struct OwnerRange {
  int begin, end;
};
/// Those of a world, ascending: vertices, edges, and the corners of its bodies if it has surfaces.
std::vector<OwnerRange> pointOwnersOf(const SolverData& s, const WorldPart& part);

/// The state of a world between steps: bodies with their parameters, joints, deformable objects, and contacts
/// with their multipliers and rows.
std::vector<std::byte> takeWorld(const HostTables& tables, const WorldPart& part);

/// A state that replaces that of world `world`, which has as many bodies, vertices, joints and elements.
struct WorldChange {
  int world;
  std::span<const std::byte> state;
};
/// States for which there is memory. Replaced states and the parts must outlive it, and the tables must not
/// change before put().
class WorldsToPut {
 public:
  WorldsToPut(HostTables& tables, std::span<const WorldPart> parts, std::span<const WorldChange> changes);
  ~WorldsToPut();
  WorldsToPut(const WorldsToPut&) = delete;
  WorldsToPut& operator=(const WorldsToPut&) = delete;
  void put() noexcept;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};
/// Replaces states without memory. Contacts of these worlds are cleared, which the next step finds again.
void putWithoutContacts(HostTables& tables, std::span<const WorldPart> parts,
                        std::span<const WorldChange> changes) noexcept;
/// Replaces states, or with std::bad_alloc none. `parts`: all worlds, in the order of their bodies.
/// `changes`: in ascending order of worlds. All other worlds keep their bits.
void putWorlds(HostTables& tables, std::span<const WorldPart> parts, std::span<const WorldChange> changes);

/// The same without their contacts, which it returns, those of the first change first. Manifolds and rows
/// count from 0. The tables must have no vertices.
BodyContacts putElements(HostTables& tables, std::span<const WorldPart> parts,
                         std::span<const WorldChange> changes);

}  // namespace rubble::RUBBLE_CORE
