#include "tables/contact_lists.h"

#include <algorithm>

namespace rubble::RUBBLE_CORE {

void appendContacts(const SolverData& s, int begin, int end, BodyContacts& to) {
  const auto append = [](auto& list, const auto& array, int first, int last) {
    list.insert(list.end(), &array[0] + first, &array[0] + last);
  };
  const int pairs = s.oldPairOffset[begin], pairsEnd = s.oldPairOffset[end];
  for (int i = begin; i < end; ++i) to.pairsOfBody.push_back(s.oldPairOffset[i + 1] - s.oldPairOffset[i]);
  append(to.pair, s.oldPair, pairs, pairsEnd);
  append(to.test, s.oldPairTest, pairs, pairsEnd);
  if (pairs == pairsEnd) return;
  for (int k = pairs; k < pairsEnd; ++k)
    to.activeOfPair.push_back(s.oldActivePairOffset[k + 1] - s.oldActivePairOffset[k]);
  const int first = s.oldActivePairOffset[pairs], last = s.oldActivePairOffset[pairsEnd];
  const int firstManifold = static_cast<int>(to.manifold.size());
  for (int k = first; k < last; ++k) {
    Manifold m = s.oldManifold[k];
    if (m.row >= 0) {
      ContactRows r = s.contact[m.row];
      r.manifold = firstManifold + k - first;
      m.row = static_cast<int>(to.row.size());
      to.row.push_back(r);
    }
    to.manifold.push_back(m);
  }
  if (!s.rolledBefore) return;
  // worlds before may have manifolds without such rows
  to.rolling.resize(static_cast<std::size_t>(firstManifold), RollingRows{});
  append(to.rolling, s.oldRolling, first, last);
}

void appendPoints(const SolverData& s, int owner, PointContacts& to) {
  const std::size_t before = to.pair.size();
  for (int k = s.oldPointPairOffset[owner]; k < s.oldPointPairOffset[owner + 1]; ++k)
    if (s.oldPointPair[k].other >= 0)
      to.pair.push_back(s.oldPointPair[k]), to.contact.push_back(s.oldPointContact[k]);
  to.pairsOfOwner.push_back(static_cast<int>(to.pair.size() - before));
}

void reserveContacts(HostTables& tables, BodyContacts& c) {
  const int active = static_cast<int>(c.manifold.size());
  tables.reserve(Per::Pair, static_cast<int>(c.pair.size())), tables.reserve(Per::ActivePair, active);
  if (c.rolling.empty()) return;
  // contacts without memory of rolling begin it anew
  c.rolling.resize(c.manifold.size(), RollingRows{});
  tables.reserve(Per::Rolling, std::max(active, tables.capacity(Per::ActivePair)));
}

void storeContacts(HostTables& tables, BodyContacts& c) {
  reserveContacts(tables, c);
  const int pairs = static_cast<int>(c.pair.size()), active = static_cast<int>(c.manifold.size());
  SolverData& s = tables.view();
  int sum = 0;
  for (int i = 0; i < s.bodies; ++i) {
    s.oldPairOffset[i] = sum;
    sum += c.pairsOfBody[static_cast<std::size_t>(i)];
  }
  s.oldPairOffset[s.bodies] = sum;
  sum = 0;
  for (int k = 0; k < pairs; ++k) {
    s.oldActivePairOffset[k] = sum;
    sum += c.activeOfPair[static_cast<std::size_t>(k)];
  }
  s.oldActivePairOffset[pairs] = sum;
  if (!c.rolling.empty()) {
    store(s.oldRolling, c.rolling);
    s.rolledBefore = true;
    s.counters->rollers = active;
  }
  store(s.oldPair, c.pair), store(s.oldPairTest, c.test), store(s.oldManifold, c.manifold);
  store(s.contact, c.row);
  s.counters->activePairs = active, s.counters->manifolds = static_cast<int>(c.row.size());
}

void reservePoints(HostTables& tables, const PointContacts& c) {
  tables.reserve(Per::PointPair, static_cast<int>(c.pair.size()));
}

void storePoints(HostTables& tables, PointContacts& c) {
  reservePoints(tables, c);
  const SolverData& s = tables.view();
  int sum = 0;
  for (int owner = 0; owner < s.owners(); ++owner) {
    s.oldPointPairOffset[owner] = sum;
    for (int k = c.pairsOfOwner[static_cast<std::size_t>(owner)]; k > 0; --k)
      c.pair[static_cast<std::size_t>(sum++)].vertex = owner;
  }
  s.oldPointPairOffset[s.owners()] = sum;
  store(s.oldPointPair, c.pair), store(s.oldPointContact, c.contact);
}

}  // namespace rubble::RUBBLE_CORE
