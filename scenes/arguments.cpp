#include "near_names.h"

#include <algorithm>
#include <cmath>

#include "cook/checks.h"
#include "cook/names.h"
#include "registry.h"

namespace rubble::scenes {

using checks::text;

std::string nearNames(const std::string& name, const std::vector<std::string>& names, const char* list) {
  constexpr std::size_t kMany = 12, kMostNear = 8;
  const std::size_t tolerance = std::max<std::size_t>(2, name.size() / 3);
  std::vector<std::string> near;
  for (const std::string& candidate : names)
    if (candidate.find(name) != std::string::npos || editDistance(name, candidate, tolerance) <= tolerance)
      near.push_back(candidate);
  if (near.empty() && names.size() > kMany) return std::string("one of those that '") + list + "' lists";
  if (near.empty()) near = names;
  if (near.size() > kMany) near.resize(kMostNear), near.emplace_back("...");
  std::string text;
  for (const std::string& each : near) text += (text.empty() ? "" : ", ") + each;
  return text.empty() ? "no name at all" : "one of " + text;
}

Arguments resolve(const Spec& spec, const Arguments& overrides) {
  Arguments resolved;
  std::vector<std::string> names;
  for (const Argument& argument : spec.arguments) {
    resolved[argument.name] = argument.value;
    names.push_back(argument.name);
  }
  for (const auto& [name, number] : overrides) {
    const auto found = std::find_if(spec.arguments.begin(), spec.arguments.end(),
                                    [&, key = name](const Argument& a) { return a.name == key; });
    if (found == spec.arguments.end())
      throw Error(spec.name + ", argument", nearNames(name, names, "rubble info scene"), "\"" + name + "\"");
    const std::string range = "[" + text(found->min) + ", " + text(found->max) + "]";
    if (!(number >= found->min && number <= found->max))
      throw Error(spec.name + ", argument " + name, "a number in " + range, text(number));
    if (found->whole && number != std::floor(number))
      throw Error(spec.name + ", argument " + name, "a whole number in " + range, text(number));
    resolved[name] = number;
  }
  return resolved;
}

}  // namespace rubble::scenes
