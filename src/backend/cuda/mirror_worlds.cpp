// Single worlds of a batch on the device: reads, replacements, and those that are left out of a step.
#include <algorithm>
#include <cstring>
#include <utility>

#include "backend/cuda/mirror.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Lists of contacts, packed for one upload.
class ContactPacket {
 public:
  ContactPacket(const BodyContacts& contacts, std::span<const int> firstInB) : contacts_(contacts) {
    const auto offsets = [](const std::vector<int>& counts) {
      std::vector<int> out{0};
      for (const int count : counts) out.push_back(out.back() + count);
      return out;
    };
    pairOffset_ = offsets(contacts.pairsOfBody), activeOffset_ = offsets(contacts.activeOfPair);
    firstAt_ = add(firstInB);
    pairOffsetAt_ = add(std::span(std::as_const(pairOffset_)));
    activeOffsetAt_ = add(std::span(std::as_const(activeOffset_)));
    pairAt_ = add(std::span(contacts.pair)), testAt_ = add(std::span(contacts.test));
    manifoldAt_ = add(std::span(contacts.manifold)), rowAt_ = add(std::span(contacts.row));
    // contacts without memory of rolling begin it anew
    rolling_ = contacts.rolling;
    if (!rolling_.empty()) rolling_.resize(contacts.manifold.size(), RollingRows{});
    rollingAt_ = add(std::span(std::as_const(rolling_)));
  }

  bool hasRolling() const { return !rolling_.empty(); }
  /// Sends everything. The addresses are valid until the next upload.
  ContactTables send(Upload& upload, cudaStream_t stream, const int*& firstInB) const {
    std::byte* const to = upload.begin(bytes_);
    for (const Part& part : parts_)
      if (part.bytes > 0) std::memcpy(to + part.at, part.from, part.bytes);
    const std::byte* const sent = upload.send(stream);
    const auto at = [&]<class T>(std::size_t place, const T*) {
      return reinterpret_cast<const T*>(sent + place);
    };
    firstInB = at(firstAt_, firstInB);
    return {at(pairOffsetAt_, pairOffset_.data()),
            at(pairAt_, contacts_.pair.data()),
            at(testAt_, contacts_.test.data()),
            at(activeOffsetAt_, activeOffset_.data()),
            at(manifoldAt_, contacts_.manifold.data()),
            at(rowAt_, contacts_.row.data()),
            hasRolling() ? at(rollingAt_, rolling_.data()) : nullptr};
  }

 private:
  struct Part {
    const void* from;
    std::size_t at, bytes;
  };
  template <class T> std::size_t add(std::span<const T> list) {
    constexpr std::size_t kAlign = 64;
    const std::size_t at = (bytes_ + kAlign - 1) / kAlign * kAlign;
    parts_.push_back({list.data(), at, list.size_bytes()});
    bytes_ = at + list.size_bytes();
    return at;
  }

  const BodyContacts& contacts_;
  std::vector<int> pairOffset_, activeOffset_;
  std::vector<RollingRows> rolling_;
  std::vector<Part> parts_;
  std::size_t bytes_ = 0;
  std::size_t firstAt_, pairOffsetAt_, activeOffsetAt_, pairAt_, testAt_, manifoldAt_, rowAt_, rollingAt_;
};

}  // namespace

void Mirror::fetchWorld(int world, const WorldPart& part) {
  if (!statesOld_ && !verticesOld_ && !restOld_) return;
  if (std::ranges::find(worldsRead_, world) != worldsRead_.end()) return;
  // single worlds, until all of them at once cost less
  constexpr std::size_t kMostSingle = 16;
  if (host_.view().vertices > 0 || worldsRead_.size() >= kMostSingle) return fetchAll();
  flush();
  const auto wait = [&] { checkCuda(cudaStreamSynchronize(stepper_.stream()), "cudaStreamSynchronize"); };
  for (const Per per : {Per::Pair, Per::ActivePair, Per::Manifold, Per::Rolling})
    host_.reserve(per, liveCount(per));
  const SolverData& s = host_.view();
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    const int type = jointTypeOf(array.per);
    const bool isTarget = targetsOnDevice_ && type >= 0 && array.life == Lifetime::Authored;
    if (array.life != Lifetime::State && !isTarget) return;
    if (array.per == Per::Body) download(array, part.firstBody, part.bodies + array.extra);
    if (type < 0) return;
    // runs of consecutive slots
    const std::vector<int>& slots = part.joints[type];
    for (std::size_t k = 0, end = 0; k < slots.size(); k = end) {
      while (end < slots.size() && slots[end] - slots[k] == static_cast<int>(end - k)) ++end;
      download(array, slots[k], static_cast<int>(end - k));
    }
  });
  wait();
  const int pairs = s.oldPairOffset[part.firstBody],
            pairCount = s.oldPairOffset[part.firstBody + part.bodies] - pairs;
  if (pairCount > 0) {
    forEachArray([&]<class T>(const ArrayInfo<T>& array) {
      if (array.life == Lifetime::State && array.per == Per::Pair)
        download(array, pairs, pairCount + array.extra);
    });
    wait();
    const int first = s.oldActivePairOffset[pairs], count = s.oldActivePairOffset[pairs + pairCount] - first;
    forEachArray([&]<class T>(const ArrayInfo<T>& array) {
      if (array.life != Lifetime::State || count == 0) return;
      if (array.per == Per::ActivePair || (array.per == Per::Rolling && liveCount(Per::Rolling) > 0))
        download(array, first, count);
    });
    wait();
    // rows are in the order of their manifolds
    int row = -1, rows = 0;
    for (int k = first; k < first + count; ++k)
      if (s.oldManifold[k].row >= 0) row = row < 0 ? s.oldManifold[k].row : row, ++rows;
    if (rows > 0) {
      download(ArrayInfo<ContactRows>{&SolverData::contact, "", "", Per::Manifold, Lifetime::State}, row,
               rows);
      wait();
    }
  }
  const Vec3 none{0, 0, 0};
  for (int i = part.firstBody; i < part.firstBody + part.bodies; ++i)
    if (s.force[i] != none || s.torque[i] != none) mark(i, kPushed);
  worldsRead_.push_back(world);
}

void Mirror::worldsWritten(std::span<const WorldPart> parts, std::span<const WorldChange> changes,
                           const BodyContacts& contacts) {
  const SolverData& s = host_.view();
  const Vec3 none{0, 0, 0};
  std::vector<int> firstInB(parts.size(), -1);
  int bodies = 0;
  for (const WorldChange& change : changes) {
    const WorldPart& part = parts[static_cast<std::size_t>(change.world)];
    firstInB[static_cast<std::size_t>(change.world)] = bodies;
    bodies += part.bodies;
    for (int i = part.firstBody; i < part.firstBody + part.bodies; ++i) {
      bodyWritten(i);
      if (s.force[i] != none || s.torque[i] != none) forceWritten(i);
    }
    for (int type = 0; type < JointTypes::kSize; ++type)
      for (const int slot : part.joints[type]) jointWritten(type, slot);
  }
  const ContactPacket packet(contacts, firstInB);
  if (packet.hasRolling()) host_.view().rolledBefore = true;
  const int* sentFirst = nullptr;
  const ContactTables sent = packet.send(upload_, stepper_.stream(), sentFirst);
  splice(sent, sentFirst);
}

void Mirror::splice(const ContactTables& b, const int* firstInB) {
  const cudaStream_t stream = stepper_.stream();
  SolverData& s = host_.view();
  const bool hasRolling = liveCount(Per::Rolling) > 0;
  present_.take(sizesOf(host_, liveCount(Per::Pair), liveCount(Per::ActivePair), liveCount(Per::Manifold)),
                stepper_.tables().view(), true, stream);
  counts_.reserve(sizeof(ContactCounts) * (static_cast<std::size_t>(s.worlds) + 1));
  auto* const counts = reinterpret_cast<ContactCounts*>(counts_.data());
  const Splice splice{contactTables(present_.view(), hasRolling), b, firstInB, counts};
  countSplice(stream, present(), splice);
  checkCuda(
      cudaMemcpyAsync(total_.get(), counts + s.worlds, sizeof(ContactCounts), cudaMemcpyDeviceToHost, stream),
      "cudaMemcpyAsync of counts");
  checkCuda(cudaStreamSynchronize(stream), "cudaStreamSynchronize");
  stepper_.tables().reserve(Per::Pair, total_->pairs);
  stepper_.tables().reserve(Per::ActivePair, total_->active);
  stepper_.tables().reserve(Per::Manifold, total_->rows);
  if (s.rolledBefore) stepper_.tables().reserve(Per::Rolling, stepper_.tables().capacity(Per::ActivePair));
  writeSplice(stream, present(), splice);
  s.counters->pairs = total_->pairs, s.counters->activePairs = total_->active;
  s.counters->manifolds = total_->rows;
  if (s.rolledBefore) s.counters->rollers = total_->active;
  worldsRead_.clear();
  restOld_ = true;
}

void Mirror::keepWorlds() {
  flush();
  keptForces_ = forced_;
  keptRolling_ = liveCount(Per::Rolling) > 0;
  kept_.take(sizesOf(host_, liveCount(Per::Pair), liveCount(Per::ActivePair), liveCount(Per::Manifold)),
             stepper_.tables().view(), false, stepper_.stream());
}

void Mirror::putBackPaused() {
  SolverData& s = host_.view();
  const cudaStream_t stream = stepper_.stream();
  RUBBLE_CORE::putBackPaused(stream, present(), kept_.view());
  std::vector<int> firstInB(static_cast<std::size_t>(s.worlds), -1);
  for (int w = 0; w < s.worlds; ++w)
    if (s.paused[w] != 0) firstInB[static_cast<std::size_t>(w)] = s.firstBody[w];
  const std::size_t bytes = sizeof(int) * firstInB.size();
  std::memcpy(upload_.begin(bytes), firstInB.data(), bytes);
  const std::byte* const sent = upload_.send(stream);
  s.rolledBefore |= keptRolling_;
  splice(contactTables(kept_.view(), keptRolling_), reinterpret_cast<const int*>(sent));
  statesOld_ = true;
  forced_ |= keptForces_, forcesOnDevice_ |= keptForces_;
  followArrays();
}

}  // namespace rubble::RUBBLE_CORE
