// Fetches device results, and performs edits on the device.
#include <cstring>

#include <algorithm>
#include <utility>

#include "backend/cuda/mirror.h"
#include "stages/pairs/order.h"

namespace rubble::RUBBLE_CORE {

void Mirror::stepped(const Counters& counters) {
  SolverData& s = host_.view();
  *s.counters = counters;
  for (const int slot : touched_) {
    if (bits_[static_cast<std::size_t>(slot)] & kPushed) s.force[slot] = s.torque[slot] = {0, 0, 0};
    bits_[static_cast<std::size_t>(slot)] = 0;
  }
  touched_.clear();
  for (const int v : forcedVertices_) s.vertexForce[v] = {0, 0, 0};
  forcedVertices_.clear();
  statesOld_ = verticesOld_ = restOld_ = true;
  forcesOnDevice_ = false;
  singleFetches_ = 0;
  worldsRead_.clear();
}

void Mirror::endForces() {
  if (!std::exchange(forced_, false)) return;
  const auto end = [&](Vec3* forces, int count) {
    checkCuda(cudaMemsetAsync(forces, 0, sizeof(Vec3) * static_cast<std::size_t>(count), stepper_.stream()),
              "cudaMemsetAsync of forces");
  };
  const SolverData& device = stepper_.tables().view();
  end(device.force, host_.view().bodies), end(device.torque, host_.view().bodies),
      end(device.vertexForce, host_.view().vertices);
}

void Mirror::fetchStates() {
  flush();
  forEachMotionArray([&]<class T>(Array<T> SolverData::*array) {
    download(ArrayInfo<T>{array, "", "", Per::Body, Lifetime::State}, host_.view().bodies);
  });
  checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize");
  statesOld_ = false;
}

void Mirror::fetchState(int slot) {
  const std::uint8_t bits = bits_[static_cast<std::size_t>(slot)];
  if (!statesOld_ || (bits & kKnown)) return;
  if (bits & kVelocityEdited) flush();
  // single bodies, until all of them at once cost less
  constexpr int kMostSingle = 16, kBodiesPerSingle = 1000;
  if (++singleFetches_ > std::max(kMostSingle, host_.view().bodies / kBodiesPerSingle)) return fetchStates();
  readMotion(stepper_.stream(), stepper_.tables().view(), slot, fetched_.get());
  checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize");
  const SolverData& s = host_.view();
  s.position[slot] = fetched_->position, s.orientation[slot] = fetched_->orientation;
  s.velocity[slot] = fetched_->velocity, s.angularVelocity[slot] = fetched_->angularVelocity;
  s.previousVelocity[slot] = fetched_->previousVelocity;
  s.asleep[slot] = fetched_->asleep, s.stillTime[slot] = fetched_->stillTime;
  mark(slot, kKnown);
}

void Mirror::fetchVertices() {
  if (!verticesOld_) return;
  flush();
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if constexpr (std::is_same_v<T, Vec3d> || std::is_same_v<T, Vec3>)
      if (array.per == Per::Vertex && array.life == Lifetime::State) download(array, host_.view().vertices);
  });
  checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize");
  verticesOld_ = false;
}

void Mirror::fetchAll() {
  if (!statesOld_ && !verticesOld_ && !restOld_) return;
  flush();
  host_.reserve(Per::Pair, liveCount(Per::Pair));
  host_.reserve(Per::ActivePair, liveCount(Per::ActivePair));
  host_.reserve(Per::Manifold, liveCount(Per::Manifold));
  host_.reserve(Per::PointPair, liveCount(Per::PointPair));
  host_.reserve(Per::Rolling, liveCount(Per::Rolling));
  fetchTargets();
  forEachArray([&](const auto& array) {
    if (array.life == Lifetime::State) download(array, liveCount(array.per) + array.extra);
  });
  checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize");
  statesOld_ = verticesOld_ = restOld_ = false;
  if (std::exchange(forcesOnDevice_, false)) noteForces();
}

void Mirror::fetchTargets() {
  if (!std::exchange(targetsOnDevice_, false)) return;
  forEachArray([&](const auto& array) {
    if (array.life == Lifetime::Authored && jointTypeOf(array.per) >= 0)
      download(array, liveCount(array.per));
  });
  checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize");
}

void Mirror::bodiesSorted() {
  SolverData& s = host_.view();
  // forces of the host are on the device, at the present places of their bodies
  for (const int slot : touched_) {
    forcesOnDevice_ |= (bits_[static_cast<std::size_t>(slot)] & kPushed) != 0;
    s.force[slot] = s.torque[slot] = {0, 0, 0};
    bits_[static_cast<std::size_t>(slot)] = 0;
  }
  touched_.clear();
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (array.life == Lifetime::Authored &&
        (followsBodies(array) || array.per == Per::Plane || jointTypeOf(array.per) >= 0))
      download(array, liveCount(array.per));
  });
  checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize");
  statesOld_ = restOld_ = true;
  authored_.reset();
  host_.trees.touchAll();
  s.ordered = inOtherOrder(s);
}

ArrayView Mirror::handOut(ArrayView view) {
  order_.handOut();
  view.device = true;
  view.stream = reinterpret_cast<std::uintptr_t>(stepper_.stream());
  return view;
}

ArrayView Mirror::array(StateArray which) {
  const SolverData& device = stepper_.tables().view();
  if (host_.view().ordered) return filled([&] { return byId_.view(which, device, host_.bodyIds, gather()); });
  flush();
  return handOut(withStateArray(which, [&](auto member) { return rowsOf(device.*member, host_.bodyIds); }));
}

ArrayView Mirror::array(VertexArray which) {
  flush();
  return handOut(rowsOf(which, present()));
}

void Mirror::followArrays() {
  if (host_.view().ordered) byId_.follow(stepper_.tables().view(), host_.bodyIds, gather());
}

void Mirror::addVelocity(int slot, const rubble::Vec3& change) {
  if (const std::uint8_t bits = bits_[static_cast<std::size_t>(slot)]; !statesOld_ || (bits & kKnown)) {
    RUBBLE_CORE::addVelocity(host_, slot, change);
    stateWritten(slot);
    return;
  } else if (bits & kVelocityEdited) {
    flush();  // one change per body and batch, so that changes add up in call order
  }
  mark(slot, kVelocityEdited);
  worldsRead_.clear();
  velocityEdits_.push_back(slot);
  velocityChanges_.push_back(change);
}

std::shared_ptr<const DeviceSnapshot> Mirror::snapshot(double previousDt) {
  flush();
  fetchTargets();
  const SnapshotSizes sizes = sizesOf(host_, liveCount(Per::Pair), liveCount(Per::ActivePair),
                                      liveCount(Per::Manifold));
  if (!authored_) authored_ = copyAuthored(host_, sizes);
  auto out = std::make_shared<DeviceSnapshot>(sizes, stepper_.tables().view(), authored_, stepper_.stream());
  out->counters = *host_.view().counters;
  out->previousDt = previousDt;
  out->hasForces = forcesOnDevice_;
  for (const int slot : touched_) out->hasForces |= (bits_[static_cast<std::size_t>(slot)] & kPushed) != 0;
  return out;
}

void Mirror::restore(const DeviceSnapshot& snapshot) {
  const StreamOrder::Writing writing(order_);
  SolverData& s = host_.view();
  for (const int slot : touched_) s.force[slot] = s.torque[slot] = {0, 0, 0};
  const bool sameAuthored = authored_ == snapshot.authored;
  adopt(host_, snapshot.sizes);
  if (!sameAuthored) putAuthored(host_, snapshot.sizes, *snapshot.authored);
  reserveDevice();
  stepper_.tables().reserve(Per::Pair, snapshot.sizes.pairs);
  stepper_.tables().reserve(Per::ActivePair, snapshot.sizes.activePairs);
  stepper_.tables().reserve(Per::Manifold, snapshot.sizes.manifolds);
  stepper_.tables().reserve(Per::Rolling, host_.rollingRows(snapshot.sizes.traits, snapshot.sizes.activePairs,
                                                            snapshot.sizes.rollers));
  snapshot.put(stepper_.tables().view(), stepper_.stream());
  allWritten();
  authored_ = snapshot.authored;
  allDirty_ = false;
  sentShapes_ = endOfShapes(host_);
  statesOld_ = restOld_ = true;
  forcesOnDevice_ = forced_ = snapshot.hasForces;
  *s.counters = snapshot.counters;
  s.ordered = inOtherOrder(s);
}

}  // namespace rubble::RUBBLE_CORE
