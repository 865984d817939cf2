#include <rubble/c/world.h>

#include <nlohmann/json.hpp>

#include "c_api/handles.h"
#include "io/definition_json.h"

using namespace rubble;
using namespace rubble::c;

namespace {

nlohmann::ordered_json reportJson(const StepReport& r) {
  nlohmann::ordered_json json{{"step", r.step},
                              {"bodies", r.bodies},
                              {"pairs", r.pairs},
                              {"manifolds", r.manifolds},
                              {"contacts", r.contacts},
                              {"vertices", r.vertices},
                              {"vertex_contacts", r.vertexContacts},
                              {"deflected_vertices", r.deflectedVertices},
                              {"held_vertices", r.heldVertices},
                              {"surface_rounds", r.surfaceRounds},
                              {"surface_tests", r.surfaceTests},
                              {"recycled", r.recycled},
                              {"colors", r.colors},
                              {"color_rounds", r.colorRounds},
                              {"clashes", r.clashes},
                              {"broken_joints", r.brokenJoints},
                              {"sleeping_bodies", r.sleepingBodies},
                              {"stopped_bodies", r.stoppedBodies},
                              {"quarantined", r.quarantined},
                              {"failed_solves", r.failedSolves},
                              {"bounded_steps", r.boundedSteps},
                              {"spin_limited", r.spinLimited},
                              {"unsettled_impacts", r.unsettledImpacts},
                              {"unfinished_motion", r.unfinishedMotion},
                              {"sorted", r.sorted},
                              {"difference", r.difference},
                              {"restarts", r.restarts},
                              {"total_ms", r.totalMs}};
  json["broken"] = nlohmann::ordered_json::array();
  for (const JointId id : r.broken) json["broken"].push_back(idJson(id));
  json["grown"] = nlohmann::ordered_json::object();
  for (const Growth& growth : r.grown) json["grown"][growth.what] = growth.needed;
  json["stages_ms"] = nlohmann::ordered_json::object();
  for (const StageTime& stage : r.stages) json["stages_ms"][stage.name] = stage.ms;
  return json;
}

}  // namespace

extern "C" {

rb_status rb_world_create(const rb_scene* scene, const char* options, rb_world** world) {
  return guarded([&] {
    const WorldOptions parsed = io::parseOptions(textOr(options, "{}"));
    auto made = std::make_shared<World>(need(scene, "scene").file.scene, parsed);
    auto handle = std::make_unique<rb_world>();
    handle->world = std::move(made);
    handle->appearance = need(scene, "scene").file.appearance;
    need(world, "world") = handle.release();
  });
}

void rb_world_destroy(rb_world* world) { delete world; }

rb_status rb_world_step(rb_world* world, rb_step_report* report) {
  return guarded([&] {
    need(world, "world").report = worldOf(world).step();
    if (report) *report = toC(world->report);
  });
}

rb_status rb_world_run_events(rb_world* world) {
  return guarded([&] { worldOf(world).runEvents(); });
}

rb_status rb_world_report(rb_world* world, const char** json) {
  return guarded([&] { need(json, "json") = keepText(reportJson(need(world, "world").report).dump()); });
}

rb_status rb_world_params(const rb_world* world, const char** json) {
  return guarded([&] { need(json, "json") = keepText(io::toJson(worldOf(world).params())); });
}

rb_status rb_world_set_params(rb_world* world, const char* json) {
  return guarded([&] {
    Params params = worldOf(world).params();
    io::parseParams(textOr(json, ""), params);
    worldOf(world).setParams(params);
  });
}

rb_status rb_world_gravity(const rb_world* world, double gravity[3]) {
  return guarded([&] { store(worldOf(world).gravity(), &need(gravity, "gravity")); });
}

rb_status rb_world_set_gravity(rb_world* world, const double gravity[3]) {
  return guarded([&] { worldOf(world).setGravity(vec(gravity)); });
}

rb_status rb_world_set_material_pair(rb_world* world, const char* json) {
  return guarded([&] { worldOf(world).setMaterialPair(io::parseMaterialPair(textOr(json, ""))); });
}

rb_status rb_world_remove_material_pair(rb_world* world, const char* a, const char* b) {
  return guarded([&] { worldOf(world).removeMaterialPair(textOr(a, ""), textOr(b, "")); });
}

rb_status rb_world_material_pairs(const rb_world* world, const char** json) {
  return guarded([&] { need(json, "json") = keepText(io::toJson(worldOf(world).materialPairs())); });
}

int64_t rb_world_step_count(const rb_world* world) { return world ? world->world->stepCount() : 0; }

double rb_world_time(const rb_world* world) { return world ? world->world->time() : 0; }

rb_status rb_world_quality(const rb_world* world, rb_quality* quality) {
  return guarded([&] {
    const Quality q = worldOf(world).quality();
    need(quality, "quality") = {{q.penetration.mean, q.penetration.p99, q.penetration.max},
                                q.jointGapMean,
                                q.jointGapMax,
                                q.kineticEnergy,
                                q.potentialEnergy,
                                q.maxSpeed};
  });
}

int64_t rb_world_memory_bytes(const rb_world* world) {
  return world ? static_cast<int64_t>(world->world->memoryBytes()) : 0;
}

rb_status rb_world_reserve(rb_world* world, const char* kind, int32_t count) {
  return guarded([&] { worldOf(world).reserve(textOr(kind, ""), count); });
}

rb_status rb_world_hash(const rb_world* world, uint64_t* hash) {
  return guarded([&] { need(hash, "hash") = worldOf(world).hash(); });
}

rb_status rb_world_table_hashes(const rb_world* world, const char** json) {
  return guarded([&] {
    nlohmann::ordered_json out = nlohmann::ordered_json::object();
    for (const TableHash& table : worldOf(world).tableHashes()) out[table.table] = table.hash;
    need(json, "json") = keepText(out.dump());
  });
}

rb_status rb_world_snapshot(const rb_world* world, rb_snapshot** snapshot) {
  return guarded([&] { need(snapshot, "snapshot") = new rb_snapshot{worldOf(world).snapshot()}; });
}

rb_status rb_world_restore(rb_world* world, const rb_snapshot* snapshot) {
  return guarded([&] { worldOf(world).restore(need(snapshot, "snapshot").snapshot); });
}

rb_status rb_snapshot_bytes(rb_snapshot* snapshot, const uint8_t** bytes, int64_t* count) {
  return guarded([&] {
    std::vector<std::byte>& own = need(snapshot, "snapshot").bytes;
    own = snapshot->snapshot.bytes();
    need(bytes, "bytes") = reinterpret_cast<const uint8_t*>(own.data());
    need(count, "count") = static_cast<int64_t>(own.size());
  });
}

rb_status rb_snapshot_from_bytes(const uint8_t* bytes, int64_t count, rb_snapshot** snapshot) {
  return guarded([&] {
    if (count > 0) need(bytes, "bytes");
    const std::span<const uint8_t> given(bytes, static_cast<std::size_t>(std::max<int64_t>(0, count)));
    need(snapshot, "snapshot") = new rb_snapshot{Snapshot::fromBytes(std::as_bytes(given))};
  });
}

void rb_snapshot_destroy(rb_snapshot* snapshot) { delete snapshot; }

rb_status rb_world_first_difference(const rb_world* world, const char** difference) {
  return guarded([&] { need(difference, "difference") = keepText(worldOf(world).firstDifference()); });
}
}
