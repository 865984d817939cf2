#pragma once
/// Contacts of the last step as lists, in the order of their owners, and how they and other elements name
/// bodies and vertices.
#include <cstring>
#include <vector>

#include "tables/host_tables.h"

namespace rubble::RUBBLE_CORE {

/// Contacts of bodies, in the order of the tables.
struct BodyContacts {
  std::vector<int> pairsOfBody, activeOfPair;  ///< number of pairs of each body; 1: the pair is active
  std::vector<Pair> pair;
  std::vector<PairTest> test;
  std::vector<Manifold> manifold;
  std::vector<RollingRows> rolling;  ///< one per manifold, or none
  std::vector<ContactRows> row;
};
/// Contacts of vertices, edges and body corners, in this order.
struct PointContacts {
  std::vector<int> pairsOfOwner;
  std::vector<PointPair> pair;
  std::vector<PointContact> contact;
};

/// Appends the contacts of the bodies [begin, end).
void appendContacts(const SolverData& s, int begin, int end, BodyContacts& to);
/// Makes room, so that storeContacts() needs no memory.
void reserveContacts(HostTables& tables, BodyContacts& contacts);
/// Makes these the contacts of the last step.
void storeContacts(HostTables& tables, BodyContacts& contacts);
/// Appends the contacts of an owner of point pairs. Empty pairs, whose number depends on what else is in the
/// buckets of the grid, are left out.
void appendPoints(const SolverData& s, int owner, PointContacts& to);
/// Makes room, so that storePoints() needs no memory.
void reservePoints(HostTables& tables, const PointContacts& contacts);
/// The same for contacts of points, in the order of all owners. PointPair::vertex is set.
void storePoints(HostTables& tables, PointContacts& contacts);

// Renumbering: `Numbers` has body(int&), which keeps negative numbers, and vertices(int (&)[n]).

template <class Numbers, class F> void renumber(const Numbers& numbers, JointSpec<F>& spec) {
  numbers.body(spec.a), numbers.body(spec.b);
  if constexpr (hasFrameBodies<F>()) numbers.body(spec.frameBodyA), numbers.body(spec.frameBodyB);
}
template <class Numbers, class F> void renumber(const Numbers& numbers, Joint<F>& joint) {
  if constexpr (isPivot<F>())
    for (JointEnd& end : joint.end) numbers.body(end.body);
}
template <class Numbers> void renumber(const Numbers& numbers, Attachment& a) {
  numbers.vertices(a.v), numbers.body(a.body);
}
template <class Numbers> void renumber(const Numbers& numbers, Pair& p) {
  numbers.body(p.owner), numbers.body(p.other);
}
template <class Numbers> void renumber(const Numbers& numbers, PointContact& p) {
  numbers.vertices(p.v), numbers.body(p.body);
}

template <class Numbers> void renumber(const Numbers& numbers, ContactRows& r) {
  numbers.body(r.a), numbers.body(r.b);
}

template <class T> void store(const Array<T>& to, const std::vector<T>& from) {
  if (!from.empty()) std::memcpy(static_cast<void*>(&to[0]), from.data(), sizeof(T) * from.size());
}

}  // namespace rubble::RUBBLE_CORE
