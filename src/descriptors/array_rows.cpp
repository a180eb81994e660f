#include "descriptors/array_rows.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/npy.h"
#include "base/text.h"

namespace vpr {
namespace {

constexpr std::array<std::string_view, 5> kTypes = {"<f2", "<f4", "<f8", "|u1", "|b1"};

const NumberType& number_type(const std::string& type, const std::string& path) {
  if (std::find(kTypes.begin(), kTypes.end(), type) == kTypes.end())
    throw Error(ErrorKind::data, fmt::format("{}: holds numbers of type {}; descriptors are "
                                             "float16, float32 or float64, or uint8 or bool (bits)",
                                             path, type));
  return *find_number_type(type);
}

[[noreturn]] void refuse_shape(const std::string& path, const std::vector<size_t>& shape,
                               const char* expected) {
  throw Error(ErrorKind::data, fmt::format("{}: expected {}, found the shape ({})", path, expected,
                                           fmt::join(shape, ", ")));
}

// Numbers of the one descriptor that a file holds.
size_t length_of_one(const NpyArray& array, const std::string& path) {
  const std::vector<size_t>& shape = array.shape();
  const bool is_one = shape.size() == 1 || (shape.size() == 2 && shape[0] == 1);
  if (!is_one || shape.back() == 0) refuse_shape(path, shape, "one descriptor, d or 1 x d numbers");
  return shape.back();
}

size_t rows_in_range(const SequenceArgument& argument, size_t all) {
  const uint64_t last = argument.range.last.value_or(all);
  if (argument.range.first >= all || last > all)
    throw Error(ErrorKind::usage,
                fmt::format("{}: has {}, which the range {} exceeds", argument.path.string(),
                            counted(all, "row"), range_text(argument.range)));
  return frame_count({argument.range.first, last, argument.range.step}).value();
}

}  // namespace

ArrayRows::ArrayRows(const Sequence& sequence) : sequence_(sequence) {
  assert(sequence.kind == SequenceKind::descriptors);
  const std::string path = sequence.files.front().string();
  array_ = NpyArray(sequence.files.front());
  type_ = array_.type();
  number_type(type_, path);
  if (!sequence.is_one_array()) {
    length_ = length_of_one(array_, path);
    count_ = sequence.files.size();
    return;
  }
  const std::vector<size_t>& shape = array_.shape();
  if (shape.size() != 2 || shape[0] == 0 || shape[1] == 0)
    refuse_shape(path, shape, "n x d numbers, a row a frame");
  length_ = shape[1];
  count_ = rows_in_range(sequence.argument, shape[0]);
}

size_t ArrayRows::recorded(size_t row) const {
  return sequence_.argument.range.first + row * sequence_.argument.range.step;
}

std::string ArrayRows::name(size_t row) const {
  return sequence_.is_one_array() ? fmt::format("#{}", recorded(row))
                                  : sequence_.files[row].filename().string();
}

std::string ArrayRows::where(size_t row) const {
  return sequence_.is_one_array()
             ? fmt::format("{}: row {}", sequence_.argument.path.string(), recorded(row))
             : sequence_.files[row].string();
}

void ArrayRows::read(size_t first, size_t count, std::span<double> out) const {
  assert(first + count <= count_ && out.size() >= count * length_);
  const NumberType& type = number_type(type_, sequence_.argument.path.string());
  if (!sequence_.is_one_array()) {
    for (size_t row = 0; row < count; ++row) {
      const std::string path = where(first + row);
      const NpyArray file(sequence_.files[first + row]);
      if (file.type() != type_ || length_of_one(file, path) != length_)
        throw Error(ErrorKind::data,
                    fmt::format("{}: holds {} numbers of type {}, and the first file {} of {}",
                                path, file.shape().back(), file.type(), length_, type_));
      type.read(file.value_bytes().data(), type.bytes, length_, out.data() + row * length_, 1);
    }
    return;
  }
  const std::byte* values = array_.value_bytes().data();
  const size_t rows = array_.shape()[0];
  if (array_.is_column_major()) {  // column by column: the rows of a column lie side by side
    const size_t step = sequence_.argument.range.step * type.bytes;
    for (size_t x = 0; x < length_; ++x)
      type.read(values + (x * rows + recorded(first)) * type.bytes, step, count, out.data() + x,
                length_);
    return;
  }
  const size_t row_bytes = length_ * type.bytes;
  for (size_t row = 0; row < count; ++row)
    type.read(values + recorded(first + row) * row_bytes, type.bytes, length_,
              out.data() + row * length_, 1);
  array_.forget_values(recorded(first) * row_bytes,
                       (recorded(first + count - 1) - recorded(first) + 1) * row_bytes);
}

}  // namespace vpr
