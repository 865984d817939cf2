#pragma once
/// State arrays of tables in host memory: the tables themselves, or copies in the order of ids if the bodies
/// are sorted in another order.
#include <cstring>
#include <vector>

#include "backend/arrays_by_id.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

class HostArrays {
 public:
  explicit HostArrays(const HostTables& tables) : tables_(tables) {}

  /// Copies rows from the order of slots to that of ids.
  auto gather() const {
    return [this](std::byte* to, const void* from, int bytes) {
      const auto at = [bytes](int i) {
        return static_cast<std::size_t>(i) * static_cast<std::size_t>(bytes);
      };
      for (int id = 0; id < tables_.bodyIds; ++id)
        std::memcpy(to + at(id), static_cast<const std::byte*>(from) + at(tables_.view().placeOf[id]), at(1));
    };
  }

  ArrayView view(StateArray which) {
    const SolverData& s = tables_.view();
    if (s.ordered) return byId_.view(which, s, tables_.bodyIds, gather());
    return withStateArray(which, [&](auto member) {
      return rowsOf(firstOf(s.*member, tables_.bodyIds).data(), tables_.bodyIds);
    });
  }
  /// Updates the copies after a change of state.
  void follow() {
    if (tables_.view().ordered) byId_.follow(tables_.view(), tables_.bodyIds, gather());
  }

 private:
  struct Bytes {
    std::vector<std::byte> bytes;
    void reserve(std::size_t size) { bytes.resize(std::max(size, bytes.size())); }
    std::byte* data() { return bytes.data(); }
    std::size_t size() const { return bytes.size(); }
  };

  const HostTables& tables_;
  ArraysById<Bytes> byId_;
};

}  // namespace rubble::RUBBLE_CORE
