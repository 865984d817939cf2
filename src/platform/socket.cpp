#include "platform/socket.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <vector>

#include <rubble/error.h>

#if __has_include(<sys/socket.h>)
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#define RUBBLE_HAS_SOCKETS 1
#endif

namespace rubble::platform {

#if RUBBLE_HAS_SOCKETS

namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(what + ": " + std::strerror(errno)); }

int millisecondsOf(double seconds) { return static_cast<int>(std::clamp(seconds, 0.0, 1e6) * 1000); }

/// Messages are small and awaited: they are not held back to fill a packet.
void sendAtOnce(int handle) {
  const int on = 1;
  setsockopt(handle, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

/// Bytes that a call moved.
std::ptrdiff_t moved(ssize_t count) {
  if (count > 0) return count;
  return count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) ? 0 : -1;
}

int portOf(const sockaddr_storage& address) {
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                                             : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

}  // namespace

Socket::~Socket() {
  if (handle_ != kNone) ::close(handle_);
}

Socket Socket::open(int port) {
  Socket door(::socket(AF_INET6, SOCK_STREAM, 0));
  const bool old = !door;
  if (old) door = Socket(::socket(AF_INET, SOCK_STREAM, 0));
  if (!door) refuse("a socket cannot be made");
  const int on = 1, off = 0;
  setsockopt(door.handle_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_storage address{};
  socklen_t size = sizeof(sockaddr_in);
  if (old) {
    auto& four = reinterpret_cast<sockaddr_in&>(address);
    four.sin_family = AF_INET, four.sin_port = htons(static_cast<std::uint16_t>(port));
  } else {
    setsockopt(door.handle_, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
    auto& six = reinterpret_cast<sockaddr_in6&>(address);
    six.sin6_family = AF_INET6, six.sin6_port = htons(static_cast<std::uint16_t>(port));
    size = sizeof(sockaddr_in6);
  }
  if (::bind(door.handle_, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::listen(door.handle_, SOMAXCONN) != 0)
    refuse("port " + std::to_string(port) + " cannot be opened");
  return door;
}

Socket Socket::connect(const std::string& host, int port, double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_socktype = SOCK_STREAM;
  if (const int status = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found))
    throw Error("host '" + host + "' is not known: " + gai_strerror(status));
  const struct Freed {
    addrinfo* list;
    ~Freed() { freeaddrinfo(list); }
  } freed{found};
  while (true) {
    for (const addrinfo* a = found; a; a = a->ai_next) {
      Socket made(::socket(a->ai_family, a->ai_socktype, a->ai_protocol));
      if (!made || ::connect(made.handle_, a->ai_addr, a->ai_addrlen) != 0) continue;
      sendAtOnce(made.handle_);
      return made;
    }
    if (Clock::now() > end) refuse("nobody answers at " + host + ", port " + std::to_string(port));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

Socket Socket::accept(double seconds) const {
  pollfd wait{handle_, POLLIN, 0};
  if (::poll(&wait, 1, millisecondsOf(seconds)) <= 0) return {};
  Socket made(::accept(handle_, nullptr, nullptr));
  if (made) sendAtOnce(made.handle_);
  return made;
}

int Socket::port() const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(handle_, reinterpret_cast<sockaddr*>(&address), &size) != 0) refuse("a port");
  return portOf(address);
}

std::string Socket::peer() const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  char text[NI_MAXHOST];
  if (::getpeername(handle_, reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
      ::getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, text, sizeof text, nullptr, 0,
                    NI_NUMERICHOST) != 0)
    refuse("an address");
  return text;
}

std::ptrdiff_t Socket::send(std::span<const std::byte> bytes) const {
  return moved(::send(handle_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
}
std::ptrdiff_t Socket::receive(std::span<std::byte> bytes) const {
  return moved(::recv(handle_, bytes.data(), bytes.size(), MSG_DONTWAIT));
}
bool Socket::isGone() const {
  std::byte next;
  return moved(::recv(handle_, &next, 1, MSG_DONTWAIT | MSG_PEEK)) < 0;
}
void Socket::finish() const { ::shutdown(handle_, SHUT_WR); }

void awaitSockets(std::span<const SocketWait> waits, double seconds) {
  std::vector<pollfd> polled;
  for (const SocketWait& wait : waits)
    polled.push_back({wait.handle, static_cast<short>(wait.sends ? POLLOUT : POLLIN), 0});
  ::poll(polled.data(), static_cast<nfds_t>(polled.size()), millisecondsOf(seconds));
}

#else

namespace {
[[noreturn]] void refuse() { throw Error("this system has no POSIX sockets"); }
}  // namespace

Socket::~Socket() = default;
Socket Socket::open(int) { refuse(); }
Socket Socket::connect(const std::string&, int, double) { refuse(); }
Socket Socket::accept(double) const { refuse(); }
int Socket::port() const { refuse(); }
std::string Socket::peer() const { refuse(); }
std::ptrdiff_t Socket::send(std::span<const std::byte>) const { refuse(); }
std::ptrdiff_t Socket::receive(std::span<std::byte>) const { refuse(); }
bool Socket::isGone() const { refuse(); }
void Socket::finish() const {}
void awaitSockets(std::span<const SocketWait>, double) { refuse(); }

#endif

}  // namespace rubble::platform
