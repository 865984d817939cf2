#pragma once
#include <string>

#include <nlohmann/json.hpp>

namespace rubble::io {

/// JSON for people: what fits on a line stands on one, all else one element a line. Numbers read back as they
/// were.
std::string prettyJson(const nlohmann::ordered_json& value);

}  // namespace rubble::io
