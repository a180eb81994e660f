// A non-owning view of a matrix.
#pragma once

#include <cassert>
#include <cstddef>
#include <span>

namespace vpr {

/// Row-major; consecutive rows are `stride` values apart.
template <class T>
struct MatrixView {
  T* data = nullptr;
  size_t rows = 0;
  size_t cols = 0;
  size_t stride = 0;

  MatrixView() = default;
  MatrixView(T* values, size_t row_count, size_t col_count)
      : data(values), rows(row_count), cols(col_count), stride(col_count) {}

  std::span<T> row(size_t r) const {
    assert(r < rows);
    return {data + r * stride, cols};
  }
  T& operator()(size_t r, size_t c) const {
    assert(r < rows && c < cols);
    return data[r * stride + c];
  }
};

}  // namespace vpr
