#pragma once
/// Connections between processes of one or many hosts, over TCP.
#include <cstddef>
#include <span>
#include <string>
#include <utility>

namespace rubble::platform {

/// One end of a connection, or a door that others connect to. Calls throw Error where the system refuses, or
/// has no sockets.
class Socket {
 public:
  /// A door at a port; 0: any that is free.
  static Socket open(int port);
  /// Connects to the door of a host, which may open later, within so many seconds.
  static Socket connect(const std::string& host, int port, double seconds);

  Socket() = default;
  ~Socket();
  Socket(Socket&& from) noexcept : handle_(std::exchange(from.handle_, kNone)) {}
  Socket& operator=(Socket&& from) noexcept {
    std::swap(handle_, from.handle_);
    return *this;
  }

  /// The next one that connects to this door; an empty socket if none does within so many seconds.
  Socket accept(double seconds) const;
  explicit operator bool() const { return handle_ != kNone; }
  int handle() const { return handle_; }
  /// Of this end.
  int port() const;
  /// Address of the other end, in digits.
  std::string peer() const;

  /// Moves as many bytes as go without a wait, and returns their number; -1: the other end is gone.
  std::ptrdiff_t send(std::span<const std::byte> bytes) const;
  std::ptrdiff_t receive(std::span<std::byte> bytes) const;
  /// Is the other end gone, and all that it has sent received?
  bool isGone() const;
  /// Sends no more. The other end then reads to the end of what was sent.
  void finish() const;

 private:
  static constexpr int kNone = -1;
  explicit Socket(int handle) : handle_(handle) {}
  int handle_ = kNone;
};

/// A socket that waits for room to send, or for bytes to receive.
struct SocketWait {
  int handle;
  bool sends;
};
/// Waits until one of them can go on, or so many seconds have passed.
void awaitSockets(std::span<const SocketWait> waits, double seconds);

}  // namespace rubble::platform
