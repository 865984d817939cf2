#include "tables/world_places.h"

#include <algorithm>

#include "stages/joints/joints.h"
#include "tables/contact_lists.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// New places of bodies; vertices stay.
struct Places {
  const std::vector<int>& to;
  void body(int& i) const {
    if (i >= 0) i = to[static_cast<std::size_t>(i)];
  }
  template <std::size_t n> void vertices(int (&)[n]) const {}
};

/// Moves the contacts of bodies. `from`: old place of the body at each new one.
void moveContacts(HostTables& tables, const std::vector<int>& from, const Places& places) {
  BodyContacts contacts;
  for (const int old : from) appendContacts(tables.view(), old, old + 1, contacts);
  for (Pair& p : contacts.pair) renumber(places, p);
  for (ContactRows& r : contacts.row) renumber(places, r);
  storeContacts(tables, contacts);
}

/// Moves the contacts of vertices: those of body corners to other owners, and all with the bodies that they
/// name.
void movePoints(HostTables& tables, const std::vector<int>& from, const Places& places) {
  const SolverData& s = tables.view();
  PointContacts contacts;
  const int fixed = s.vertices + s.edges;
  for (int owner = 0; owner < s.owners(); ++owner) {
    const int corner = owner - fixed;
    const auto body = static_cast<std::size_t>(std::max(corner, 0) / kCornerSlots);
    appendPoints(s, corner < 0 ? owner : fixed + kCornerSlots * from[body] + corner % kCornerSlots, contacts);
  }
  for (std::size_t k = 0; k < contacts.pair.size(); ++k) {
    int& other = contacts.pair[k].other;
    if (other >= 0) places.body(contacts.contact[k].body);
    if (other < kVertexNode) places.body(other);
  }
  storePoints(tables, contacts);
}

}  // namespace

void placeBodies(HostTables& tables, const std::vector<int>& ids) {
  const SolverData& s = tables.view();
  const auto bodies = static_cast<std::size_t>(s.bodies);
  std::vector<int> from(bodies), to(bodies);
  for (std::size_t k = 0; k < bodies; ++k) from[k] = k < ids.size() ? s.placeOf[ids[k]] : static_cast<int>(k);
  for (std::size_t k = 0; k < bodies; ++k) to[static_cast<std::size_t>(from[k])] = static_cast<int>(k);
  if (std::is_sorted(from.begin(), from.end())) return;
  const Places places{to};
  moveContacts(tables, from, places);
  if (s.vertices > 0) movePoints(tables, from, places);
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    bool moves = isBodyState(array);
    if constexpr (std::is_same_v<T, int>)
      moves |= array.member == &SolverData::idOf || array.member == &SolverData::worldOfBody;
    if (!moves) return;
    const std::vector<T> old = copyOf(s.*array.member, s.bodies);
    for (std::size_t k = 0; k < bodies; ++k) (s.*array.member)[k] = old[static_cast<std::size_t>(from[k])];
  });
  for (std::size_t k = 0; k < bodies; ++k) {
    places.body(s.placeOf[k]);
    int root = s.asleep[k] - 1;
    places.body(root);
    s.asleep[k] = root + 1;
  }
  for (int k = 0; k < s.planes; ++k) places.body(s.planeBody[k]);
  for (int k = 0; k < s.attachments; ++k) renumber(places, s.attachment[k]);
  forEachType(JointTypes{}, [&]<class F>() {
    for (int i = 0; i < s.joints[typeIndex<F>(JointTypes{})]; ++i)
      renumber(places, s.specsOf<F>()[i]), renumber(places, s.jointsOf<F>()[i]);
  });
  tables.view().ordered = inOtherOrder(s);
  tables.trees.touchAll();
}

}  // namespace rubble::RUBBLE_CORE
