#include "tables/clean_copy.h"
#include "tables/exclusions.h"
#include "tables/shape_edit.h"
#include "tables/soft_edit.h"

#include <algorithm>

namespace rubble::RUBBLE_CORE {

namespace {

/// Number of persistent elements of an array.
std::size_t liveCount(const HostTables& tables, Per per) {
  const SolverData& s = tables.view();
  if (const int type = jointTypeOf(per); type >= 0) return static_cast<std::size_t>(tables.jointIds[type]);
  switch (per) {
    case Per::Body:
      return static_cast<std::size_t>(tables.bodyIds);
    case Per::Pair:
      return static_cast<std::size_t>(s.oldPairOffset[tables.bodyIds]);
    case Per::ActivePair:
      return static_cast<std::size_t>(s.counters->activePairs);
    case Per::Manifold:
      return static_cast<std::size_t>(s.counters->manifolds);
    case Per::Plane:
      return static_cast<std::size_t>(s.planes);
    case Per::Exclusion:
      return static_cast<std::size_t>(tables.excludedPairs);
    case Per::ShapeVector:
      return static_cast<std::size_t>(tables.shapeVectors);
    case Per::ShapeIndex:
      return static_cast<std::size_t>(tables.shapeIndices);
    case Per::ShapePart:
      return static_cast<std::size_t>(tables.shapeParts);
    case Per::Surface:
      return static_cast<std::size_t>(s.surfaces);
    // as the last step left them: materials and pair rules may have changed since
    case Per::Rolling:
      return s.rolledBefore ? static_cast<std::size_t>(s.counters->rollers) : 0;
    case Per::Vertex:
      return static_cast<std::size_t>(s.vertices);
    case Per::PointOwner:
      return static_cast<std::size_t>(ownersOf(s, tables.bodyIds));
    case Per::Feature:
      return static_cast<std::size_t>(s.features);
    case Per::ElementRef:
      return static_cast<std::size_t>(s.refOffset[s.vertices]);
    case Per::TetraCorner:
      return static_cast<std::size_t>(s.tetraCornerOffset[s.vertices]);
    case Per::Neighbor:
      return static_cast<std::size_t>(s.neighborOffset[s.vertices]);
    case Per::PointPair:
      return static_cast<std::size_t>(s.oldPointPairOffset[ownersOf(s, tables.bodyIds)]);
    case Per::Cluster:
      return static_cast<std::size_t>(s.clusterBegin[kClusterLevels]);
    case Per::ClusterRef:
      return static_cast<std::size_t>(s.clusterRefs);
    case Per::SoftNode:
      return static_cast<std::size_t>(s.softNodes);
    case Per::Strand:
      return static_cast<std::size_t>(s.strands);
    case Per::StrandVertex:
      return static_cast<std::size_t>(s.strandVertices);
    case Per::Attachment:
      return static_cast<std::size_t>(s.attachments);
    default:
      return elementCount(s, per);
  }
}

// Excluded pairs are saved as offsets by the lower id, then the higher ids: the place of a pair in the hash
// table depends on the edits that led there.
template <class T> constexpr bool isExclusions = std::is_same_v<T, ExcludedPair>;
std::size_t exclusionBytes(const HostTables& tables) {
  return sizeof(int) * static_cast<std::size_t>(tables.bodyIds + 1 + tables.excludedPairs);
}
void saveExclusions(const HostTables& tables, std::byte* to) {
  const std::vector<ExcludedPair> pairs = excludedPairs(tables.view());
  std::vector<int> out;
  for (int id = 0, k = 0; id <= tables.bodyIds; ++id) {
    while (k < tables.excludedPairs && pairs[static_cast<std::size_t>(k)].low < id) ++k;
    out.push_back(k);
  }
  for (const ExcludedPair& pair : pairs) out.push_back(pair.high);
  std::memcpy(to, out.data(), exclusionBytes(tables));
}
void readExclusions(HostTables& tables, const std::byte* from) {
  const auto number = [from](int k) {
    int out;
    std::memcpy(&out, from + sizeof out * static_cast<std::size_t>(k), sizeof out);
    return out;
  };
  clearExclusions(tables, tables.excludedPairs);
  for (int id = 0; id < tables.bodyIds; ++id)
    for (int k = number(id); k < number(id + 1); ++k)
      setExcluded(tables, id, number(tables.bodyIds + 1 + k), true);
}

template <class Visit> void forEachKept(const HostTables& tables, Visit&& visit) {
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (!isKept(array.life)) return;
    const std::size_t count = liveCount(tables, array.per) + static_cast<std::size_t>(array.extra);
    visit(array, isExclusions<T> ? exclusionBytes(tables) : sizeof(T) * count);
  });
}

struct SavedCounts {
  int bodies, planes, pairs, activePairs, manifolds, exclusions;
  int shapeVectors, shapeIndices, shapeParts, surfaces, rolledBefore, rollers;
  TraitCounts traits;
  int joints[JointTypes::kSize];
  int pointPairs;
  SoftCounts soft;
};

/// Kinds of elements of deformable objects, and of what refers to them.
bool isSoft(Per per) {
  switch (per) {
    case Per::Vertex:
    case Per::PointOwner:
    case Per::Feature:
    case Per::ElementRef:
    case Per::TetraCorner:
    case Per::Neighbor:
    case Per::PointPair:
    case Per::Cluster:
    case Per::ClusterRef:
    case Per::SoftNode:
    case Per::Strand:
    case Per::StrandVertex:
    case Per::Attachment:
      return true;
    default:
      return per >= Per::FirstElement && per < Per::FirstJoint;
  }
}
/// The arrays of those kinds that are valid between steps.
template <class Visit> void forEachSoftArray(Visit&& visit) {
  forEachArray([&](const auto& array) {
    const bool lasts = array.life != Lifetime::Work && array.life != Lifetime::Unordered;
    if (lasts && isSoft(array.per) && !array.aliases) visit(array);
  });
}

}  // namespace

SoftBackup::SoftBackup(const HostTables& tables) : view_(tables.view()) {
  std::size_t all = 0;
  forEachSoftArray([&]<class T>(const ArrayInfo<T>& array) {
    sizes_.push_back(sizeof(T) * (liveCount(tables, array.per) + static_cast<std::size_t>(array.extra)));
    all += sizes_.back();
  });
  bytes_.resize(all);
  std::byte* to = bytes_.data();
  auto size = sizes_.begin();
  forEachSoftArray([&](const auto& array) {
    if (*size > 0) std::memcpy(to, view_.*array.member, *size);
    to += *size++;
  });
}

void SoftBackup::restore(HostTables& tables) const noexcept {
  SolverData before = view_;
  // arrays may have moved
  forEachArray([&](const auto& array) { before.*array.member = tables.view().*array.member; });
  tables.view() = before;
  const std::byte* from = bytes_.data();
  auto size = sizes_.begin();
  forEachSoftArray([&](const auto& array) {
    if (*size > 0) std::memcpy(before.*array.member, from, *size);
    from += *size++;
  });
}

std::vector<std::byte> saveTables(const HostTables& tables) {
  const SolverData& s = tables.view();
  SavedCounts counts{tables.bodyIds,
                     s.planes,
                     static_cast<int>(liveCount(tables, Per::Pair)),
                     s.counters->activePairs,
                     s.counters->manifolds,
                     static_cast<int>(liveCount(tables, Per::Exclusion)),
                     tables.shapeVectors,
                     tables.shapeIndices,
                     tables.shapeParts,
                     s.surfaces,
                     s.rolledBefore,
                     static_cast<int>(liveCount(tables, Per::Rolling)),
                     tables.traits(),
                     {},
                     static_cast<int>(liveCount(tables, Per::PointPair)),
                     softCounts(s)};
  std::copy(std::begin(tables.jointIds), std::end(tables.jointIds), counts.joints);
  std::size_t size = sizeof counts;
  forEachKept(tables, [&](const auto&, std::size_t bytes) { size += bytes; });
  std::vector<std::byte> out(size);
  std::byte* to = out.data();
  const auto put = [&](const void* from, std::size_t bytes) {
    if (bytes > 0) std::memcpy(to, from, bytes);
    to += bytes;
  };
  put(&counts, sizeof counts);
  forEachKept(tables, [&]<class T>(const ArrayInfo<T>& array, std::size_t bytes) {
    if constexpr (isExclusions<T>)
      saveExclusions(tables, to);
    else
      copyClean(to, static_cast<const T*>(s.*array.member), bytes);
    to += bytes;
  });
  return out;
}

std::vector<TableHash> hashTables(const HostTables& tables,
                                  std::uint64_t (*hash)(std::span<const std::byte>)) {
  std::vector<TableHash> out;
  std::vector<std::byte> content;
  forEachKept(tables, [&]<class T>(const ArrayInfo<T>& array, std::size_t bytes) {
    content.resize(bytes);
    if constexpr (isExclusions<T>)
      saveExclusions(tables, content.data());
    else
      copyClean(content.data(), static_cast<const T*>(tables.view().*array.member), bytes);
    const std::string name = jointTypeOf(array.per) >= 0 ? std::string("joint ") + array.name : array.name;
    out.push_back({array.life == Lifetime::Authored ? "authored " + name : name, hash(content)});
  });
  return out;
}

namespace {
void reserve(HostTables& tables, const SavedCounts& counts) {
  reserveBodies(tables, counts.bodies);
  for (int t = 0; t < JointTypes::kSize; ++t) tables.reserve(perJoint(t), slotsFor(counts.joints[t]));
  tables.reserve(Per::Pair, counts.pairs);
  tables.reserve(Per::ActivePair, counts.activePairs);
  tables.reserve(Per::Manifold, counts.manifolds);
  tables.reserve(Per::Plane, counts.planes);
  reserveSoft(tables, counts.soft, std::max(tables.view().bodies, slotsFor(counts.bodies)));
  tables.reserve(Per::PointPair, counts.pointPairs);
  reserveLoadedExclusions(tables, counts.exclusions);
  tables.reserve(Per::ShapeVector, counts.shapeVectors);
  tables.reserve(Per::ShapeIndex, counts.shapeIndices);
  tables.reserve(Per::ShapePart, counts.shapeParts);
  tables.reserve(Per::Surface, counts.surfaces);
  tables.reserve(Per::Rolling, tables.rollingRows(counts.traits, counts.activePairs, counts.rollers));
}
}  // namespace

void loadTables(HostTables& tables, std::span<const std::byte> data) {
  SavedCounts counts;
  std::memcpy(&counts, data.data(), sizeof counts);
  reserve(tables, counts);
  reloadTables(tables, data);
}

void reloadTables(HostTables& tables, std::span<const std::byte> data) {
  SavedCounts counts;
  std::memcpy(&counts, data.data(), sizeof counts);
  setBodyCount(tables, counts.bodies);
  for (int t = 0; t < JointTypes::kSize; ++t) setJointCount(tables, t, counts.joints[t]);
  setSoftCounts(tables, counts.soft);
  SolverData& s = tables.view();
  tables.bodyIds = counts.bodies;
  s.bodies = slotsFor(counts.bodies);
  s.planes = counts.planes;
  tables.trees.touchAll();
  tables.shapeVectors = counts.shapeVectors, tables.shapeIndices = counts.shapeIndices,
  tables.shapeParts = counts.shapeParts;
  s.surfaces = counts.surfaces;
  tables.setTraits(counts.traits);
  s.rolledBefore = counts.rolledBefore != 0;
  s.counters->rollers = counts.rollers;
  s.counters->activePairs = counts.activePairs;
  s.counters->manifolds = counts.manifolds;
  // sizes of later arrays depend on these
  s.oldPairOffset[counts.bodies] = counts.pairs;
  tables.excludedPairs = counts.exclusions;
  s.oldPointPairOffset[ownersOf(s, counts.bodies)] = counts.pointPairs;
  const std::byte* from = data.data() + sizeof counts;
  forEachKept(tables, [&]<class T>(const ArrayInfo<T>& array, std::size_t bytes) {
    if constexpr (isExclusions<T>)
      readExclusions(tables, from);
    else if (bytes > 0)
      std::memcpy(s.*array.member, from, bytes);
    from += bytes;
  });
  clearBodySlots(tables, counts.bodies);
  s.ordered = inOtherOrder(s);
  countYielding(s);
  findOneWay(s);
}

}  // namespace rubble::RUBBLE_CORE
