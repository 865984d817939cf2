#pragma once
/// Rows of a state array in host memory.
#include <utility>
#include <vector>

#include <rubble/arrays.h>

namespace rubble::test {

class HostRows {
 public:
  /// `values`: `numbers` of them for each row.
  HostRows(std::vector<int> rows, std::vector<double> values, int numbers)
      : rows_(std::move(rows)), values_(std::move(values)), numbers_(numbers) {}
  ArrayView rows() const { return packedArray(rows_.data(), std::ssize(rows_)); }
  ArrayView values() const { return packedArray(values_.data(), std::ssize(rows_), numbers_); }

 private:
  std::vector<int> rows_;
  std::vector<double> values_;
  int numbers_;
};

}  // namespace rubble::test
