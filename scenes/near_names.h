#pragma once
#include <string>
#include <vector>

namespace rubble::scenes {

/// "one of a, b, c" of those names that are like `name`; if none is, of all of them or, of many, where they
/// are listed.
std::string nearNames(const std::string& name, const std::vector<std::string>& names, const char* list);

}  // namespace rubble::scenes
