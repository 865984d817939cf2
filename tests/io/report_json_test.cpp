#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/report_json.h"

namespace rubble::io {
namespace {

using Json = nlohmann::json;

std::set<std::string> keysOf(const Json& json) {
  std::set<std::string> keys;
  for (const auto& item : json.items()) keys.insert(item.key());
  return keys;
}

TEST(ReportJson, KeysAreTheFixedOnes) {
  RunRecord record;
  record.settled = PhaseTimes{1, 2, 3, 4};
  record.smash = PhaseTimes{5, 6, 7, 8};
  record.stages = {{"primal", 1.5}};
  record.smashStages = {{"primal", 2.5}};
  record.penetration = Distribution{.1, .2, .3};
  record.jointGapMean = .1;
  record.jointGapMax = .2;
  record.topDrop = .01;
  const Json json = Json::parse(toJson(record));
  const std::set<std::string> expected{
      "scene",      "backend",       "device",      "threads",  "commit",          "bodies",
      "manifolds",  "contacts",      "colors",      "clashes",  "iterations",      "dt",
      "settled_ms", "smash_ms",      "stages_ms",   "solve_ms", "collision_ms",    "total_ms",
      "top_drop_m", "penetration_m", "joint_gap_m", "energy_j", "engine_mb",       "bytes_per_body",
      "rss_mb",     "verdict",       "machine",     "date",     "smash_stages_ms", "restarts"};
  EXPECT_EQ(keysOf(json), expected);
  EXPECT_EQ(keysOf(json["settled_ms"]), (std::set<std::string>{"mean", "median", "p95"}));
  EXPECT_EQ(keysOf(json["smash_ms"]), (std::set<std::string>{"mean", "max", "p95"}));
  EXPECT_EQ(keysOf(json["penetration_m"]), (std::set<std::string>{"mean", "p99", "max"}));
  EXPECT_EQ(keysOf(json["joint_gap_m"]), (std::set<std::string>{"mean", "max"}));
  EXPECT_EQ(json["smash_ms"]["max"], 8.);
  EXPECT_EQ(json["stages_ms"]["primal"], 1.5);
  EXPECT_EQ(json["smash_stages_ms"]["primal"], 2.5);
}

TEST(ReportJson, WhatDoesNotExistIsNull) {
  RunRecord record;
  record.claims = {{"x", -std::numeric_limits<double>::infinity(), 1, "why",
                    std::numeric_limits<double>::quiet_NaN(), false}};
  record.energy = std::numeric_limits<double>::quiet_NaN();
  const Json json = Json::parse(toJson(record));
  for (const char* key : {"settled_ms", "smash_ms", "top_drop_m", "penetration_m", "joint_gap_m", "energy_j"})
    EXPECT_TRUE(json[key].is_null()) << key;
  const Json& claim = json["verdict"]["claims"][0];
  EXPECT_TRUE(claim["min"].is_null());
  EXPECT_TRUE(claim["value"].is_null());
  EXPECT_EQ(claim["max"], 1.);
}

TEST(ReportJson, RecordsAreAList) {
  const std::vector<RunRecord> records(2);
  const Json json = Json::parse(toJson(std::span<const RunRecord>(records)));
  ASSERT_TRUE(json.is_array());
  EXPECT_EQ(json.size(), 2u);
}

}  // namespace
}  // namespace rubble::io
