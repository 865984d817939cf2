#include "backend/cuda/device_snapshot.h"

#include <algorithm>
#include <cstring>

#include "backend/cpu/cpu_engine.h"

namespace rubble::RUBBLE_CORE {

namespace {

constexpr std::size_t kAlign = 64;

/// Calls visit(array, bytes, offset) for all arrays for which wanted(lifetime) holds, packed contiguously.
/// Returns the total number of bytes.
template <class Wanted, class Visit>
std::size_t forEachPart(const SnapshotSizes& sizes, Wanted&& wanted, Visit&& visit) {
  std::size_t at = 0;
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (!wanted(array.life)) return;
    const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(sizes.count(array.per) + array.extra);
    visit(array, bytes, at);
    at += (bytes + kAlign - 1) / kAlign * kAlign;
  });
  return at;
}
std::size_t keptBytes(const SnapshotSizes& sizes) {
  return forEachPart(sizes, isKept, [](const auto&, std::size_t, std::size_t) {});
}
bool isAuthored(Lifetime life) { return life == Lifetime::Authored; }

}  // namespace

int SnapshotSizes::count(Per per) const {
  if (const int type = jointTypeOf(per); type >= 0) return joints[type];
  switch (per) {
    case Per::Body:
      return bodies;
    case Per::Pair:
      return pairs;
    case Per::ActivePair:
      return activePairs;
    case Per::Manifold:
      return manifolds;
    case Per::Plane:
      return planes;
    case Per::Exclusion:
      return exclusions;
    case Per::ShapeVector:
      return shapeVectors;
    case Per::ShapeIndex:
      return shapeIndices;
    case Per::ShapePart:
      return shapeParts;
    case Per::Surface:
      return surfaces;
    case Per::Rolling:
      return rollers;
    default:
      return 0;
  }
}

SnapshotSizes sizesOf(const HostTables& tables, int pairs, int activePairs, int manifolds) {
  const SolverData& s = tables.view();
  SnapshotSizes sizes;
  sizes.bodies = s.bodies, sizes.planes = s.planes, sizes.exclusions = s.exclusions;
  sizes.excludedPairs = tables.excludedPairs;
  sizes.pairs = pairs, sizes.activePairs = activePairs, sizes.manifolds = manifolds;
  sizes.shapeVectors = tables.shapeVectors, sizes.shapeIndices = tables.shapeIndices,
  sizes.shapeParts = tables.shapeParts, sizes.surfaces = s.surfaces;
  sizes.traits = tables.traits(), sizes.rolledBefore = s.rolledBefore;
  sizes.oneWay = s.oneWay;
  sizes.rollers = s.rolledBefore ? s.counters->rollers : 0;
  std::copy(std::begin(s.joints), std::end(s.joints), sizes.joints);
  sizes.bodyIds = tables.bodyIds;
  std::copy(std::begin(tables.jointIds), std::end(tables.jointIds), sizes.jointIds);
  return sizes;
}

void adopt(HostTables& tables, const SnapshotSizes& sizes) {
  setBodyCount(tables, sizes.bodies);
  for (int t = 0; t < JointTypes::kSize; ++t) setJointCount(tables, t, sizes.joints[t]);
  tables.reserve(Per::Plane, sizes.planes);
  tables.reserve(Per::Exclusion, sizes.exclusions);
  tables.bodyIds = sizes.bodyIds, tables.view().bodies = sizes.bodies;
  std::copy(std::begin(sizes.jointIds), std::end(sizes.jointIds), tables.jointIds);
  tables.view().planes = sizes.planes;
  tables.view().exclusions = sizes.exclusions;
  tables.excludedPairs = sizes.excludedPairs;
  tables.trees.touchAll();
  tables.reserve(Per::ShapeVector, sizes.shapeVectors);
  tables.reserve(Per::ShapeIndex, sizes.shapeIndices);
  tables.reserve(Per::ShapePart, sizes.shapeParts);
  tables.reserve(Per::Surface, sizes.surfaces);
  tables.reserve(Per::Rolling, tables.rollingRows(sizes.traits, sizes.activePairs, sizes.rollers));
  SolverData& s = tables.view();
  tables.shapeVectors = sizes.shapeVectors, tables.shapeIndices = sizes.shapeIndices,
  tables.shapeParts = sizes.shapeParts, s.surfaces = sizes.surfaces;
  tables.setTraits(sizes.traits);
  s.rolledBefore = sizes.rolledBefore, s.oneWay = sizes.oneWay;
}

std::shared_ptr<const AuthoredBytes> copyAuthored(const HostTables& tables, const SnapshotSizes& sizes) {
  const SolverData& s = tables.view();
  auto out = std::make_shared<AuthoredBytes>();
  out->resize(forEachPart(sizes, isAuthored, [](const auto&, std::size_t, std::size_t) {}));
  forEachPart(sizes, isAuthored, [&](const auto& array, std::size_t bytes, std::size_t at) {
    if (bytes > 0) std::memcpy(out->data() + at, s.*array.member, bytes);
  });
  return out;
}

void putAuthored(HostTables& tables, const SnapshotSizes& sizes, const AuthoredBytes& from) {
  const SolverData& s = tables.view();
  forEachPart(sizes, isAuthored, [&](const auto& array, std::size_t bytes, std::size_t at) {
    if (bytes > 0) std::memcpy(s.*array.member, from.data() + at, bytes);
  });
}

void StateCopy::take(const SnapshotSizes& sizes, const SolverData& device, bool contactsOnly,
                     cudaStream_t stream) {
  const auto wanted = [&](Lifetime life) { return life == Lifetime::State; };
  const auto isTaken = [&]<class T>(const ArrayInfo<T>& array) {
    return !contactsOnly || !(isBodyState(array) || jointTypeOf(array.per) >= 0);
  };
  data_.reserve(forEachPart(sizes, wanted, [](const auto&, std::size_t, std::size_t) {}));
  forEachPart(sizes, wanted, [&]<class T>(const ArrayInfo<T>& array, std::size_t bytes, std::size_t at) {
    view_.*array.member = reinterpret_cast<T*>(data_.data() + at);
    if (bytes == 0 || !isTaken(array)) return;
    checkCuda(
        cudaMemcpyAsync(data_.data() + at, device.*array.member, bytes, cudaMemcpyDeviceToDevice, stream),
        "cudaMemcpyAsync of states");
  });
}

DeviceSnapshot::DeviceSnapshot(const SnapshotSizes& s, const SolverData& device,
                               std::shared_ptr<const AuthoredBytes> authoredBytes, cudaStream_t stream)
    : sizes(s), authored(std::move(authoredBytes)) {
  data_.reserveExactly(keptBytes(sizes));
  forEachPart(sizes, isKept, [&](const auto& array, std::size_t bytes, std::size_t at) {
    checkCuda(
        cudaMemcpyAsync(data_.data() + at, device.*array.member, bytes, cudaMemcpyDeviceToDevice, stream),
        "cudaMemcpyAsync of a snapshot");
  });
  made_.record(stream);
}

void DeviceSnapshot::put(const SolverData& device, cudaStream_t stream) const {
  made_.holdBack(stream);
  forEachPart(sizes, isKept, [&](const auto& array, std::size_t bytes, std::size_t at) {
    checkCuda(
        cudaMemcpyAsync(device.*array.member, data_.data() + at, bytes, cudaMemcpyDeviceToDevice, stream),
        "cudaMemcpyAsync of a snapshot");
  });
}

std::vector<std::byte> DeviceSnapshot::bytes() const {
  made_.wait();
  HostTables tables;
  adopt(tables, sizes);
  tables.reserve(Per::Pair, sizes.pairs);
  tables.reserve(Per::ActivePair, sizes.activePairs);
  tables.reserve(Per::Manifold, sizes.manifolds);
  *tables.view().counters = counters;
  forEachPart(sizes, isKept, [&](const auto& array, std::size_t bytes, std::size_t at) {
    checkCuda(cudaMemcpy(tables.view().*array.member, data_.data() + at, bytes, cudaMemcpyDeviceToHost),
              "cudaMemcpy of a snapshot");
  });
  return saveState(tables, previousDt);
}

}  // namespace rubble::RUBBLE_CORE
