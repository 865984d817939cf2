#pragma once
/// Similarity of names, for suggestions in errors.
#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

namespace rubble {

/// Levenshtein distance of two names; any number above `most` if it is above that.
inline std::size_t editDistance(std::string_view a, std::string_view b, std::size_t most) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > most) return most + 1;
  most = std::min(most, a.size() + b.size());
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    // what lies further from the diagonal is above `most`
    const std::size_t first = i > most ? i - most : 1, last = std::min(b.size(), i + most);
    std::size_t diagonal = std::exchange(row[first - 1], first == 1 ? i : most + 1);
    std::size_t least = row[first - 1];
    for (std::size_t j = first; j <= last; ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      diagonal = above;
      least = std::min(least, row[j]);
    }
    // no later row has a smaller number
    if (least > most) return most + 1;
  }
  return row[b.size()];
}

}  // namespace rubble
