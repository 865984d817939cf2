#include "io/report_json.h"

#include <cmath>

#include "io/json_text.h"

namespace rubble::io {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

Json settledJson(const std::optional<PhaseTimes>& phase) {
  if (!phase) return nullptr;
  return {{"mean", number(phase->mean)}, {"median", number(phase->median)}, {"p95", number(phase->p95)}};
}

Json smashJson(const std::optional<PhaseTimes>& phase) {
  if (!phase) return nullptr;
  return {{"mean", number(phase->mean)}, {"max", number(phase->max)}, {"p95", number(phase->p95)}};
}

Json penetrationJson(const std::optional<Distribution>& depth) {
  if (!depth) return nullptr;
  return {{"mean", number(depth->mean)}, {"p99", number(depth->p99)}, {"max", number(depth->max)}};
}

Json jointGapJson(const RunRecord& record) {
  if (!record.jointGapMean) return nullptr;
  return {{"mean", number(record.jointGapMean)}, {"max", number(record.jointGapMax)}};
}

Json verdictJson(const RunRecord& record) {
  Json claims = Json::array();
  for (const ClaimRecord& claim : record.claims) {
    claims.push_back({{"metric", claim.metric},
                      {"min", number(claim.min)},
                      {"max", number(claim.max)},
                      {"value", number(claim.value)},
                      {"holds", claim.holds},
                      {"why", claim.why}});
  }
  Json metrics = Json::object();
  for (const auto& [name, value] : record.metrics) metrics[name] = number(value);
  return {{"holds", record.holds}, {"claims", std::move(claims)}, {"metrics", std::move(metrics)}};
}

Json stagesJson(const RunRecord::StageMeans& means) {
  Json stages = Json::object();
  for (const auto& [name, ms] : means) stages[name] = number(ms);
  return stages;
}

Json ranksJson(const std::vector<RankReport>& ranks) {
  Json list = Json::array();
  for (const RankReport& r : ranks)
    list.push_back({{"own_ms", number(r.ownMs)},
                    {"exchange_ms", number(r.exchangeMs)},
                    {"bytes", r.bytes},
                    {"messages", r.messages},
                    {"bodies", r.bodies},
                    {"ghosts", r.ghosts},
                    {"rows", r.rows},
                    {"migrated", r.migrated},
                    {"memory_mb", number(static_cast<double>(r.memoryBytes) / 1e6)}});
  return list;
}

Json recordJson(const RunRecord& record) {
  Json json{{"scene", record.scene},
            {"backend", record.backend},
            {"device", record.device},
            {"threads", record.threads},
            {"commit", record.commit},
            {"bodies", record.bodies},
            {"manifolds", record.manifolds},
            {"contacts", record.contacts},
            {"colors", record.colors},
            {"clashes", record.clashes},
            {"iterations", record.iterations},
            {"dt", number(record.dt)},
            {"settled_ms", settledJson(record.settled)},
            {"smash_ms", smashJson(record.smash)},
            {"stages_ms", stagesJson(record.stages)},
            {"smash_stages_ms", stagesJson(record.smashStages)},
            {"restarts", record.restarts},
            {"solve_ms", number(record.solveMs)},
            {"collision_ms", number(record.collisionMs)},
            {"total_ms", number(record.totalMs)},
            {"top_drop_m", number(record.topDrop)},
            {"penetration_m", penetrationJson(record.penetration)},
            {"joint_gap_m", jointGapJson(record)},
            {"energy_j", number(record.energy)},
            {"engine_mb", number(record.engineMb)},
            {"bytes_per_body", number(record.bytesPerBody)},
            {"rss_mb", number(record.rssMb)},
            {"verdict", verdictJson(record)},
            {"machine", record.machine},
            {"date", record.date}};
  if (record.gpus > 0) json["gpus"] = record.gpus;
  if (record.series)
    json["series"] = {
        {"time_s", record.series->time},      {"step_ms", record.series->stepMs},
        {"energy_j", record.series->energy},  {"gap_mean_m", record.series->gapMean},
        {"gap_max_m", record.series->gapMax}, {"penetration_max_m", record.series->penetration}};
  if (!record.ranks.empty()) {
    json["ranks"] = ranksJson(record.ranks);
    json["rank_imbalance"] = number(imbalanceOf(record.ranks));
  }
  if (!record.hash.empty()) json["hash"] = record.hash;
  return json;
}

}  // namespace

std::string toJson(const RunRecord& record) { return prettyJson(recordJson(record)); }

std::string toJson(std::span<const RunRecord> records) {
  Json list = Json::array();
  for (const RunRecord& record : records) list.push_back(recordJson(record));
  return prettyJson(list);
}

}  // namespace rubble::io
