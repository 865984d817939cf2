#include "backend/cuda/mirror.h"

#include <algorithm>
#include <cstring>

namespace rubble::RUBBLE_CORE {

namespace {

bool kept(Life life) { return life == Life::Authored || life == Life::State; }

/// Arrays with one element a body, which an edit of that body writes. Offsets into other arrays are not among them.
template <class T>
bool perBody(const ArrayInfo<T>& array) {
  return array.per == Per::Body && array.extra == 0 && kept(array.life);
}

/// The arrays that BodyState is made of, and what follows from it.
template <class F>
void forEachStateArray(F&& f) {
  f(&View::position), f(&View::orientation), f(&View::velocity), f(&View::spin), f(&View::previousVelocity);
}

}  // namespace

/// Elements of many arrays on their way to the device: one copy, then one small kernel an array.
class Mirror::Packet {
 public:
  Packet(const View& host, const View& device) : host_(host), device_(device) {}

  /// From here on, elements of these slots.
  void setSlots(const std::vector<int>& slots) {
    slots_ = &slots;
    slotsAt_ = append(slots.data(), slots.size() * sizeof(int));
  }
  template <class T>
  void add(T* View::*array) {
    static_assert(sizeof(T) % sizeof(int) == 0 && alignof(T) <= kAlign);
    const std::size_t at = append(nullptr, slots_->size() * sizeof(T));
    for (std::size_t k = 0; k < slots_->size(); ++k)
      std::memcpy(bytes_.data() + at + k * sizeof(T), host_.*array + (*slots_)[k], sizeof(T));
    pieces_.push_back({device_.*array, slotsAt_, at, static_cast<int>(slots_->size()), sizeof(T)});
  }

  void send(DeviceBuffer& staging, cudaStream_t stream) const {
    if (pieces_.empty()) return;
    staging.reserve(bytes_.size());
    checkCuda(cudaMemcpyAsync(staging.data(), bytes_.data(), bytes_.size(), cudaMemcpyHostToDevice, stream), "cudaMemcpyAsync of edits");
    for (const Piece& p : pieces_)
      scatterElements(stream, p.to, staging.data() + p.at, reinterpret_cast<const int*>(staging.data() + p.slotsAt), p.count,
                      p.elementBytes);
  }

 private:
  static constexpr std::size_t kAlign = 64;
  struct Piece {
    void* to;
    std::size_t slotsAt, at;
    int count;
    std::size_t elementBytes;
  };

  std::size_t append(const void* from, std::size_t size) {
    const std::size_t at = (bytes_.size() + kAlign - 1) / kAlign * kAlign;
    bytes_.resize(at + size);
    if (from && size > 0) std::memcpy(bytes_.data() + at, from, size);
    return at;
  }

  const View& host_;
  const View& device_;
  const std::vector<int>* slots_ = nullptr;
  std::size_t slotsAt_ = 0;
  std::vector<std::byte> bytes_;
  std::vector<Piece> pieces_;
};

void Mirror::mark(int slot, std::uint8_t bits) {
  std::uint8_t& b = bits_[static_cast<std::size_t>(slot)];
  if (b == 0) touched_.push_back(slot);
  b |= bits;
  if (bits & (kBody | kState)) b |= kKnown;
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
  listsDirty_ = true;
  if (addedFrom_ < 0) addedFrom_ = before;
  for (int i = before; i < after; ++i) mark(i, kBody);
}

void Mirror::jointWritten(int type, int slot) { joints_[type].push_back(slot); }

void Mirror::allWritten() {
  bits_.assign(static_cast<std::size_t>(host_.view().bodies), 0);
  touched_.clear();
  forgotten_.clear();
  for (std::vector<int>& slots : joints_) slots.clear();
  addedFrom_ = -1;
  allDirty_ = true;
  listsDirty_ = statesOld_ = restOld_ = false;
}

void Mirror::forgetContacts(int slot) {
  if (allDirty_) {
    RUBBLE_CORE::forgetContacts(host_, slot);
    return;
  }
  // the manifolds may lie on the device only
  forgotten_.push_back(slot);
  restOld_ = true;
}

int Mirror::liveCount(Per per) const {
  const View& s = host_.view();
  const int joint = static_cast<int>(per) - static_cast<int>(Per::Ball);
  if (joint >= 0 && joint < JointTypes::kSize) return s.joints[joint];
  switch (per) {
    case Per::Body:
      return s.bodies;
    case Per::Pair:
      return allDirty_ ? s.oldPairOffset[s.bodies] : s.counters->pairs;
    case Per::Manifold:
      return s.counters->manifolds;
    case Per::Plane:
      return s.planes;
    case Per::Exclusion:
      return s.exclusionOffset[s.bodies];
    default:
      return std::min(host_.capacity(per), stepper_.tables().capacity(per));
  }
}

void Mirror::reserveDevice() {
  for (int k = 0; k < kPerCount; ++k) {
    const Per per = static_cast<Per>(k);
    // the room for what the device counts is found by the steps
    if (!stepper_.counted(per)) stepper_.tables().reserve(per, host_.capacity(per));
  }
}

void Mirror::flush() {
  reserveDevice();
  if (allDirty_) {
    sendAll();
    return;
  }
  const View& device = stepper_.tables().view();
  if (addedFrom_ >= 0) startPairOffsets(stepper_.stream(), device, addedFrom_, host_.view().bodies);
  addedFrom_ = -1;
  if (listsDirty_) sendLists();
  Packet packet(host_.view(), device);
  sendBodies(packet);
  sendJoints(packet);
  packet.send(staging_, stepper_.stream());

  if (forgotten_.empty()) return;
  std::sort(forgotten_.begin(), forgotten_.end());
  staging_.reserve(forgotten_.size() * sizeof(int));
  checkCuda(cudaMemcpyAsync(staging_.data(), forgotten_.data(), forgotten_.size() * sizeof(int), cudaMemcpyHostToDevice, stepper_.stream()),
            "cudaMemcpyAsync of removals");
  forgetContactsOf(stepper_.stream(), device, reinterpret_cast<const int*>(staging_.data()), static_cast<int>(forgotten_.size()),
                   liveCount(Per::Pair));
  forgotten_.clear();
}

void Mirror::sendAll() {
  stepper_.tables().reserve(Per::Pair, liveCount(Per::Pair));
  stepper_.tables().reserve(Per::Manifold, liveCount(Per::Manifold));
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (!kept(array.life)) return;
    const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(liveCount(array.per) + array.extra);
    checkCuda(cudaMemcpyAsync(stepper_.tables().view().*array.member, host_.view().*array.member, bytes, cudaMemcpyHostToDevice,
                              stepper_.stream()),
              "cudaMemcpyAsync of tables");
  });
  host_.view().counters->pairs = liveCount(Per::Pair);
  allWritten();
  allDirty_ = false;
  // forces end with the next step: remember who has one
  const View& s = host_.view();
  const Vec3 none{0, 0, 0};
  for (int i = 0; i < s.bodies; ++i)
    if (s.force[i] != none || s.torque[i] != none) mark(i, kPushed);
}

/// Authored arrays that are not edited element by element: planes, exclusions and their offsets.
void Mirror::sendLists() {
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (array.life != Life::Authored || perBody(array)) return;
    const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(liveCount(array.per) + array.extra);
    checkCuda(cudaMemcpyAsync(stepper_.tables().view().*array.member, host_.view().*array.member, bytes, cudaMemcpyHostToDevice,
                              stepper_.stream()),
              "cudaMemcpyAsync of lists");
  });
  listsDirty_ = false;
}

void Mirror::sendBodies(Packet& packet) {
  if (const std::vector<int> slots = slotsWith(kBody); !slots.empty()) {
    packet.setSlots(slots);
    forEachArray([&](const auto& array) {
      if (perBody(array)) packet.add(array.member);
    });
  }
  if (const std::vector<int> slots = slotsWith(kState); !slots.empty()) {
    packet.setSlots(slots);
    forEachStateArray([&](auto array) { packet.add(array); });
  }
  if (const std::vector<int> slots = slotsWith(kForce); !slots.empty()) {
    packet.setSlots(slots);
    packet.add(&View::force);
    packet.add(&View::torque);
  }
  for (const int slot : touched_) bits_[static_cast<std::size_t>(slot)] &= kKnown | kPushed;
}

void Mirror::sendJoints(Packet& packet) {
  forEachType(JointTypes{}, [&]<class F>() {
    std::vector<int>& slots = joints_[typeIndex<F>(JointTypes{})];
    if (slots.empty()) return;
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    packet.setSlots(slots);
    forEachArray([&]<class T>(const ArrayInfo<T>& array) {
      if constexpr (std::is_same_v<T, Joint<F>>) packet.add(array.member);
    });
    slots.clear();
  });
}

void Mirror::stepped(const Counters& counters) {
  View& s = host_.view();
  *s.counters = counters;
  for (const int slot : touched_) {
    if (bits_[static_cast<std::size_t>(slot)] & kPushed) s.force[slot] = s.torque[slot] = {0, 0, 0};
    bits_[static_cast<std::size_t>(slot)] = 0;
  }
  touched_.clear();
  statesOld_ = restOld_ = true;
  singleFetches_ = 0;
}

template <class T>
void Mirror::download(const ArrayInfo<T>& array, int count) {
  const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(count);
  checkCuda(
      cudaMemcpyAsync(host_.view().*array.member, stepper_.tables().view().*array.member, bytes, cudaMemcpyDeviceToHost, stepper_.stream()),
      "cudaMemcpyAsync to the host");
}

void Mirror::fetchStates() {
  flush();
  forEachStateArray([&]<class T>(T* View::*array) { download(ArrayInfo<T>{array, "", "", Per::Body, Life::State}, host_.view().bodies); });
  checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize");
  statesOld_ = false;
}

void Mirror::fetchState(int slot) {
  if (!statesOld_ || (bits_[static_cast<std::size_t>(slot)] & kKnown)) return;
  // one by one for a few bodies; who asks for more will ask for all
  constexpr int kMostSingle = 16;
  if (++singleFetches_ > kMostSingle) {
    fetchStates();
    return;
  }
  forEachStateArray([&]<class T>(T* View::*array) {
    checkCuda(cudaMemcpyAsync(host_.view().*array + slot, stepper_.tables().view().*array + slot, sizeof(T), cudaMemcpyDeviceToHost,
                              stepper_.stream()),
              "cudaMemcpyAsync of a body");
  });
  checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize");
  mark(slot, kKnown);
}

void Mirror::fetchAll() {
  if (!statesOld_ && !restOld_) return;
  flush();
  host_.reserve(Per::Pair, liveCount(Per::Pair));
  host_.reserve(Per::Manifold, liveCount(Per::Manifold));
  forEachArray([&](const auto& array) {
    if (array.life == Life::State) download(array, liveCount(array.per) + array.extra);
  });
  checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize");
  statesOld_ = restOld_ = false;
}

}  // namespace rubble::RUBBLE_CORE
