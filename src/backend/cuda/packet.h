#pragma once
/// Packs all edits since the last batch into one upload and one kernel.
#include <cstring>
#include <vector>

#include "backend/cuda/cuda_stepper.h"
#include "backend/cuda/upload.h"

namespace rubble::RUBBLE_CORE {

class Packet {
 public:
  Packet(const SolverData& host, const SolverData& device) : host_(host), device_(device) {}

  /// Slots of the elements added from here on. The list must live until the packet is sent.
  void setSlots(const std::vector<int>& slots) {
    slots_ = &slots;
    slotsAt_ = append(slots);
  }
  /// Adds the elements of an array at the slots.
  template <class T> void add(Array<T> SolverData::*array) {
    static_assert(sizeof(T) % sizeof(int) == 0 && alignof(T) <= kAlign);
    const int count = static_cast<int>(slots_->size());
    elements_.push_back({host_.*array, device_.*array, slots_, slotsAt_, reserve(slots_->size() * sizeof(T)),
                         sizeof(T), count});
  }
  /// Appends a list for a separate kernel. Returns its offset.
  template <class T> std::size_t append(const std::vector<T>& list) {
    const std::size_t at = reserve(list.size() * sizeof(T));
    lists_.push_back({list.data(), at, list.size() * sizeof(T)});
    return at;
  }

  /// Uploads everything and scatters the elements. Returns the device address of the packet.
  const std::byte* send(Upload& upload, cudaStream_t stream) const {
    if (bytes_ == 0) return nullptr;
    std::byte* const to = upload.begin(bytes_);
    for (const List& list : lists_)
      if (list.bytes > 0) std::memcpy(to + list.at, list.from, list.bytes);
    for (const Elements& e : elements_)
      for (std::size_t k = 0; k < e.slots->size(); ++k)
        std::memcpy(to + e.at + k * e.bytes,
                    static_cast<const std::byte*>(e.from) + static_cast<std::size_t>((*e.slots)[k]) * e.bytes,
                    e.bytes);
    const std::byte* const sent = upload.send(stream);
    std::vector<ScatterPiece> pieces;
    for (const Elements& e : elements_)
      pieces.push_back({e.to, sent + e.at, reinterpret_cast<const int*>(sent + e.slotsAt), e.count,
                        static_cast<int>(e.bytes / sizeof(int))});
    scatterPieces(stream, pieces);
    return sent;
  }

 private:
  static constexpr std::size_t kAlign = 64;
  struct Elements {
    const void* from;
    void* to;
    const std::vector<int>* slots;
    std::size_t slotsAt, at, bytes;
    int count;
  };
  struct List {
    const void* from;
    std::size_t at, bytes;
  };

  std::size_t reserve(std::size_t size) {
    const std::size_t at = (bytes_ + kAlign - 1) / kAlign * kAlign;
    bytes_ = at + size;
    return at;
  }

  const SolverData& host_;
  const SolverData& device_;
  const std::vector<int>* slots_ = nullptr;
  std::size_t slotsAt_ = 0, bytes_ = 0;
  std::vector<Elements> elements_;
  std::vector<List> lists_;
};

}  // namespace rubble::RUBBLE_CORE
