#pragma once
/// NCCL, if its library is on this machine. It is loaded when it is asked for, so that programs run without
/// it.
#include <cuda_runtime_api.h>

#include <array>
#include <cstddef>
#include <functional>
#include <memory>

namespace rubble {

/// A communicator of all ranks, one GPU each. Calls throw RankFailure.
class Nccl {
 public:
  /// What all ranks must have from rank 0.
  using Id = std::array<char, 128>;

  static bool found();
  static Id makeId();
  /// For the present device. All ranks call it together.
  Nccl(const Id& id, int rank, int ranks);
  ~Nccl();
  Nccl(const Nccl&) = delete;
  Nccl& operator=(const Nccl&) = delete;

  /// Sends the first `bytes` of out[r] to each other rank r and receives as many into in[r], in the order of
  /// the stream.
  void exchange(const std::function<const void*(int)>& out, const std::function<void*(int)>& in,
                std::size_t bytes, cudaStream_t stream);
  /// Throws if something has failed since the last call.
  void check();
  /// Ends what is under way. Nothing else may be called afterwards.
  void abort() noexcept;

 private:
  struct Library;
  static const Library* library();
  void require(int status, const char* what) const;

  int rank_, ranks_;
  void* comm_ = nullptr;
};

}  // namespace rubble
