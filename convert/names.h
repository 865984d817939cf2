#pragma once
#include <map>
#include <string>

namespace rubble::convert {

/// Gives each name once: a name that was given before gets a number behind it.
class Names {
 public:
  std::string unique(const std::string& wanted) {
    const auto [entry, isNew] = next_.try_emplace(wanted, 2);
    if (isNew) return wanted;
    for (;;) {
      std::string name = wanted + "_" + std::to_string(entry->second++);
      if (next_.try_emplace(name, 2).second) return name;
    }
  }

 private:
  std::map<std::string, int> next_;  ///< number to try next for each name that was given
};

}  // namespace rubble::convert
