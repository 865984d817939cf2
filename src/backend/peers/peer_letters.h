#pragma once
/// Stores into the tables of a rank whose memory is out of reach: GPUs of several processes or hosts. A
/// letter says where a few bytes go. Each rank collects the letters to each other one, and the barrier
/// exchanges and delivers them. Letters that exceed the room of a box are counted and not kept: the kernels
/// that post them run again with more room.
#include <cstdint>
#include <cstring>

#include "math/hd.h"

namespace rubble::RUBBLE_CORE {

struct PeerLetter {
  std::uint64_t address;  ///< in the memory of the receiver; its two upper bits: size
  std::uint64_t value;
};
/// What a box holds, at its beginning.
struct PeerBoxHead {
  int count;  ///< letters posted
  int most;   ///< largest `count` of any box of the sender
};
static_assert(sizeof(PeerBoxHead) <= sizeof(PeerLetter));

namespace letters {

inline constexpr int kSizeShift = 62;
inline constexpr std::uint64_t kAddress = (std::uint64_t{1} << kSizeShift) - 1;

}  // namespace letters

/// Letters from one rank to another: the head and then `room` letters.
struct PeerBox {
  PeerBoxHead* head;
  PeerLetter* letter;
  int room;
  /// Makes room for so many letters, on a CPU. Null: what exceeds the room is lost.
  void (*grow)(PeerBox&, int needed);
  void* owner;  ///< for grow()

  template <class T> RUBBLE_HD void post(const T* to, const T& value) {
    const std::uint64_t address = reinterpret_cast<std::uintptr_t>(to);
    if constexpr (sizeof(T) % sizeof(std::uint64_t) == 0)
      if (address % sizeof(std::uint64_t) == 0) return postAs<std::uint64_t, 2>(address, value);
    if constexpr (sizeof(T) % sizeof(std::uint32_t) == 0)
      postAs<std::uint32_t, 1>(address, value);
    else
      postAs<std::uint8_t, 0>(address, value);
  }

 private:
  template <class Word, unsigned size, class T> RUBBLE_HD void postAs(std::uint64_t address, const T& value) {
    constexpr int kWords = static_cast<int>(sizeof(T) / sizeof(Word));
    const int at = atomicCount(&head->count, kWords);
    if constexpr (!RUBBLE_DEVICE_CODE)
      if (at + kWords > room && grow) grow(*this, at + kWords);
    if (at + kWords > room) return;
    for (int k = 0; k < kWords; ++k) {
      Word word;
      std::memcpy(&word, reinterpret_cast<const unsigned char*>(&value) + sizeof(Word) * unsigned(k),
                  sizeof word);
      letter[at + k] = {(address + sizeof(Word) * unsigned(k)) | (std::uint64_t{size} << letters::kSizeShift),
                        word};
    }
  }
};

/// The store of a letter, at its receiver.
RUBBLE_HD inline void deliver(const PeerLetter& letter) {
  const std::uintptr_t to = letter.address & letters::kAddress;
  switch (letter.address >> letters::kSizeShift) {
    case 0:
      *reinterpret_cast<std::uint8_t*>(to) = static_cast<std::uint8_t>(letter.value);
      break;
    case 1:
      *reinterpret_cast<std::uint32_t*>(to) = static_cast<std::uint32_t>(letter.value);
      break;
    default:
      *reinterpret_cast<std::uint64_t*>(to) = letter.value;
  }
}

}  // namespace rubble::RUBBLE_CORE
