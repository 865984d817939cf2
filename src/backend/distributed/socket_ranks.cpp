#include <rubble/socket_ranks.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include <rubble/info.h>

#include "backend/distributed/rank_processes.h"
#include "platform/socket.h"

namespace rubble {

namespace {

using platform::Socket;
using Clock = std::chrono::steady_clock;

/// Time that is left.
class Deadline {
 public:
  explicit Deadline(double seconds) : end_(Clock::now() + std::chrono::duration<double>(seconds)) {}
  double left() const { return std::chrono::duration<double>(end_ - Clock::now()).count(); }

 private:
  std::chrono::time_point<Clock, std::chrono::duration<double>> end_;
};

/// One message under way: its length, and then its bytes.
class Message {
 public:
  Message(const Socket& socket, int rank, std::span<const std::byte> bytes)
      : socket_(&socket), rank_(rank), sends_(true), length_(bytes.size()), from_(bytes) {}
  Message(const Socket& socket, int rank, std::span<std::byte> bytes)
      : socket_(&socket), rank_(rank), sends_(false), to_(bytes) {}

  int rank() const { return rank_; }
  platform::SocketWait wait() const { return {socket_->handle(), sends_}; }
  bool isDone() const { return head_ == sizeof length_ && body_ == size(); }

  /// Moves what goes without a wait. Returns whether anything moved.
  bool advance() {
    bool any = false;
    while (!isDone()) {
      const bool head = head_ < sizeof length_;
      const std::size_t count = head ? move(std::as_writable_bytes(std::span(&length_, 1)).subspan(head_))
                                     : moveBody();
      if (count == 0) return any;
      (head ? head_ : body_) += count;
      any = true;
      if (head && head_ == sizeof length_ && !sends_ && length_ != to_.size())
        throw RankFailure("rank " + std::to_string(rank_) + " sent " + std::to_string(length_) +
                          " bytes, expected " + std::to_string(to_.size()));
    }
    return any;
  }

 private:
  std::size_t size() const { return sends_ ? from_.size() : to_.size(); }
  std::size_t moveBody() {
    return sends_ ? took(socket_->send(from_.subspan(body_))) : move(to_.subspan(body_));
  }
  std::size_t move(std::span<std::byte> bytes) {
    return took(sends_ ? socket_->send(bytes) : socket_->receive(bytes));
  }
  std::size_t took(std::ptrdiff_t count) const {
    if (count < 0) throw RankFailure("rank " + std::to_string(rank_) + " has ended");
    return static_cast<std::size_t>(count);
  }

  const Socket* socket_;
  int rank_;
  bool sends_;
  std::uint64_t length_ = 0;
  std::span<const std::byte> from_;
  std::span<std::byte> to_;
  std::size_t head_ = 0, body_ = 0;
};

/// Moves all messages. Throws RankFailure if nothing moves for so many seconds.
void moveAll(std::vector<Message>& messages, double timeout) {
  constexpr int kSpins = 200;
  constexpr double kPoll = 0.1;  // [s]
  std::vector<platform::SocketWait> waits;
  Deadline deadline(timeout);
  for (int idle = 0;;) {
    bool moved = false;
    for (Message& message : messages) moved = message.advance() || moved;
    std::erase_if(messages, [](const Message& message) { return message.isDone(); });
    if (messages.empty()) return;
    if (moved) {
      idle = 0, deadline = Deadline(timeout);
    } else if (++idle > kSpins) {
      if (deadline.left() < 0)
        throw RankFailure("rank " + std::to_string(messages.front().rank()) + " does not answer");
      waits.clear();
      for (const Message& message : messages) waits.push_back(message.wait());
      platform::awaitSockets(waits, std::min(kPoll, timeout));
    }
  }
}

void sendTo(const Socket& socket, int rank, std::span<const std::byte> bytes, double timeout) {
  std::vector<Message> messages{Message(socket, rank, bytes)};
  moveAll(messages, timeout);
}
void receiveFrom(const Socket& socket, int rank, std::span<std::byte> bytes, double timeout) {
  std::vector<Message> messages{Message(socket, rank, bytes)};
  moveAll(messages, timeout);
}

class SocketTransport final : public Transport {
 public:
  SocketTransport(const std::vector<Socket>& links, int rank, double timeout)
      : links_(links), rank_(rank), timeout_(timeout) {}
  int rank() const override { return rank_; }
  int ranks() const override { return static_cast<int>(links_.size()); }
  /// The others read to the end of what was sent, and then that this rank has ended.
  void fail(const std::string&) noexcept override {
    for (const Socket& link : links_)
      if (link) link.finish();
  }
  void requireAll() override {
    for (std::size_t r = 0; r < links_.size(); ++r)
      if (links_[r] && links_[r].isGone()) throw RankFailure("rank " + std::to_string(r) + " has ended");
  }

 private:
  void swap(std::span<const Send> sends, std::span<const Receive> receives) override {
    const auto link = [&](int rank) -> const Socket& { return links_[static_cast<std::size_t>(rank)]; };
    messages_.clear();
    for (const Send& send : sends) messages_.emplace_back(link(send.to), send.to, send.bytes);
    for (const Receive& receive : receives)
      messages_.emplace_back(link(receive.from), receive.from, receive.bytes);
    moveAll(messages_, timeout_);
  }

  const std::vector<Socket>& links_;
  int rank_;
  double timeout_;
  std::vector<Message> messages_;
};

/// The first message on a connection.
struct Hello {
  char build[64] = {};  ///< version and commit
  std::int32_t rank = 0, count = 0, port = 0;
};

std::string buildName() {
  const BuildInfo info = buildInfo();
  return info.version + " " + info.commit;
}

const char* variable(const char* name) {
  const char* const value = std::getenv(name);
  if (!value || !*value)
    throw Error(name, "to be set, as RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT are", "nothing");
  return value;
}
int numberIn(const char* name, int least, int most) {
  const char* const text = variable(name);
  int number = 0;
  const char* const end = text + std::strlen(text);
  if (const auto [at, status] = std::from_chars(text, end, number);
      status != std::errc() || at != end || number < least || number > most)
    throw Error(name, "a number from " + std::to_string(least) + " to " + std::to_string(most), text);
  return number;
}

}  // namespace

struct SocketRanks::Impl {
  int rank = 0, count = 1;
  std::vector<Socket> links;  ///< by rank; empty for this one

  Socket& link(int r) { return links[static_cast<std::size_t>(r)]; }
  void connect(double timeout);
  void greet(int to, int port, double timeout) {
    Hello hello{{}, rank, count, port};
    buildName().copy(hello.build, sizeof hello.build - 1);
    sendTo(link(to), to, std::as_bytes(std::span(&hello, 1)), timeout);
  }
  /// Takes the next connection of another rank, and returns what it says.
  Hello take(const Socket& door, const Deadline& deadline);
};

Hello SocketRanks::Impl::take(const Socket& door, const Deadline& deadline) {
  Socket made = door.accept(deadline.left());
  if (!made) throw RankFailure("not all of " + std::to_string(count) + " processes have come");
  Hello hello;
  receiveFrom(made, -1, std::as_writable_bytes(std::span(&hello, 1)), deadline.left());
  hello.build[sizeof hello.build - 1] = 0;
  if (hello.build != buildName() || hello.count != count)
    throw Error("rank " + std::to_string(hello.rank),
                "build " + buildName() + " and WORLD_SIZE " + std::to_string(count),
                std::string(hello.build) + " and " + std::to_string(hello.count));
  if (hello.rank <= 0 || hello.rank >= count || hello.rank == rank || link(hello.rank))
    throw Error("RANK", "a number of its own for each process", std::to_string(hello.rank));
  link(hello.rank) = std::move(made);
  return hello;
}

/// Process 0 has a door that all know. It tells each one where the others are, and those of higher rank
/// connect to those of lower rank.
void SocketRanks::Impl::connect(double timeout) {
  constexpr int kLastPort = 65535, kMostRanks = 4096;
  const Deadline deadline(timeout);
  count = numberIn("WORLD_SIZE", 1, kMostRanks), rank = numberIn("RANK", 0, count - 1);
  const int port = std::getenv("RUBBLE_PORT") ? numberIn("RUBBLE_PORT", 1, kLastPort)
                                              : numberIn("MASTER_PORT", 1, kLastPort - 1) + 1;
  links.resize(static_cast<std::size_t>(count));
  const Socket door = Socket::open(rank == 0 ? port : 0);
  std::string places;
  if (rank == 0) {
    std::vector<std::string> of(static_cast<std::size_t>(count));
    for (int k = 1; k < count; ++k) {
      const Hello hello = take(door, deadline);
      of[static_cast<std::size_t>(hello.rank)] = link(hello.rank).peer() + " " + std::to_string(hello.port);
    }
    for (int r = 1; r < count; ++r) places += of[static_cast<std::size_t>(r)] + "\n";
  } else {
    link(0) = Socket::connect(variable("MASTER_ADDR"), port, deadline.left());
    greet(0, door.port(), deadline.left());
  }
  std::uint64_t size = places.size();
  for (int r = 1; rank == 0 && r < count; ++r) {
    sendTo(link(r), r, std::as_bytes(std::span(&size, 1)), deadline.left());
    sendTo(link(r), r, std::as_bytes(std::span(places)), deadline.left());
  }
  if (rank == 0) return;
  receiveFrom(link(0), 0, std::as_writable_bytes(std::span(&size, 1)), deadline.left());
  places.resize(size);
  receiveFrom(link(0), 0, std::as_writable_bytes(std::span(places)), deadline.left());
  std::istringstream lines(places);
  std::string host;
  int its = 0;
  for (int r = 1; r < rank && lines >> host >> its; ++r) {
    link(r) = Socket::connect(host, its, deadline.left());
    greet(r, door.port(), deadline.left());
  }
  for (int r = rank + 1; r < count; ++r) take(door, deadline);
}

bool SocketRanks::launched() {
  return std::getenv("RANK") && std::getenv("WORLD_SIZE") && std::getenv("MASTER_ADDR");
}

SocketRanks::SocketRanks(double timeout) : impl_(std::make_unique<Impl>()) {
  requireNoProcesses();
  impl_->connect(timeout);
  joinProcesses({impl_->count, [impl = impl_.get()](double longest) {
                   return std::make_unique<SocketTransport>(impl->links, impl->rank, longest);
                 }});
}

SocketRanks::~SocketRanks() {
  leaveProcesses();
  // what others still read would be lost if this end closed with bytes of theirs unread
  constexpr double kLongest = 5;  // [s]
  const Deadline deadline(kLongest);
  for (const Socket& link : impl_->links)
    if (link) link.finish();
  std::byte ignored[256];
  for (const Socket& link : impl_->links)
    while (link && deadline.left() > 0 && link.receive(ignored) >= 0) {
      const platform::SocketWait wait{link.handle(), false};
      platform::awaitSockets(std::span(&wait, 1), deadline.left());
    }
}

int SocketRanks::rank() const { return impl_->rank; }
int SocketRanks::count() const { return impl_->count; }

}  // namespace rubble
