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
  ArrayView rows() const { return view(rows_.data(), "<i4", sizeof(int), 1); }
  ArrayView values() const { return view(values_.data(), "<f8", sizeof(double), numbers_); }

 private:
  ArrayView view(const void* data, const char* type, std::int64_t size, int columns) const {
    ArrayView out;
    out.data = data, out.typestr = type;
    out.shape[0] = static_cast<std::int64_t>(rows_.size()), out.shape[1] = columns;
    out.strides[0] = size * columns, out.strides[1] = size;
    return out;
  }

  std::vector<int> rows_;
  std::vector<double> values_;
  int numbers_;
};

}  // namespace rubble::test
