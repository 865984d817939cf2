#include "backend/cuda/nccl.h"

#include <dlfcn.h>

#include <optional>
#include <string>

#include "backend/distributed/transport.h"

namespace rubble {

namespace {

// The interface of NCCL 2, by https://docs.nvidia.com/deeplearning/nccl/user-guide/docs/api.html.
constexpr const char* kName = "libnccl.so.2";
constexpr int kSuccess = 0, kInProgress = 7;
constexpr int kBytes = 0;  // ncclInt8

}  // namespace

struct Nccl::Library {
  int (*getUniqueId)(Id*);
  int (*commInitRank)(void**, int, Id, int);
  int (*commDestroy)(void*);
  int (*commAbort)(void*);
  int (*commGetAsyncError)(void*, int*);
  int (*send)(const void*, std::size_t, int, int, void*, cudaStream_t);
  int (*recv)(void*, std::size_t, int, int, void*, cudaStream_t);
  int (*groupStart)();
  int (*groupEnd)();
  const char* (*getErrorString)(int);
};

const Nccl::Library* Nccl::library() {
  static const std::optional<Library> loaded = []() -> std::optional<Library> {
    void* const handle = dlopen(kName, RTLD_NOW | RTLD_LOCAL);
    if (!handle) return {};
    Library of;
    bool all = true;
    const auto find = [&](auto*& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle, name));
      all = all && function;
    };
    find(of.getUniqueId, "ncclGetUniqueId"), find(of.commInitRank, "ncclCommInitRank");
    find(of.commDestroy, "ncclCommDestroy"), find(of.commAbort, "ncclCommAbort");
    find(of.commGetAsyncError, "ncclCommGetAsyncError"), find(of.send, "ncclSend");
    find(of.recv, "ncclRecv"), find(of.groupStart, "ncclGroupStart"), find(of.groupEnd, "ncclGroupEnd");
    find(of.getErrorString, "ncclGetErrorString");
    return all ? std::optional(of) : std::nullopt;
  }();
  return loaded ? &*loaded : nullptr;
}

bool Nccl::found() { return library() != nullptr; }

Nccl::Id Nccl::makeId() {
  Id id{};
  if (const int status = library()->getUniqueId(&id); status != kSuccess)
    throw RankFailure(std::string("ncclGetUniqueId: ") + library()->getErrorString(status));
  return id;
}

Nccl::Nccl(const Id& id, int rank, int ranks) : rank_(rank), ranks_(ranks) {
  require(library()->commInitRank(&comm_, ranks, id, rank), "ncclCommInitRank");
}
Nccl::~Nccl() {
  if (comm_) library()->commDestroy(comm_);
}

void Nccl::require(int status, const char* what) const {
  if (status != kSuccess && status != kInProgress)
    throw RankFailure(std::string(what) + ": " + library()->getErrorString(status));
}

void Nccl::exchange(const std::function<const void*(int)>& out, const std::function<void*(int)>& in,
                    std::size_t bytes, cudaStream_t stream) {
  const Library& nccl = *library();
  require(nccl.groupStart(), "ncclGroupStart");
  for (int r = 0; r < ranks_; ++r) {
    if (r == rank_) continue;
    require(nccl.send(out(r), bytes, kBytes, r, comm_, stream), "ncclSend");
    require(nccl.recv(in(r), bytes, kBytes, r, comm_, stream), "ncclRecv");
  }
  require(nccl.groupEnd(), "ncclGroupEnd");
}

void Nccl::check() {
  int status = kSuccess;
  require(library()->commGetAsyncError(comm_, &status), "ncclCommGetAsyncError");
  require(status, "NCCL");
}

void Nccl::abort() noexcept {
  if (comm_) library()->commAbort(comm_);
  comm_ = nullptr;
}

}  // namespace rubble
