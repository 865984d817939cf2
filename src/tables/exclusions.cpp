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

/// Makes the table one of that many elements, a power of two, all of them empty.
void resize(HostTables& tables, int size) {
  tables.reserve(Per::Exclusion, size);
  tables.view().exclusions = size;
  std::ranges::fill(firstOf(tables.view().exclusion, size), kNoPair);
}

/// Empties an element and moves later ones of its run forward, so that each is found from its first place.
void removeAt(const SolverData& s, int hole, std::vector<int>* changed) {
  for (int k = (hole + 1) % s.exclusions; s.exclusion[k] != kNoPair; k = (k + 1) % s.exclusions) {
    const int first = firstPlace(s.exclusion[k], s.exclusions);
    // the element may move unless its first place lies between the hole and itself
    if ((k - first + s.exclusions) % s.exclusions < (k - hole + s.exclusions) % s.exclusions) continue;
    s.exclusion[hole] = s.exclusion[k];
    if (changed) changed->push_back(hole);
    hole = k;
  }
  s.exclusion[hole] = kNoPair;
  if (changed) changed->push_back(hole);
}

/// Grows the table to that many elements, a power of two.
void grow(HostTables& tables, int size) {
  SolverData& s = tables.view();
  std::vector<ExcludedPair>& pairs = tables.movingPairs;
  pairs.clear();
  std::ranges::copy_if(firstOf(s.exclusion, s.exclusions), std::back_inserter(pairs),
                       [](const ExcludedPair& pair) { return pair != kNoPair; });
  resize(tables, size);
  for (const ExcludedPair& pair : pairs) s.exclusion[placeIn(s, pair)] = pair;
  pairs = {};
}

}  // namespace

std::vector<ExcludedPair> excludedPairs(const SolverData& s) {
  std::vector<ExcludedPair> pairs;
  std::ranges::copy_if(firstOf(s.exclusion, s.exclusions), std::back_inserter(pairs),
                       [](const ExcludedPair& pair) { return pair != kNoPair; });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

void reserveExclusions(HostTables& tables, int more) {
  const int pairs = tables.excludedPairs + more, size = sizeFor(pairs);
  if (more == 0 || size <= tables.view().exclusions) return;
  tables.movingPairs.reserve(static_cast<std::size_t>(pairs));
  tables.reserve(Per::Exclusion, size);
}

void reserveLoadedExclusions(HostTables& tables, int pairs) {
  tables.reserve(Per::Exclusion, sizeFor(pairs));
}

void clearExclusions(HostTables& tables, int pairs) {
  tables.excludedPairs = 0;
  resize(tables, sizeFor(pairs));
}

void setExcluded(HostTables& tables, int a, int b, bool excluded, std::vector<int>* changed, int world) {
  SolverData& s = tables.view();
  const ExcludedPair pair{std::min(a, b), std::max(a, b), world};
  if (excluded == isExcluded(s, pair)) return;
  const int pairs = tables.excludedPairs + (excluded ? 1 : -1), size = sizeFor(pairs);
  const bool grows = size > s.exclusions;
  if (grows) grow(tables, size);
  tables.excludedPairs = pairs;
  const int place = placeIn(s, pair);
  if (excluded)
    s.exclusion[place] = pair;
  else if (pairs > 0)
    return removeAt(s, place, changed);
  else
    resize(tables, 0);
  if (!changed) return;
  if (grows || pairs == 0) {
    changed->resize(static_cast<std::size_t>(size));
    std::iota(changed->begin(), changed->end(), 0);
  } else {
    changed->push_back(place);
  }
}

}  // namespace rubble::RUBBLE_CORE
