#pragma once
/// Near matches of names that do not exist.
#include <string>
#include <vector>

namespace rubble::cli {

/// "; did you mean a or b?" for the names nearest to `name`, each after `prefix`, or "" if none is near.
std::string suggestion(const std::string& name, const std::vector<std::string>& names,
                       const std::string& prefix = "");

}  // namespace rubble::cli
