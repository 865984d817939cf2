#include "tables/exclusions.h"

#include <algorithm>
#include <numeric>

#include "stages/pairs/filter.h"

namespace rubble::RUBBLE_CORE {

namespace {

constexpr ExcludedPair kNoPair{-1, -1};

/// Elements for that many pairs: at most half of them are in use.
int sizeFor(int pairs) {
  constexpr int kLeast = 16;
  return pairs == 0 ? 0 : std::max(kLeast, static_cast<int>(std::bit_ceil(2 * static_cast<unsigned>(pairs))));
}

/// The element of a pair, or the empty one where it belongs.
int placeIn(const SolverData& s, const ExcludedPair& pair) {
  int k = firstPlace(pair, s.exclusions);
  while (s.exclusion[k] != kNoPair && s.exclusion[k] != pair) k = (k + 1) % s.exclusions;
  return k;
}

/// Rebuilds the table with that many elements, a power of two.
void rebuild(HostTables& tables, const std::vector<ExcludedPair>& pairs, int size,
             std::vector<int>& changed) {
  tables.reserve(Per::Exclusion, size);
  SolverData& s = tables.view();
  s.exclusions = size;
  std::ranges::fill(firstOf(s.exclusion, size), kNoPair);
  for (const ExcludedPair& pair : pairs) s.exclusion[placeIn(s, pair)] = pair;
  changed.resize(static_cast<std::size_t>(size));
  std::iota(changed.begin(), changed.end(), 0);
}

/// Empties an element and moves later ones of its run forward, so that each is found from its first place.
void removeAt(const SolverData& s, int hole, std::vector<int>& changed) {
  for (int k = (hole + 1) % s.exclusions; s.exclusion[k] != kNoPair; k = (k + 1) % s.exclusions) {
    const int first = firstPlace(s.exclusion[k], s.exclusions);
    // the element may move unless its first place lies between the hole and itself
    if ((k - first + s.exclusions) % s.exclusions < (k - hole + s.exclusions) % s.exclusions) continue;
    s.exclusion[hole] = s.exclusion[k];
    changed.push_back(hole);
    hole = k;
  }
  s.exclusion[hole] = kNoPair;
  changed.push_back(hole);
}

}  // namespace

std::vector<ExcludedPair> excludedPairs(const SolverData& s) {
  std::vector<ExcludedPair> pairs;
  std::ranges::copy_if(firstOf(s.exclusion, s.exclusions), std::back_inserter(pairs),
                       [](const ExcludedPair& pair) { return pair != kNoPair; });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

void loadExclusions(HostTables& tables, const std::vector<ExcludedPair>& pairs) {
  std::vector<int> changed;
  tables.excludedPairs = static_cast<int>(pairs.size());
  rebuild(tables, pairs, sizeFor(tables.excludedPairs), changed);
}

void setExcluded(HostTables& tables, int a, int b, bool excluded, std::vector<int>& changed, int world) {
  SolverData& s = tables.view();
  const ExcludedPair pair{std::min(a, b), std::max(a, b), world};
  if (excluded == isExcluded(s, pair)) return;
  tables.excludedPairs += excluded ? 1 : -1;
  if (const int size = sizeFor(tables.excludedPairs); size > s.exclusions || size == 0) {
    std::vector<ExcludedPair> pairs = excludedPairs(s);
    excluded ? pairs.push_back(pair) : pairs.clear();
    rebuild(tables, pairs, size, changed);
    return;
  }
  const int place = placeIn(s, pair);
  if (!excluded) return removeAt(s, place, changed);
  s.exclusion[place] = pair;
  changed.push_back(place);
}

}  // namespace rubble::RUBBLE_CORE
