#pragma once
/// Edits and measures of tables in host memory.
#include <vector>

#include "tables/host_tables.h"
#include "tables/records.h"

namespace rubble::RUBBLE_CORE {

/// Makes slots for at least that many ids. New slots are removed bodies.
void setBodyCount(HostTables& tables, int ids);
/// Makes removed bodies of all slots from `begin` on.
void clearBodySlots(HostTables& tables, int begin);
/// Reserves aggregate arrays for the present capacity of bodies and soft nodes.
void reserveNodes(HostTables& tables);
void addShape(HostTables& tables, const CookedShape& shape, const std::vector<int>& partSurfaces);
void setSurfaces(HostTables& tables, const std::vector<Material>& surfaces);
void setBody(HostTables& tables, int slot, const EngineBody& body);
void forgetContacts(HostTables& tables, int slot);
void setPlanes(HostTables& tables, const std::vector<int>& slots);
void setJointCount(HostTables& tables, int type, int ids);
void setJoint(HostTables& tables, int slot, const EngineJoint& joint);
void editJoint(HostTables& tables, int slot, const EngineJoint& joint);
/// Rebuilds the joint trees if bodies or joints were edited. Returns whether they were.
bool planTrees(HostTables& tables);
void setExclusions(HostTables& tables, const std::vector<std::pair<int, int>>& pairs);
BodyState bodyState(const HostTables& tables, int slot);
void setBodyState(HostTables& tables, int slot, const BodyState& state);
/// Clears forces and torques, which act for one step, at its end.
void endForces(HostTables& tables);
/// Restores a usable state after a step that ran out of memory. Poses are unchanged, since they are written
/// at the very end of a step. Contacts of this step and of the last one are cleared, because their tables are
/// partly overwritten.
void abandonStep(HostTables& tables);
void addVelocity(HostTables& tables, int slot, const rubble::Vec3& change);
/// Clears the contacts of many slots at once.
void forgetContactsOf(HostTables& tables, std::span<const int> slots);

BodyOrder orderOf(const HostTables& tables);
/// Returns whether the bodies are sorted in another order than their ids.
bool inOtherOrder(const SolverData& s);
/// As World::scatter, from host memory.
void scatterRows(HostTables& tables, StateArray which, const ArrayView& rows, const ArrayView& values);

/// Contacts of the last step at the present poses.
std::vector<EngineContact> contactsOf(const HostTables& tables);
std::vector<EngineTouch> touchesOf(const HostTables& tables);
std::vector<int> sleepersOf(const HostTables& tables);
/// Queries at the present poses. Overwrites the grid.
std::vector<EngineHit> runQueries(HostTables& tables, std::span<const EngineQuery> queries);
std::vector<std::vector<int>> runOverlaps(HostTables& tables, std::span<const EngineQuery> queries);
JointState jointStateOf(const HostTables& tables, int type, int slot);
std::vector<std::pair<int, int>> brokenJointsOf(const HostTables& tables);
Quality qualityOf(const HostTables& tables);
/// By slot.
void solverStatesOf(const HostTables& tables, std::vector<SolverState>& bodies,
                    std::vector<SolverState>& vertices);

/// All persistent state as bytes. Equal states give equal bytes.
std::vector<std::byte> saveTables(const HostTables& tables);
void loadTables(HostTables& tables, std::span<const std::byte> data);
std::uint64_t hashBytes(std::span<const std::byte> data);

}  // namespace rubble::RUBBLE_CORE
