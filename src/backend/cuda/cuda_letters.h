#pragma once
/// Letters between GPUs that do not reach one another's memory (backend/peers/peer_letters.h): the boxes of
/// one rank on its device, and what carries them. NCCL does, in the order of the stream, if its library is
/// there and each rank has a GPU of its own. Else the transport of the host does, which waits for the device
/// at each exchange. This header is plain host code.
#include <memory>
#include <vector>

#include "backend/cuda/device_memory.h"
#include "backend/distributed/rank_lists.h"
#include "backend/peers/peer_letters.h"

namespace rubble {
class Nccl;
}

namespace rubble::RUBBLE_CORE {

struct Control;

class CudaLetters {
 public:
  /// All ranks make one together. The transport must outlive it.
  CudaLetters(Transport& transport, cudaStream_t stream, bool nccl);
  ~CudaLetters();

  /// Device memory: [ranks], for the kernels that post.
  PeerBox* boxes() const { return boxes_; }
  std::size_t bytes() const { return out_.size() + in_.size(); }
  /// Enqueues an exchange. Messages have a fixed length: that of `kind`. If any box of any rank holds more,
  /// the step stops on all ranks at `operation`, the first one that posted, and kindOf() tells the kind.
  void exchange(int kind, int operation, Control* control);
  static constexpr int kKinds = 1024;

  /// Of Control::lacking: the kind of exchange that lacks room, or -1.
  static int kindOf(int lacking);
  /// Makes messages of a kind longer. All ranks do it together.
  void reserve(int kind, int letters);
  /// May exchanges be captured in a graph?
  bool captured() const { return nccl_ != nullptr; }
  /// Changes whenever a captured exchange would not be the same any more.
  int version() const { return version_; }

  /// Waits for the stream. Throws RankFailure if a rank is gone or silent for so many seconds.
  void await(double seconds);

 private:
  std::size_t messageBytes(int kind) const;
  std::byte* boxIn(const DeviceBuffer& boxes, int rank) const;
  void grow(int letters);
  void carryByHost(std::size_t bytes);

  Transport& transport_;
  RankCourier courier_;
  cudaStream_t stream_;
  std::unique_ptr<Nccl> nccl_;
  int capacity_ = 0;               ///< letters in each box
  std::vector<int> room_;          ///< by kind: letters in a message
  DeviceBuffer out_, in_;          ///< [ranks] boxes
  PeerBox* boxes_ = nullptr;       ///< device memory
  PinnedBuffer outHost_, inHost_;  ///< [ranks] messages
  int version_ = 0;
};

}  // namespace rubble::RUBBLE_CORE
