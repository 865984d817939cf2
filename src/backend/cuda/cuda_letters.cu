#include "backend/cuda/cuda_letters.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <set>
#include <span>
#include <string>
#include <thread>

#include "backend/cuda/kernels.cuh"
#include "backend/cuda/nccl.h"
#include "backend/peers/peer_data.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Control::lacking of a step whose messages of kind k are too short: this less k. Tables are not negative,
/// and a lost rank is kLostPeer.
constexpr int kLackingLetters = kLostPeer - 1;
/// Letters of a message before any step has asked for more.
constexpr int kFirstRoom = 255;
/// More room than was asked for by this share [1]: numbers of letters change a little from step to step.
constexpr int kSpareShare = 4;
/// Most blocks that deliver: a few for each multiprocessor of a large device. Not measured.
constexpr int kDeliveryBlocks = 512;

__device__ int mostOf(const PeerBox* boxes, int rank, int ranks) {
  int most = 0;
  for (int r = 0; r < ranks; ++r)
    if (r != rank) most = max(most, boxes[r].head->count);
  return most;
}

/// Before a message leaves: its head says how many letters the fullest box has.
__global__ void sealBoxes(const PeerBox* boxes, int rank, int ranks) {
  const int r = static_cast<int>(threadIdx.x);
  if (r < ranks && r != rank) boxes[r].head->most = mostOf(boxes, rank, ranks);
}

/// Does what the letters say, unless some rank has more of them than messages hold: then all ranks stop, and
/// post again with more room. Empties the own boxes. A step that has stopped keeps its letters.
__global__ void __launch_bounds__(kThreads)
    deliverLetters(const PeerBox* boxes, const std::byte* in, std::size_t boxBytes, int rank, int ranks,
                   int room, int operation, int lacking, Control* control) {
  const auto messageOf = [&](int r) {
    return reinterpret_cast<const PeerLetter*>(in + boxBytes * static_cast<std::size_t>(r));
  };
  const auto headOf = [&](int r) { return reinterpret_cast<const PeerBoxHead*>(messageOf(r)); };
  // the first block alone may set it, to stop what would not go on anyway
  if (control->stop != 0) return;
  int needed = 0;
  for (int r = 0; r < ranks; ++r)
    if (r != rank) needed = max(needed, max(headOf(r)->most, boxes[r].head->most));
  if (blockIdx.x == 0) {
    const int r = static_cast<int>(threadIdx.x);
    if (r < ranks) boxes[r].head->count = 0;
    if (r == 0 && needed > room) lack(control, operation, lacking, needed);
  }
  if (needed > room) return;
  const int stride = static_cast<int>(gridDim.x * blockDim.x);
  for (int r = 0; r < ranks; ++r)
    if (r != rank)
      for (int k = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x); k < headOf(r)->count; k += stride)
        deliver(messageOf(r)[1 + k]);
}

bool eachHasOwnGpu(RankCourier& courier) {
  int device = 0;
  checkCuda(cudaGetDevice(&device), "cudaGetDevice");
  cudaDeviceProp properties{};
  checkCuda(cudaGetDeviceProperties(&properties, device), "cudaGetDeviceProperties");
  std::array<char, sizeof properties.uuid.bytes> own;
  std::ranges::copy(properties.uuid.bytes, own.begin());
  const auto all = courier.gatherValue(own);
  return std::set(all.begin(), all.end()).size() == all.size();
}

}  // namespace

CudaLetters::CudaLetters(Transport& transport, cudaStream_t stream, bool nccl)
    : transport_(transport), courier_(transport), stream_(stream), room_(kKinds, kFirstRoom) {
  boxes_ = static_cast<PeerBox*>(DeviceMemory::allocate(sizeof(PeerBox) * kMostPeers));
  const bool own = eachHasOwnGpu(courier_);
  const std::vector<char> found = courier_.gatherValue(static_cast<char>(nccl && Nccl::found()));
  if (own && transport.ranks() > 1 && std::ranges::find(found, char{0}) == found.end()) {
    const Nccl::Id id = courier_.gatherValue(transport.rank() == 0 ? Nccl::makeId() : Nccl::Id{}).front();
    nccl_ = std::make_unique<Nccl>(id, transport.rank(), transport.ranks());
  }
  grow(kFirstRoom);
}
CudaLetters::~CudaLetters() { DeviceMemory::release(boxes_); }

std::size_t CudaLetters::messageBytes(int kind) const {
  return sizeof(PeerLetter) * (1 + static_cast<std::size_t>(room_[static_cast<std::size_t>(kind)]));
}
std::byte* CudaLetters::boxIn(const DeviceBuffer& boxes, int rank) const {
  return boxes.data() +
         sizeof(PeerLetter) * (1 + static_cast<std::size_t>(capacity_)) * static_cast<std::size_t>(rank);
}

void CudaLetters::grow(int letters) {
  capacity_ = letters;
  const std::size_t ranks = static_cast<std::size_t>(transport_.ranks());
  const std::size_t bytes = sizeof(PeerLetter) * (1 + static_cast<std::size_t>(letters)) * ranks;
  out_.reserveExactly(bytes), in_.reserveExactly(bytes);
  if (!nccl_) outHost_.reserve(bytes), inHost_.reserve(bytes);
  std::vector<PeerBox> boxes;
  for (int r = 0; r < transport_.ranks(); ++r) {
    auto* const box = reinterpret_cast<PeerLetter*>(boxIn(out_, r));
    boxes.push_back({reinterpret_cast<PeerBoxHead*>(box), box + 1, letters, nullptr, nullptr});
  }
  checkCuda(cudaMemcpy(boxes_, boxes.data(), sizeof(PeerBox) * ranks, cudaMemcpyHostToDevice), "cudaMemcpy");
}

int CudaLetters::kindOf(int lacking) { return lacking <= kLackingLetters ? kLackingLetters - lacking : -1; }

void CudaLetters::reserve(int kind, int letters) {
  room_[static_cast<std::size_t>(kind)] = letters + letters / kSpareShare;
  // the boxes of a step that has stopped for their length are empty
  if (room_[static_cast<std::size_t>(kind)] > capacity_) grow(room_[static_cast<std::size_t>(kind)]);
  ++version_;
}

void CudaLetters::exchange(int kind, int operation, Control* control) {
  const int rank = transport_.rank(), ranks = transport_.ranks();
  if (ranks == 1) return;
  sealBoxes<<<1, kMostPeers, 0, stream_>>>(boxes_, rank, ranks);
  const std::size_t bytes = messageBytes(kind);
  if (nccl_)
    nccl_->exchange([&](int r) { return boxIn(out_, r); }, [&](int r) { return boxIn(in_, r); }, bytes,
                    stream_);
  else
    carryByHost(bytes);
  const int room = room_[static_cast<std::size_t>(kind)];
  const int blocks = std::clamp(room / kThreads, 1, kDeliveryBlocks);
  deliverLetters<<<blocks, kThreads, 0, stream_>>>(
      boxes_, in_.data(), static_cast<std::size_t>(boxIn(in_, 1) - boxIn(in_, 0)), rank, ranks, room,
      operation, kLackingLetters - kind, control);
  checkCuda(cudaGetLastError(), "letters");
}

/// Messages have room for more letters than there are; only these travel between hosts.
void CudaLetters::carryByHost(std::size_t bytes) {
  const auto messageIn = [&](const PinnedBuffer& boxes, int r) {
    return boxes.data() + bytes * static_cast<std::size_t>(r);
  };
  const auto forEachOther = [&](auto&& f) {
    for (int r = 0; r < transport_.ranks(); ++r)
      if (r != transport_.rank()) f(r);
  };
  const auto copy = [&](void* to, const void* from, cudaMemcpyKind kind) {
    checkCuda(cudaMemcpyAsync(to, from, bytes, kind, stream_), "cudaMemcpyAsync");
  };
  forEachOther([&](int r) { copy(messageIn(outHost_, r), boxIn(out_, r), cudaMemcpyDeviceToHost); });
  checkCuda(cudaStreamSynchronize(stream_), "letters on the device");

  const int room = static_cast<int>(bytes / sizeof(PeerLetter)) - 1;
  std::vector<Transport::Send> sends;
  std::vector<Transport::Receive> receives;
  forEachOther([&](int r) {
    sends.push_back({r, {messageIn(outHost_, r), sizeof(PeerLetter)}});
    receives.push_back({r, {messageIn(inHost_, r), sizeof(PeerLetter)}});
  });
  transport_.exchange(sends, receives);
  const auto letters = [&](std::byte* message) {
    PeerBoxHead head;
    std::memcpy(&head, message, sizeof head);
    return std::span(message + sizeof(PeerLetter),
                     sizeof(PeerLetter) * static_cast<std::size_t>(std::min(head.count, room)));
  };
  sends.clear(), receives.clear();
  forEachOther([&](int r) {
    if (const auto out = letters(messageIn(outHost_, r)); !out.empty()) sends.push_back({r, out});
    if (const auto in = letters(messageIn(inHost_, r)); !in.empty()) receives.push_back({r, in});
  });
  transport_.exchange(sends, receives);
  forEachOther([&](int r) { copy(boxIn(in_, r), messageIn(inHost_, r), cudaMemcpyHostToDevice); });
}

void CudaLetters::await(double seconds) {
  if (!nccl_) return checkCuda(cudaStreamSynchronize(stream_), "step on the device");
  // nobody else notices that a rank has gone: the kernels of NCCL would wait for it for ever
  using Clock = std::chrono::steady_clock;
  constexpr auto kPoll = std::chrono::milliseconds(50);
  const Clock::time_point begin = Clock::now();
  Clock::time_point next = begin + kPoll;
  for (;;) {
    const cudaError_t status = cudaStreamQuery(stream_);
    if (status == cudaSuccess) return;
    if (status != cudaErrorNotReady) checkCuda(status, "step on the device");
    const Clock::time_point now = Clock::now();
    if (now < next) {
      std::this_thread::yield();
      continue;
    }
    next = now + kPoll;
    try {
      nccl_->check();
      transport_.requireAll();
      if (std::chrono::duration<double>(now - begin).count() > seconds)
        throw RankFailure("rank " + std::to_string(transport_.rank()) + " has waited for letters for " +
                          std::to_string(static_cast<int>(seconds)) + " s");
    } catch (...) {
      nccl_->abort();
      throw;
    }
  }
}

}  // namespace rubble::RUBBLE_CORE
