#include "convert/report.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include <nlohmann/json.hpp>

namespace rubble::convert {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kEffects{Effect::Lost, Effect::Approximate, Effect::None};

const char* headline(Effect effect) {
  switch (effect) {
    case Effect::Lost:
      return "Lost: the scene moves without it";
    case Effect::Approximate:
      return "Approximate: the scene moves nearly as the model";
    case Effect::None:
      break;
  }
  return "Not used, without effect on the motion";
}

std::string notesText(const Report& report, Effect effect) {
  struct Kind {
    Place first;
    std::size_t count;
  };
  std::map<std::pair<std::string, std::string>, Kind> kinds;
  std::vector<std::pair<std::string, std::string>> order;
  for (const Note& note : report.notes) {
    if (note.effect != effect) continue;
    const auto [kind, isNew] = kinds.try_emplace({note.what, note.why}, Kind{note.place, 0});
    if (isNew) order.emplace_back(note.what, note.why);
    ++kind->second.count;
  }
  if (order.empty()) return "";
  std::string out = std::string(headline(effect)) + ":\n";
  for (const auto& key : order) {
    const Kind& kind = kinds.at(key);
    out += "  " + kind.first.text() + ": " + key.first + ": " + key.second;
    if (kind.count > 1) out += " (" + std::to_string(kind.count) + " times)";
    out += "\n";
  }
  return out;
}

}  // namespace

const char* keyword(Effect effect) {
  return effect == Effect::None ? "none" : effect == Effect::Approximate ? "approximate" : "lost";
}

void Report::converted(const Place& place, std::string from, std::string to) {
  conversions.push_back({place, std::move(from), std::move(to)});
}

void Report::note(Effect effect, const Place& place, std::string what, std::string why) {
  notes.push_back({effect, place, std::move(what), std::move(why)});
}

std::size_t Report::count(Effect effect) const {
  return static_cast<std::size_t>(
      std::count_if(notes.begin(), notes.end(), [&](const Note& note) { return note.effect == effect; }));
}

std::string textOf(const Report& report, bool all) {
  std::string out = report.file + ": " + report.format + ", " + std::to_string(report.conversions.size()) +
                    " elements converted, " + std::to_string(report.count(Effect::Lost)) + " lost, " +
                    std::to_string(report.count(Effect::Approximate)) + " approximate, " +
                    std::to_string(report.count(Effect::None)) + " not used without effect\n";
  if (all && !report.conversions.empty()) {
    out += "Converted:\n";
    for (const Conversion& each : report.conversions)
      out += "  " + each.place.text() + ": " + each.from + " -> " + each.to + "\n";
  }
  for (const Effect effect : kEffects)
    if (all || effect != Effect::None) out += notesText(report, effect);
  return out;
}

std::string jsonOf(const Report& report) {
  Json json;
  json["file"] = report.file;
  json["format"] = report.format;
  json["exact"] = report.exact();
  for (const Effect effect : kEffects) json["counts"][keyword(effect)] = report.count(effect);
  json["converted"] = Json::array();
  for (const Conversion& each : report.conversions)
    json["converted"].push_back(
        {{"file", each.place.file}, {"line", each.place.line}, {"from", each.from}, {"to", each.to}});
  json["notes"] = Json::array();
  for (const Note& note : report.notes)
    json["notes"].push_back({{"effect", keyword(note.effect)},
                             {"file", note.place.file},
                             {"line", note.place.line},
                             {"what", note.what},
                             {"why", note.why}});
  // names in a model may hold bytes that are no UTF-8
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string inQuotes(const std::string& name) { return name.empty() ? "" : " '" + name + "'"; }

}  // namespace rubble::convert
