#pragma once
/// How ranks exchange bytes. Everything that ranks tell one another goes through this interface.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <rubble/error.h>

namespace rubble {

/// A rank failed or did not answer; what() names it. The world cannot go on.
class RankFailure : public Error {
 public:
  using Error::Error;
};

/// The end of one rank. All ranks make the same calls in the same order. Calls throw RankFailure if another
/// rank has failed, or has not answered for the time that the transport allows.
class Transport {
 public:
  struct Send {
    int to;
    std::span<const std::byte> bytes;
  };
  struct Receive {
    int from;
    std::span<std::byte> bytes;  ///< as many as the other rank sends
  };
  /// Sums over calls.
  struct Traffic {
    double ms = 0;                         ///< time in calls, waiting included [ms]
    std::int64_t bytes = 0, messages = 0;  ///< sent
  };

  virtual ~Transport() = default;
  virtual int rank() const = 0;
  virtual int ranks() const = 0;
  /// Sends to some ranks and receives from some, at most one message per rank and direction.
  void exchange(std::span<const Send> sends, std::span<const Receive> receives);
  /// Receives the blocks of all ranks in the order of ranks. `sizes`: of each block [bytes].
  void gather(std::span<const std::byte> own, std::span<std::byte> all, std::span<const std::size_t> sizes);
  /// Tells the other ranks that this one has failed.
  virtual void fail(const std::string& why) noexcept = 0;
  /// Throws RankFailure if another rank is known to have failed, without a wait.
  virtual void requireAll() {}
  const Traffic& traffic() const { return traffic_; }

 protected:
  virtual void swap(std::span<const Send> sends, std::span<const Receive> receives) = 0;
  virtual void swapAll(std::span<const std::byte> own, std::span<std::byte> all,
                       std::span<const std::size_t> sizes);

 private:
  template <class F> void timed(F&& f);
  Traffic traffic_;
};

}  // namespace rubble
