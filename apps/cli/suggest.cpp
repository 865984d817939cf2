#include "apps/cli/suggest.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cook/names.h"

namespace rubble::cli {

std::string suggestion(const std::string& name, const std::vector<std::string>& names,
                       const std::string& prefix) {
  constexpr std::size_t kMost = 3;
  // two slips at most in a short name; long ones may have more
  const std::size_t tolerance = std::max<std::size_t>(2, name.size() / 3);
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const std::string& candidate : names) {
    const std::size_t most = std::min({tolerance, name.size() - 1, candidate.size() - 1});
    const std::size_t distance = editDistance(name, candidate, most);
    const bool begins = name.size() > 3 && candidate.rfind(name, 0) == 0;
    if (begins || distance <= most) near.emplace_back(begins ? 0 : distance, candidate);
  }
  std::ranges::sort(near);
  std::vector<std::string> best;
  for (std::size_t i = 0; i < std::min(near.size(), kMost); ++i) best.push_back(prefix + near[i].second);
  return best.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(best, " or "));
}

}  // namespace rubble::cli
