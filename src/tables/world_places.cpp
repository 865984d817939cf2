#include "tables/world_places.h"

#include <algorithm>
#include <cstring>

#include "solver/settings.h"
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

/// The contacts of bodies at their new places. `from`: old place of the body at each new one.
BodyContacts movedContacts(const HostTables& tables, const std::vector<int>& from, const Places& places) {
  BodyContacts contacts;
  for (const int old : from) appendContacts(tables.view(), old, old + 1, contacts);
  for (Pair& p : contacts.pair) renumber(places, p);
  for (ContactRows& r : contacts.row) renumber(places, r);
  return contacts;
}

/// The contacts of vertices at new places: those of body corners have other owners, and all name the bodies
/// where they are then.
PointContacts movedPoints(const HostTables& tables, const std::vector<int>& from, const Places& places) {
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
  return contacts;
}

/// Visits the arrays whose elements move with the bodies.
template <class Visit> void forEachMoved(Visit&& visit) {
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    bool moves = isBodyState(array);
    if constexpr (std::is_same_v<T, int>)
      moves |= array.member == &SolverData::idOf || array.member == &SolverData::worldOfBody;
    if (moves) visit(array);
  });
}

WorldPart worldPart(const WorldLayout& layout, int firstBody) {
  WorldPart part;
  part.firstBody = firstBody, part.bodies = static_cast<int>(layout.bodies.size());
  part.firstVertex = layout.first.vertex, part.vertices = layout.count.vertex;
  part.firstEdge = layout.first.edge, part.edges = layout.count.edge;
  part.firstFace = layout.first.face, part.faces = layout.count.face;
  part.firstAttachment = layout.firstAttachment, part.attachments = layout.attachments;
  std::ranges::copy(layout.first.element, part.firstElement);
  std::ranges::copy(layout.count.element, part.elements);
  std::ranges::copy(layout.joints, part.joints);
  part.shapes = layout.shapes, part.surfaces = layout.surfaces;
  return part;
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
  BodyContacts contacts = movedContacts(tables, from, places);
  PointContacts points;
  if (s.vertices > 0) points = movedPoints(tables, from, places);
  reserveContacts(tables, contacts), reservePoints(tables, points);
  std::size_t largest = 0;
  forEachMoved([&]<class T>(const ArrayInfo<T>&) { largest = std::max(largest, sizeof(T)); });
  std::vector<std::byte> old(largest * bodies);

  // from here on there is memory for everything
  storeContacts(tables, contacts);
  if (s.vertices > 0) storePoints(tables, points);
  forEachMoved([&]<class T>(const ArrayInfo<T>& array) {
    T* const elements = &(s.*array.member)[0];
    std::memcpy(old.data(), static_cast<const void*>(elements), sizeof(T) * bodies);
    for (std::size_t k = 0; k < bodies; ++k)
      std::memcpy(static_cast<void*>(elements + k),
                  old.data() + sizeof(T) * static_cast<std::size_t>(from[k]), sizeof(T));
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

std::vector<WorldPart> placeWorlds(HostTables& tables, std::span<const WorldLayout> worlds,
                                   std::span<const int> spare) {
  const int count = static_cast<int>(worlds.size());
  tables.reserve(Per::World, count);
  SolverData& s = tables.view();
  std::vector<int> order;  // ids in the order of their new places
  std::vector<WorldPart> parts;
  for (const WorldLayout& world : worlds) {
    parts.push_back(worldPart(world, static_cast<int>(order.size())));
    order.insert(order.end(), world.bodies.begin(), world.bodies.end());
  }
  const int inWorlds = static_cast<int>(order.size());
  order.insert(order.end(), spare.begin(), spare.end());
  placeBodies(tables, order);

  // from here on no memory is needed
  for (int w = 0; w < count; ++w) s.firstBody[w] = parts[static_cast<std::size_t>(w)].firstBody;
  s.firstBody[count] = inWorlds;
  s.worlds = count, s.fixedOrder = s.anyKinds = true;
  for (int w = 0; w < count; ++w) {
    const WorldPart& part = parts[static_cast<std::size_t>(w)];
    s.firstVertex[w] = part.firstVertex;
    s.paused[w] = 0;
    std::fill_n(&s.worldOfVertex[0] + part.firstVertex, part.vertices, w);
  }
  s.firstVertex[count] = s.vertices;
  return parts;
}

void setConstants(const SolverData& s, const EngineSettings& settings, int world, const WorldSettings& own) {
  StepConstants& c = s.step[world];
  c = s.step[0];
  setGravity(c, settings.params, own.gravity);
  c.stiffnessRescale = stiffnessRescale(settings.params, own.previousDt);
  c.wakeAll = settings.wakeAll || own.wakeAll;
}

}  // namespace rubble::RUBBLE_CORE
