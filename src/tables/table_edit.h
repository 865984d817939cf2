#pragma once
/// Edits of tables in host memory. Bodies are addressed by slot, but for apply().
#include <vector>

#include "tables/edits.h"
#include "tables/host_tables.h"
#include "tables/records.h"

namespace rubble::RUBBLE_CORE {

/// Applies edits in their order: all of them or, with std::bad_alloc, none. SetDeformables comes alone.
void apply(HostTables& tables, std::span<const Edit> edits);
inline void apply(HostTables& tables, const Edit& edit) { apply(tables, std::span(&edit, 1)); }

/// Reserves the tables of that many ids.
void reserveBodies(HostTables& tables, int ids);
/// Makes slots for at least that many ids. New slots are removed bodies.
void setBodyCount(HostTables& tables, int ids);
/// Makes removed bodies of all slots from `begin` on.
void clearBodySlots(HostTables& tables, int begin);
/// Reserves aggregate arrays for the present capacity of bodies and soft nodes.
void reserveNodes(HostTables& tables);
ShapePlace endOfShapes(const HostTables& tables);
void addShape(HostTables& tables, const CookedShape& shape, const std::vector<int>& partSurfaces,
              const ShapePlace& place);
void setSurfaces(HostTables& tables, const SetSurfaces& edit);
void setBody(HostTables& tables, int slot, const EngineBody& body);
/// Everything but its state.
void setBodyParams(HostTables& tables, int slot, const EngineBody& body);
/// Clears the contacts of bodies. `ids`: ascending.
void forgetContacts(HostTables& tables, std::span<const int> ids);
/// `firstOfWorld`: of a batch.
void setPlanes(HostTables& tables, std::span<const int> ids, std::span<const int> firstOfWorld = {});
void setJointCount(HostTables& tables, int type, int ids);
/// Bodies of joints are ids.
void setJoint(HostTables& tables, int slot, const EngineJoint& joint);
void editJoint(HostTables& tables, int slot, const EngineJoint& joint);
/// Negative ids (no body) are unchanged.
inline int slotOf(const HostTables& tables, int id) { return id < 0 ? id : tables.view().placeOf[id]; }
/// Of the body in a slot. In a batch idOf counts within a world, and bodies are where their ids are.
inline int tableId(const SolverData& s, int slot) { return s.placeOf[slot] == slot ? slot : s.idOf[slot]; }

BodyState bodyState(const HostTables& tables, int slot);
void setBodyState(HostTables& tables, int slot, const BodyState& state);
/// Clears forces and torques, which act for one step, at its end.
void endForces(HostTables& tables);
/// Restores a usable state after a step that ran out of memory. Poses are unchanged, since they are written
/// at the very end of a step. Contacts of this step and of the last one are cleared, because their tables are
/// partly overwritten.
void abandonStep(HostTables& tables);
void addVelocity(HostTables& tables, int slot, const rubble::Vec3& change);

/// Returns whether the bodies are sorted in another order than their ids.
bool inOtherOrder(const SolverData& s);
/// As World::scatter, from host memory.
void scatterRows(HostTables& tables, StateArray which, const ArrayView& rows, const ArrayView& values);

/// All persistent state as bytes. Equal states give equal bytes.
std::vector<std::byte> saveTables(const HostTables& tables);
/// The hash of each table of that state.
std::vector<TableHash> hashTables(const HostTables& tables,
                                  std::uint64_t (*hash)(std::span<const std::byte>));
/// With std::bad_alloc nothing is changed.
void loadTables(HostTables& tables, std::span<const std::byte> data);
/// The same for what these tables held before: they have the room, so it needs no memory.
void reloadTables(HostTables& tables, std::span<const std::byte> data);

}  // namespace rubble::RUBBLE_CORE
