#include "backend/cuda/mirror.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace rubble::RUBBLE_CORE {

namespace {

/// Arrays with one element per body that an edit of that body writes. Offsets into other arrays are not
/// included.
template <class T> bool perBody(const ArrayInfo<T>& array) {
  return array.per == Per::Body && array.extra == 0 && isKept(array.life);
}

}  // namespace

void Mirror::mark(int slot, std::uint8_t bits) {
  std::uint8_t& b = bits_[static_cast<std::size_t>(slot)];
  if (b == 0) touched_.push_back(slot);
  b |= bits;
  edited_ |= (bits & (kBody | kState | kForce | kVelocityEdited)) != 0;
  if (bits & (kBody | kState)) b = static_cast<std::uint8_t>((b | kKnown) & ~kVelocityEdited);
  if (bits & kForce) b |= kPushed;
}

std::vector<int> Mirror::slotsWith(std::uint8_t bits) const {
  std::vector<int> slots;
  for (const int slot : touched_)
    if (bits_[static_cast<std::size_t>(slot)] & bits) slots.push_back(slot);
  return slots;
}

void Mirror::bodiesAdded(int before) {
  const int after = host_.view().bodies;
  if (after == before) return;
  bits_.resize(static_cast<std::size_t>(after));
  authored_.reset();
  if (addedFrom_ < 0) addedFrom_ = before;
  for (int i = before; i < after; ++i) mark(i, kBody), trees_.bodies.push_back(i);
}

void Mirror::verticesWritten(int first, int count) {
  edited_ = true;
  for (int v = first; v < first + count; ++v) {
    movedVertices_.push_back(v);
    if (host_.view().vertexParams[v].kind == VertexKind::Dynamic) dynamicVertices_.push_back(v);
  }
}

void Mirror::jointWritten(int type, int slot) {
  joints_[type].push_back(slot);
  specWritten(type, slot);
}
void Mirror::specWritten(int type, int slot) {
  specs_[type].push_back(slot);
  authored_.reset();
}

void Mirror::allWritten() {
  bits_.assign(static_cast<std::size_t>(host_.view().bodies), 0);
  touched_.clear();
  forgotten_.clear();
  for (std::vector<int>& slots : joints_) slots.clear();
  for (std::vector<int>& slots : specs_) slots.clear();
  velocityEdits_.clear(), velocityChanges_.clear();
  addedFrom_ = -1;
  allDirty_ = true;
  authored_.reset();
  std::fill(std::begin(resend_), std::end(resend_), false);
  trees_ = {};
  exclusions_.clear();
  movedVertices_.clear(), dynamicVertices_.clear(), forcedVertices_.clear();
  worldsRead_.clear();
  targetsOnDevice_ = false;
  statesOld_ = verticesOld_ = restOld_ = forcesOnDevice_ = false;
}

void Mirror::forgetContacts(std::span<const int> ids) {
  if (allDirty_) return RUBBLE_CORE::forgetContacts(host_, ids);
  // the manifolds may exist on the device only
  for (const int id : ids) forgotten_.push_back(slotOf(host_, id));
  worldsRead_.clear();
  restOld_ = true;
}

int Mirror::liveCount(Per per) const {
  const SolverData& s = host_.view();
  if (const int type = jointTypeOf(per); type >= 0) return s.joints[type];
  if (per >= Per::FirstElement) return static_cast<int>(elementCount(s, per));
  switch (per) {
    case Per::Body:
      return s.bodies;
    case Per::Pair:
      return allDirty_ ? s.oldPairOffset[s.bodies] : s.counters->pairs;
    case Per::ActivePair:
      return s.counters->activePairs;
    case Per::Manifold:
      return s.counters->manifolds;
    case Per::Plane:
      return s.planes;
    case Per::World:
      return s.worlds;
    case Per::ShapeVector:
      return host_.shapeVectors;
    case Per::ShapeIndex:
      return host_.shapeIndices;
    case Per::ShapePart:
      return host_.shapeParts;
    case Per::Surface:
      return s.surfaces;
    case Per::MaterialRule:
      return s.materialRules;
    case Per::Rolling:
      return s.rolledBefore ? s.counters->rollers : 0;
    case Per::Exclusion:
      return s.exclusions;
    case Per::Vertex:
      return s.vertices;
    case Per::PointOwner:
      return s.owners();
    case Per::Feature:
      return s.features;
    case Per::ElementRef:
      return s.refOffset[s.vertices];
    case Per::TetraCorner:
      return s.tetraCornerOffset[s.vertices];
    case Per::Neighbor:
      return s.neighborOffset[s.vertices];
    case Per::Cluster:
      return s.clusterBegin[kClusterLevels];
    case Per::ClusterRef:
      return s.clusterRefs;
    case Per::SoftNode:
      return s.softNodes;
    case Per::Strand:
      return s.strands;
    case Per::StrandVertex:
      return s.strandVertices;
    case Per::Attachment:
      return s.attachments;
    case Per::TreeNode:
      return s.treeNodes;
    case Per::TreeChild:
      return 2 * s.treeNodes;
    case Per::SmallTree:
      return s.smallTrees;
    case Per::PointPair:
      return allDirty_ ? s.oldPointPairOffset[s.owners()] : s.counters->pointPairs;
    default:
      return std::min(host_.capacity(per), stepper_.tables().capacity(per));
  }
}

void Mirror::reserveDevice() {
  for (int k = 0; k < kPerCount; ++k) {
    const Per per = static_cast<Per>(k);
    // the steps determine the capacity of kinds that the device counts
    if (!stepper_.counted(per)) stepper_.tables().reserve(per, host_.capacity(per));
  }
}

void Mirror::flush() {
  std::optional<StreamOrder::Writing> writing;
  if (edited_ || allDirty_) writing.emplace(order_);
  edited_ = false;
  reserveDevice();
  // as many old rolling rows as old manifolds, also in the first step with such materials
  if (host_.view().rolls)
    stepper_.tables().reserve(Per::Rolling, stepper_.tables().capacity(Per::ActivePair));
  if (allDirty_) {
    sendAll();
    return;
  }
  const SolverData& device = stepper_.tables().view();
  if (addedFrom_ >= 0) {
    startPairOffsets(stepper_.stream(), device, addedFrom_, host_.view().bodies);
    const int owners = host_.view().owners();
    if (host_.view().features > 0)
      startCornerOffsets(stepper_.stream(), device,
                         owners - kCornerSlots * (host_.view().bodies - addedFrom_), owners);
  }
  addedFrom_ = -1;
  sendLists();
  sendShapes();
  sendEdits();
}

template <class T> void Mirror::upload(const ArrayInfo<T>& array, int first, int count) {
  checkCuda(
      cudaMemcpyAsync(stepper_.tables().view().*array.member + first, host_.view().*array.member + first,
                      sizeof(T) * static_cast<std::size_t>(count), cudaMemcpyHostToDevice, stepper_.stream()),
      "cudaMemcpyAsync of tables");
}

void Mirror::sendAll() {
  stepper_.tables().reserve(Per::Pair, liveCount(Per::Pair));
  stepper_.tables().reserve(Per::ActivePair, liveCount(Per::ActivePair));
  stepper_.tables().reserve(Per::Manifold, liveCount(Per::Manifold));
  stepper_.tables().reserve(Per::PointPair, liveCount(Per::PointPair));
  stepper_.tables().reserve(Per::Rolling, liveCount(Per::Rolling));
  forEachArray([&](const auto& array) {
    if (!isKept(array.life) && array.life != Lifetime::Derived && array.life != Lifetime::Batch) return;
    upload(array, 0, liveCount(array.per) + array.extra);
  });
  constants_.clear();
  resendPaused_ = false;
  host_.view().counters->pairs = liveCount(Per::Pair);
  host_.view().counters->pointPairs = liveCount(Per::PointPair);
  allWritten();
  allDirty_ = false;
  sentShapes_ = endOfShapes(host_);
  forced_ = true;
  noteForces();
}

/// Forces last until the next step: records the bodies that have one.
void Mirror::noteForces() {
  const SolverData& s = host_.view();
  const Vec3 none{0, 0, 0};
  for (int i = 0; i < s.bodies; ++i)
    if (s.force[i] != none || s.torque[i] != none) mark(i, kPushed);
}

/// Sends arrays of edits that are not edited element by element.
void Mirror::sendLists() {
  if (std::exchange(resendPaused_, false))
    upload(ArrayInfo<int>{&SolverData::paused, "", "", Per::World, Lifetime::Batch}, 0,
           liveCount(Per::World));
  if (std::find(std::begin(resend_), std::end(resend_), true) == std::end(resend_)) return;
  forEachArray([&](const auto& array) {
    if ((array.life == Lifetime::Authored || array.life == Lifetime::Batch) &&
        resend_[static_cast<int>(array.per)])
      upload(array, 0, liveCount(array.per) + array.extra);
  });
  std::fill(std::begin(resend_), std::end(resend_), false);
}

/// Sends the tables of shapes from the first new one on.
void Mirror::sendShapes() {
  const auto send = [&](Per per, int& sent, int now) {
    if (now == sent) return;
    forEachArray([&](const auto& array) {
      if (array.per == per) upload(array, sent, now - sent);
    });
    sent = now;
  };
  send(Per::ShapeVector, sentShapes_.vectors, host_.shapeVectors);
  send(Per::ShapeIndex, sentShapes_.indices, host_.shapeIndices);
  send(Per::ShapePart, sentShapes_.parts, host_.shapeParts);
}

void Mirror::addTrees(Packet& packet) {
  const auto add = [&](const std::vector<int>& slots, auto... arrays) {
    if (slots.empty()) return;
    packet.setSlots(slots);
    (packet.add(arrays), ...);
  };
  if (trees_.all || trees_.levels)
    forEachArray([&]<class T>(const ArrayInfo<T>& array) {
      if (array.life != Lifetime::Derived) return;
      if constexpr (std::is_same_v<T, int>)
        if (array.member == &SolverData::levelNode)
          return upload(array, 0, host_.view().levelBegin[kTreeLevels]);
      if (trees_.all) upload(array, 0, liveCount(array.per));
    });
  if (trees_.all) return;
  treeChildren_.clear();
  for (const int n : trees_.nodes) treeChildren_.push_back(2 * n), treeChildren_.push_back(2 * n + 1);
  add(trees_.bodies, &SolverData::nodeOfBody);
  add(trees_.nodes, &SolverData::treeNode, &SolverData::nodeLevel);
  add(treeChildren_, &SolverData::treeChild);
  add(trees_.smallTrees, &SolverData::smallTree);
}

void Mirror::addVertices(Packet& packet) {
  if (!movedVertices_.empty()) {
    packet.setSlots(movedVertices_);
    packet.add(&SolverData::vertexPosition);
  }
  if (!dynamicVertices_.empty()) {
    packet.setSlots(dynamicVertices_);
    packet.add(&SolverData::vertexVelocity);
    packet.add(&SolverData::vertexOldVelocity);
  }
  if (!forcedVertices_.empty()) {
    packet.setSlots(forcedVertices_);
    packet.add(&SolverData::vertexForce);
  }
}

/// Sends all element edits as one upload, with one kernel per kind of edit.
void Mirror::sendEdits() {
  const SolverData& device = stepper_.tables().view();
  const cudaStream_t stream = stepper_.stream();
  Packet packet(host_.view(), device);
  const std::vector<int> bodies = slotsWith(kBody), states = slotsWith(kState), forces = slotsWith(kForce);
  if (!bodies.empty()) {
    packet.setSlots(bodies);
    forEachArray([&](const auto& array) {
      if (perBody(array)) packet.add(array.member);
    });
  }
  const std::vector<int> params = slotsWith(kParams);
  if (!params.empty()) {
    packet.setSlots(params);
    forEachArray([&](const auto& array) {
      if (perBody(array) && array.life == Lifetime::Authored) packet.add(array.member);
    });
  }
  if (!states.empty()) {
    packet.setSlots(states);
    forEachMotionArray([&](auto array) { packet.add(array); });
  }
  if (!forces.empty()) {
    packet.setSlots(forces);
    packet.add(&SolverData::force);
    packet.add(&SolverData::torque);
  }
  addTrees(packet);
  addVertices(packet);
  if (!constants_.empty()) {
    packet.setSlots(constants_);
    packet.add(&SolverData::step);
  }
  if (!exclusions_.empty()) {
    packet.setSlots(exclusions_);
    packet.add(&SolverData::exclusion);
  }
  const auto inOrder = [](std::vector<int>& slots) {
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
  };
  for (std::vector<int>& slots : joints_) inOrder(slots);
  for (std::vector<int>& slots : specs_) inOrder(slots);
  forEachType(JointTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(JointTypes{});
    const auto send = [&](const std::vector<int>& slots, auto array) {
      if (slots.empty()) return;
      packet.setSlots(slots);
      packet.add(array);
    };
    send(joints_[kType], static_cast<Array<Joint<F>> SolverData::*>(&JointTable<F>::joint));
    send(specs_[kType], static_cast<Array<JointSpec<F>> SolverData::*>(&JointTable<F>::spec));
  });
  // a body that was set afterwards keeps the velocity of that call
  std::size_t kept = 0;
  for (std::size_t k = 0; k < velocityEdits_.size(); ++k) {
    if (!(bits_[static_cast<std::size_t>(velocityEdits_[k])] & kVelocityEdited)) continue;
    velocityEdits_[kept] = velocityEdits_[k], velocityChanges_[kept++] = velocityChanges_[k];
  }
  velocityEdits_.resize(kept), velocityChanges_.resize(kept);
  std::sort(forgotten_.begin(), forgotten_.end());

  std::size_t editedAt = 0, changesAt = 0, forgottenAt = 0;
  if (kept > 0) editedAt = packet.append(velocityEdits_), changesAt = packet.append(velocityChanges_);
  if (!forgotten_.empty()) forgottenAt = packet.append(forgotten_);
  if (const std::byte* const sent = packet.send(upload_, stream)) {
    const auto at = [&]<class T>(std::size_t place, const std::vector<T>&) {
      return reinterpret_cast<const T*>(sent + place);
    };
    if (kept > 0)
      addVelocities(stream, device, at(editedAt, velocityEdits_), at(changesAt, velocityChanges_),
                    static_cast<int>(kept));
    if (!forgotten_.empty()) {
      forgetContactsOf(stream, device, at(forgottenAt, forgotten_), static_cast<int>(forgotten_.size()),
                       liveCount(Per::Pair));
      forgetVertexContactsOf(stream, device, at(forgottenAt, forgotten_), static_cast<int>(forgotten_.size()),
                             liveCount(Per::PointPair));
    }
  }
  for (const int slot : touched_) bits_[static_cast<std::size_t>(slot)] &= kKnown | kPushed;
  for (std::vector<int>& slots : joints_) slots.clear();
  for (std::vector<int>& slots : specs_) slots.clear();
  velocityEdits_.clear(), velocityChanges_.clear(), forgotten_.clear();
  trees_ = {};
  exclusions_.clear(), movedVertices_.clear(), dynamicVertices_.clear(), constants_.clear();
}

}  // namespace rubble::RUBBLE_CORE
