#pragma once
/// State arrays in the order of ids, for backends whose bodies are sorted in another order. A copy is made at
/// the first request and updated from then on.
#include "tables/state_rows.h"

namespace rubble::RUBBLE_CORE {

/// `Buffer` has reserve(bytes), data() and size(). A parameter gather(to, from, bytes) copies element
/// placeOf[id] of `from` to element `id` of `to`, `bytes` per element.
template <class Buffer> class ArraysById {
 public:
  template <class Gather> ArrayView view(StateArray which, const SolverData& s, int bodies, Gather&& gather) {
    Buffer& buffer = buffers_[static_cast<int>(which)];
    return withStateArray(which, [&]<class T>(Array<T> SolverData::*member) {
      buffer.reserve(sizeof(T) * static_cast<std::size_t>(bodies));
      gather(buffer.data(), s.*member, static_cast<int>(sizeof(T)));
      return rowsOf(reinterpret_cast<const T*>(buffer.data()), bodies);
    });
  }
  template <class Gather> void follow(const SolverData& s, int bodies, Gather&& gather) {
    for (int k = 0; k < kArrays; ++k) {
      const auto which = static_cast<StateArray>(k);
      // a view from before bodies were added is invalid, so that no memory is needed here
      const bool fits = withStateArray(which, [&]<class T>(Array<T> SolverData::*) {
        return buffers_[k].size() >= sizeof(T) * static_cast<std::size_t>(bodies);
      });
      if (fits && buffers_[k].size() > 0) view(which, s, bodies, gather);
    }
  }

 private:
  static constexpr int kArrays = static_cast<int>(StateArray::Torque) + 1;
  Buffer buffers_[kArrays];
};

}  // namespace rubble::RUBBLE_CORE
