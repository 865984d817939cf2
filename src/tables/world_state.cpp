#include "tables/world_state.h"

#include <algorithm>
#include <cstring>

#include "stages/pairs/active_pairs.h"
#include "stages/soft/body_corners.h"
#include "tables/clean_copy.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Elements whose number is part of a state.
struct StateCounts {
  int pairs, activePairs, rows, rolls, pointPairs;
};

/// Maps numbers in the tables to numbers in a world, or back.
class Numbers {
 public:
  Numbers(const SolverData& s, const WorldPart& part, bool toWorld)
      : s_(s), part_(part), sign_(toWorld ? -1 : 1) {}

  bool toWorld() const { return sign_ < 0; }
  void body(int& i) const { shift(i, part_.firstBody); }
  void vertex(int& v) const { shift(v, part_.firstVertex); }
  template <std::size_t n> void vertices(int (&v)[n]) const {
    for (int& each : v) vertex(each);
  }
  /// Shape and material of a body.
  void params(BodyParams& p) const {
    for (const WorldShape& shape : part_.shapes) {
      const int from = sign_ < 0 ? shape.baseInTables : shape.base,
                to = sign_ < 0 ? shape.base : shape.baseInTables;
      if (p.shape.data < from || p.shape.data >= from + shape.size) continue;
      p.shape.data += to - from;
      break;
    }
    if (p.surface < 0) return;
    p.surface = sign_ < 0
                    ? static_cast<int>(std::ranges::find(part_.surfaces, p.surface) - part_.surfaces.begin())
                    : part_.surfaces[static_cast<std::size_t>(p.surface)];
  }
  /// A partner of a pair of points (PointPair::other).
  void partner(int& other) const {
    if (other >= kFeatureNode)
      feature(other);
    else
      shift(other, other >= kVertexNode ? part_.firstVertex : part_.firstBody);
  }

 private:
  void shift(int& i, int first) const {
    if (i >= 0) i += sign_ * first;
  }
  /// Edges come before triangles, in the tables and in a world.
  void feature(int& other) const {
    int k = other - kFeatureNode;
    if (sign_ < 0)
      k = k < s_.edges ? k - part_.firstEdge : k - s_.edges - part_.firstFace + part_.edges;
    else
      k = k < part_.edges ? k + part_.firstEdge : k - part_.edges + s_.edges + part_.firstFace;
    other = kFeatureNode + k;
  }

  const SolverData& s_;
  const WorldPart& part_;
  int sign_;
};

template <class T> bool isVertexState(const ArrayInfo<T>& array) {
  return array.per == Per::Vertex && array.extra == 0 && array.life == Lifetime::State;
}

/// Calls io(element, count) and renumbering for all elements of a world but its contacts, in a fixed order.
/// `Io`: values(T* elements, n), and renumbered(T* elements, n, renumber).
template <class Io> void visitElements(SolverData& s, const WorldPart& part, Io&& io) {
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (isBodyState(array)) {
      T* const first = &(s.*array.member)[0] + part.firstBody;
      if constexpr (std::is_same_v<T, int>)
        if (array.member == &SolverData::asleep)
          return io.renumbered(first, part.bodies, [](const Numbers& numbers, int& asleep) {
            int root = asleep - 1;
            numbers.body(root);
            asleep = root + 1;
          });
      if constexpr (std::is_same_v<T, BodyParams>)
        io.renumbered(first, part.bodies, [](const Numbers& numbers, BodyParams& p) { numbers.params(p); });
      else
        io.values(first, part.bodies);
    } else if (isVertexState(array)) {
      io.values(&(s.*array.member)[0] + part.firstVertex, part.vertices);
    }
  });
  forEachType(ElementTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(ElementTypes{});
    if (part.elements[kType] > 0)
      io.renumbered(s.elementsOf<F>() + part.firstElement[kType], part.elements[kType],
                    [](const Numbers& numbers, F& element) { numbers.vertices(element.v); });
  });
  const auto renumbers = [](const Numbers& numbers, auto& element) { renumber(numbers, element); };
  if (part.attachments > 0)
    io.renumbered(&s.attachment[0] + part.firstAttachment, part.attachments, renumbers);
  forEachType(JointTypes{}, [&]<class F>() {
    for (const int slot : part.joints[typeIndex<F>(JointTypes{})]) {
      const JointSpec<F>& spec = s.specsOf<F>()[slot];
      io.renumbered(s.specsOf<F>() + slot, 1, renumbers);
      io.renumbered(s.jointsOf<F>() + slot, 1, [&](const Numbers& numbers, Joint<F>& joint) {
        // a joint that never acted has no bodies in its frame
        if constexpr (isPivot<F>())
          if (numbers.toWorld()) joint.end[0].body = spec.a, joint.end[1].body = spec.b;
        renumber(numbers, joint);
      });
    }
  });
}

/// Appends elements to a state.
struct Writer {
  std::vector<std::byte>& out;
  const Numbers& numbers;
  template <class T> void values(const T* from, int count) {
    const std::size_t at = out.size(), bytes = sizeof(T) * static_cast<std::size_t>(count);
    out.resize(at + bytes);
    copyClean(out.data() + at, from, bytes);
  }
  template <class T, class Renumber> void renumbered(const T* from, int count, Renumber&& renumber) {
    for (int i = 0; i < count; ++i) {
      T element = from[i];
      renumber(numbers, element);
      values(&element, 1);
    }
  }
  /// GCC 12 leaves the padding of rows in double precision as it is.
  void rows(const std::vector<ContactRows>& from) {
    for (const ContactRows& row : from) {
      const std::size_t at = out.size();
      out.resize(at + sizeof row);
      std::memcpy(out.data() + at, &row, sizeof row);
      const auto clear = [&](std::size_t begin, std::size_t end) {
        std::fill(out.data() + at + begin, out.data() + at + end, std::byte{0});
      };
      clear(offsetof(ContactRows, manifold) + sizeof row.manifold, offsetof(ContactRows, length));
      clear(offsetof(ContactRows, perLoad) + sizeof row.perLoad, sizeof row);
    }
  }
  template <class T> void list(const std::vector<T>& from) {
    values(from.data(), static_cast<int>(from.size()));
  }
};
/// Reads elements of a state.
struct Reader {
  std::span<const std::byte> in;
  const Numbers& numbers;
  template <class T> void values(T* to, int count) {
    const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(count);
    if (bytes > 0) std::memcpy(static_cast<void*>(to), in.data(), bytes);
    in = in.subspan(bytes);
  }
  template <class T, class Renumber> void renumbered(T* to, int count, Renumber&& renumber) {
    values(to, count);
    for (int i = 0; i < count; ++i) renumber(numbers, to[i]);
  }
  template <class T> void list(std::vector<T>& to, int count) {
    const std::size_t at = to.size();
    to.resize(at + static_cast<std::size_t>(count));
    values(to.data() + at, count);
  }
};
/// Counts the bytes of elements.
struct Measure {
  std::size_t bytes = 0;
  template <class T> void values(const T*, int count) {
    bytes += sizeof(T) * static_cast<std::size_t>(count);
  }
  template <class T, class Renumber> void renumbered(const T* elements, int count, Renumber&&) {
    values(elements, count);
  }
};

StateCounts countsOf(std::span<const std::byte> state) {
  StateCounts counts;
  std::memcpy(&counts, state.data(), sizeof counts);
  return counts;
}

}  // namespace

std::vector<OwnerRange> pointOwnersOf(const SolverData& s, const WorldPart& part) {
  const int corners = s.vertices + s.edges;
  std::vector<OwnerRange> ranges{{part.firstVertex, part.firstVertex + part.vertices},
                                 {s.vertices + part.firstEdge, s.vertices + part.firstEdge + part.edges}};
  if (part.edges + part.faces > 0)
    ranges.push_back(
        {corners + kCornerSlots * part.firstBody, corners + kCornerSlots * (part.firstBody + part.bodies)});
  return ranges;
}

std::vector<std::byte> takeWorld(const HostTables& tables, const WorldPart& part) {
  SolverData s = tables.view();
  const Numbers numbers(s, part, true);
  BodyContacts bodies;
  PointContacts points;
  appendContacts(s, part.firstBody, part.firstBody + part.bodies, bodies);
  for (Pair& p : bodies.pair) renumber(numbers, p);
  for (ContactRows& r : bodies.row) renumber(numbers, r);
  // rolling friction anywhere gives all manifolds such rows
  const auto resists = [](const RollingRows& r) { return r.rolling > Real(0) || r.torsional > Real(0); };
  if (std::ranges::none_of(bodies.rolling, resists)) bodies.rolling.clear();
  if (s.vertices > 0)
    for (const OwnerRange& owners : pointOwnersOf(s, part))
      for (int owner = owners.begin; owner < owners.end; ++owner) appendPoints(s, owner, points);
  for (std::size_t k = 0; k < points.pair.size(); ++k) {
    PointPair& pair = points.pair[k];
    pair.vertex = 0, numbers.partner(pair.other);
    renumber(numbers, points.contact[k]);
  }
  const auto count = [](const auto& list) { return static_cast<int>(list.size()); };
  const StateCounts counts{count(bodies.pair), count(bodies.manifold), count(bodies.row),
                           count(bodies.rolling), count(points.pair)};
  std::vector<std::byte> out;
  Writer writer{out, numbers};
  writer.values(&counts, 1);
  visitElements(s, part, writer);
  writer.list(bodies.pairsOfBody), writer.list(bodies.pair), writer.list(bodies.test);
  writer.list(bodies.activeOfPair), writer.list(bodies.manifold), writer.list(bodies.rolling);
  writer.rows(bodies.row);
  writer.list(points.pairsOfOwner), writer.list(points.pair), writer.list(points.contact);
  return out;
}

namespace {

/// Reads the contacts of a state behind those of the worlds before it.
void readContacts(const SolverData& s, const WorldPart& part, Reader& reader, const StateCounts& counts,
                  BodyContacts& bodies, PointContacts& points) {
  const Numbers& numbers = reader.numbers;
  const std::size_t firstPair = bodies.pair.size(), firstManifold = bodies.manifold.size(),
                    firstRow = bodies.row.size(), firstPoint = points.pair.size();
  reader.list(bodies.pairsOfBody, part.bodies);
  reader.list(bodies.pair, counts.pairs), reader.list(bodies.test, counts.pairs);
  reader.list(bodies.activeOfPair, counts.pairs), reader.list(bodies.manifold, counts.activePairs);
  if (counts.rolls > 0) bodies.rolling.resize(firstManifold, RollingRows{});
  reader.list(bodies.rolling, counts.rolls);
  reader.list(bodies.row, counts.rows);
  for (std::size_t k = firstPair; k < bodies.pair.size(); ++k) renumber(numbers, bodies.pair[k]);
  for (std::size_t k = firstManifold; k < bodies.manifold.size(); ++k)
    if (bodies.manifold[k].row >= 0) bodies.manifold[k].row += static_cast<int>(firstRow);
  for (std::size_t k = firstRow; k < bodies.row.size(); ++k) {
    ContactRows& r = bodies.row[k];
    renumber(numbers, r);
    r.manifold += static_cast<int>(firstManifold);
  }
  int owners = 0;
  if (s.vertices > 0)
    for (const OwnerRange& range : pointOwnersOf(s, part)) owners += range.end - range.begin;
  reader.list(points.pairsOfOwner, owners);
  reader.list(points.pair, counts.pointPairs), reader.list(points.contact, counts.pointPairs);
  for (std::size_t k = firstPoint; k < points.pair.size(); ++k) {
    numbers.partner(points.pair[k].other);
    renumber(numbers, points.contact[k]);
  }
}

/// All point contacts, with others for changed worlds, which list their owners in ascending order.
PointContacts changedPoints(const SolverData& s, std::span<const WorldPart> parts,
                            std::span<const WorldChange> changes, const std::vector<PointContacts>& changed) {
  std::vector<int> changeOf(static_cast<std::size_t>(s.owners()), -1);
  for (std::size_t k = 0; k < changes.size(); ++k)
    for (const OwnerRange& range : pointOwnersOf(s, parts[static_cast<std::size_t>(changes[k].world)]))
      std::fill(changeOf.begin() + range.begin, changeOf.begin() + range.end, static_cast<int>(k));
  std::vector<std::size_t> owners(changes.size(), 0), pairs(changes.size(), 0);  // those taken
  PointContacts all;
  for (int owner = 0; owner < s.owners(); ++owner) {
    const int change = changeOf[static_cast<std::size_t>(owner)];
    if (change < 0) {
      appendPoints(s, owner, all);
      continue;
    }
    const auto k = static_cast<std::size_t>(change);
    const int count = changed[k].pairsOfOwner[owners[k]++];
    const auto first = static_cast<std::ptrdiff_t>(pairs[k]);
    all.pairsOfOwner.push_back(count);
    all.pair.insert(all.pair.end(), changed[k].pair.begin() + first, changed[k].pair.begin() + first + count);
    all.contact.insert(all.contact.end(), changed[k].contact.begin() + first,
                       changed[k].contact.begin() + first + count);
    pairs[k] += static_cast<std::size_t>(count);
  }
  return all;
}

/// Replaces the elements of a world, but not its contacts.
void readElements(SolverData& s, const WorldPart& part, std::span<const std::byte> state) noexcept {
  const Numbers numbers(s, part, false);
  visitElements(s, part, Reader{state.subspan(sizeof(StateCounts)), numbers});
}

/// Appends the contacts of a state.
void appendState(SolverData& s, const WorldPart& part, std::span<const std::byte> state, BodyContacts& bodies,
                 PointContacts& points) {
  Measure elements;
  visitElements(s, part, elements);
  const Numbers numbers(s, part, false);
  Reader reader{state.subspan(sizeof(StateCounts) + elements.bytes), numbers};
  readContacts(s, part, reader, countsOf(state), bodies, points);
}

}  // namespace

/// What the tables derive from joints and bodies of a world, before a change.
class DerivedOfWorld {
 public:
  DerivedOfWorld(const HostTables& tables, const WorldPart& part) : part_(&part) {
    const SolverData& s = tables.view();
    for (int i = part.firstBody; i < part.firstBody + part.bodies; ++i) kinds_.push_back(s.params[i].kind);
    forEachLinks(s, [&](JointRef, const JointLinks& links) { links_.push_back(links); });
  }
  /// Counts the traits of the bodies, or takes them back.
  void count(const SolverData& s, TraitCounts& traits, int change) const noexcept {
    for (int i = part_->firstBody; i < part_->firstBody + part_->bodies; ++i)
      traits.count(s.extras[i].traits, change);
  }
  /// Tells the plan of the joint trees what the change is.
  void follow(HostTables& tables) const noexcept {
    const SolverData& s = tables.view();
    for (int k = 0; k < part_->bodies; ++k) {
      const int body = part_->firstBody + k;
      if (s.params[body].kind != kinds_[static_cast<std::size_t>(k)]) tables.trees.touch(body);
    }
    std::size_t k = 0;
    forEachLinks(
        s, [&](JointRef joint, const JointLinks& links) { tables.trees.relink(joint, links_[k++], links); });
  }

 private:
  template <class Visit> void forEachLinks(const SolverData& s, Visit&& visit) const {
    forEachType(JointTypes{}, [&]<class F>() {
      constexpr int kType = typeIndex<F>(JointTypes{});
      for (const int slot : part_->joints[kType])
        visit(JointRef{kType, slot}, linksOf<F>(s.specsOf<F>()[slot]));
    });
  }
  const WorldPart* part_;
  std::vector<BodyKind> kinds_;
  std::vector<JointLinks> links_;
};

struct WorldsToPut::Impl {
  HostTables& tables;
  std::span<const WorldPart> parts;
  std::vector<WorldChange> changes;
  std::vector<DerivedOfWorld> derived = {};

  const WorldPart& part(const WorldChange& change) const {
    return parts[static_cast<std::size_t>(change.world)];
  }
  void derive() {
    for (const WorldChange& change : changes) derived.emplace_back(tables, part(change));
  }
  /// Replaces the elements.
  void put() noexcept {
    SolverData& s = tables.view();
    TraitCounts traits = tables.traits();
    for (std::size_t k = 0; k < changes.size(); ++k) {
      derived[k].count(s, traits, -1);
      readElements(s, part(changes[k]), changes[k].state);
      derived[k].follow(tables);
      derived[k].count(s, traits, 1);
    }
    tables.setTraits(traits);
  }

  BodyContacts bodies = {};
  PointContacts points = {};
};

BodyContacts putElements(HostTables& tables, std::span<const WorldPart> parts,
                         std::span<const WorldChange> changes) {
  WorldsToPut::Impl own{tables, parts, {changes.begin(), changes.end()}};
  for (const WorldChange& change : changes)
    appendState(tables.view(), own.part(change), change.state, own.bodies, own.points);
  own.derive();
  own.put();
  return std::move(own.bodies);
}

WorldsToPut::WorldsToPut(HostTables& tables, std::span<const WorldPart> parts,
                         std::span<const WorldChange> changes)
    : impl_(std::make_unique<Impl>(Impl{tables, parts, {changes.begin(), changes.end()}})) {
  SolverData& s = tables.view();
  std::vector<PointContacts> points(changes.size());
  int next = 0;  // the contacts of bodies before it are in the list
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const WorldPart& part = impl_->part(changes[k]);
    appendContacts(s, next, part.firstBody, impl_->bodies);
    next = part.firstBody + part.bodies;
    appendState(s, part, changes[k].state, impl_->bodies, points[k]);
  }
  appendContacts(s, next, s.bodies, impl_->bodies);
  reserveContacts(tables, impl_->bodies);
  if (s.vertices > 0) {
    impl_->points = changedPoints(s, parts, changes, points);
    reservePoints(tables, impl_->points);
  }
  impl_->derive();
}
WorldsToPut::~WorldsToPut() = default;

void WorldsToPut::put() noexcept {
  HostTables& tables = impl_->tables;
  impl_->put();
  if (tables.view().vertices > 0) storePoints(tables, impl_->points);
  storeContacts(tables, impl_->bodies);
}

void putWithoutContacts(HostTables& tables, std::span<const WorldPart> parts,
                        std::span<const WorldChange> changes) noexcept {
  SolverData& s = tables.view();
  const auto isOf = [](const WorldPart& part, int body) {
    return body >= part.firstBody && body < part.firstBody + part.bodies;
  };
  for (const WorldChange& change : changes) {
    const WorldPart& part = parts[static_cast<std::size_t>(change.world)];
    for (int k = s.oldPairOffset[part.firstBody]; k < s.oldPairOffset[part.firstBody + part.bodies]; ++k)
      forgetOldPair(s, k);
    for (int k = 0; s.vertices > 0 && k < s.oldPointPairOffset[s.owners()]; ++k) {
      const int owner = s.oldPointPair[k].vertex, corners = s.vertices + s.edges;
      const bool own = owner < s.vertices ? s.worldOfVertex[owner] == change.world
                       : owner < corners  ? owner - s.vertices >= part.firstEdge &&
                                               owner - s.vertices < part.firstEdge + part.edges
                                         : isOf(part, bodyOfOwner(s, owner));
      if (own) s.oldPointPair[k].other = -1, s.oldPointContact[k].active = 0;
    }
    readElements(s, part, change.state);
  }
  tables.trees.touchAll();
}

void putWorlds(HostTables& tables, std::span<const WorldPart> parts, std::span<const WorldChange> changes) {
  WorldsToPut(tables, parts, changes).put();
}

}  // namespace rubble::RUBBLE_CORE
