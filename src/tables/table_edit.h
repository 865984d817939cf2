#pragma once
/// Edits of tables in host memory. Bodies are addressed by slot, but for apply().
#include <vector>

#include "tables/edits.h"
#include "tables/host_tables.h"
#include "tables/records.h"

namespace rubble::RUBBLE_CORE {

/// Applies an edit.
void apply(HostTables& tables, const Edit& edit);
/// A joint or attachment with slots in place of ids.
EngineJoint inSlots(const HostTables& tables, EngineJoint joint);
std::vector<EngineAttachment> inSlots(const HostTables& tables, std::vector<EngineAttachment> attachments);
std::vector<int> slotsOf(const HostTables& tables, const std::vector<int>& ids);

/// Makes slots for at least that many ids. New slots are removed bodies.
void setBodyCount(HostTables& tables, int ids);
/// Makes removed bodies of all slots from `begin` on.
void clearBodySlots(HostTables& tables, int begin);
/// Reserves aggregate arrays for the present capacity of bodies and soft nodes.
void reserveNodes(HostTables& tables);
void addShape(HostTables& tables, const CookedShape& shape, const std::vector<int>& partSurfaces);
void setSurfaces(HostTables& tables, const std::vector<Material>& surfaces);
void setBody(HostTables& tables, int slot, const EngineBody& body);
/// Clears the contacts of bodies.
void forgetContacts(HostTables& tables, std::span<const int> slots);
/// `firstOfWorld`: of a batch.
void setPlanes(HostTables& tables, const std::vector<int>& slots, const std::vector<int>& firstOfWorld = {});
void setJointCount(HostTables& tables, int type, int ids);
void setJoint(HostTables& tables, int slot, const EngineJoint& joint);
void editJoint(HostTables& tables, int slot, const EngineJoint& joint);
/// Negative ids (no body) are unchanged.
inline int slotOf(const HostTables& tables, int id) { return id < 0 ? id : tables.view().placeOf[id]; }

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

/// Queries at the present poses. Overwrites the grid.
std::vector<EngineHit> runQueries(HostTables& tables, std::span<const EngineQuery> queries);
std::vector<std::vector<int>> runOverlaps(HostTables& tables, std::span<const EngineQuery> queries);
/// All persistent state as bytes. Equal states give equal bytes.
std::vector<std::byte> saveTables(const HostTables& tables);
void loadTables(HostTables& tables, std::span<const std::byte> data);

}  // namespace rubble::RUBBLE_CORE
