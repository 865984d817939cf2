#pragma once
/// Arrays of state by id where the bodies have another order: copies that follow the originals, once somebody
/// has asked for them.
#include "tables/state_rows.h"

namespace rubble::RUBBLE_CORE {

/// `Buffer`: reserve(bytes), data(), size(). Where a call takes gather(to, from, bytes), it is to make
/// element `id` of `to` the element placeOf[id] of `from`, of so many bytes each.
template <class Buffer> class ArraysById {
 public:
  template <class Gather> ArrayView view(StateArray which, const SolverData& s, int bodies, Gather&& gather) {
    Buffer& buffer = buffers_[static_cast<int>(which)];
    return withStateArray(which, [&]<class T>(T* SolverData::*member) {
      buffer.reserve(sizeof(T) * static_cast<std::size_t>(bodies));
      gather(buffer.data(), s.*member, static_cast<int>(sizeof(T)));
      return rowsOf(reinterpret_cast<const T*>(buffer.data()), bodies);
    });
  }
  template <class Gather> void follow(const SolverData& s, int bodies, Gather&& gather) {
    for (int k = 0; k < kArrays; ++k)
      if (buffers_[k].size() > 0) view(static_cast<StateArray>(k), s, bodies, gather);
  }

 private:
  static constexpr int kArrays = static_cast<int>(StateArray::Torque) + 1;
  Buffer buffers_[kArrays];
};

}  // namespace rubble::RUBBLE_CORE
