#include "database/imported.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/npy.h"
#include "base/parallel.h"
#include "base/text.h"
#include "database/frame_descriptors.h"

namespace vpr {
namespace {

constexpr std::array<std::string_view, 5> kTypes = {"<f2", "<f4", "<f8", "|u1", "|b1"};

const NumberType& number_type(const std::string& type, const std::string& path) {
  if (std::ranges::find(kTypes, type) == kTypes.end())
    throw Error(ErrorKind::data,
                "{}: holds numbers of type {}; descriptors are float16, float32 or float64, or "
                "uint8 or bool (bits)",
                path, type);
  return *find_number_type(type);
}

[[noreturn]] void refuse_shape(const std::string& path, const std::vector<size_t>& shape,
                               const char* expected) {
  throw Error(ErrorKind::data, "{}: expected {}, found the shape ({})", path, expected,
              fmt::join(shape, ", "));
}

// The length of the only descriptor in a file.
size_t length_of_one(const NpyArray& array, const std::string& path) {
  const std::vector<size_t>& shape = array.shape();
  const bool is_one = shape.size() == 1 || (shape.size() == 2 && shape[0] == 1);
  if (!is_one || shape.back() == 0) refuse_shape(path, shape, "one descriptor, d or 1 x d values");
  return shape.back();
}

constexpr size_t kBlockNumbers = 1 << 16;  // values read at once: half a megabyte

double largest_size(std::span<const double> vector) {
  double largest = 0;
  for (const double number : vector) largest = std::max(largest, std::abs(number));
  return largest;
}

template <class T>
void store_numbers(std::span<const double> row, std::span<uint8_t> out) {
  std::vector<T> numbers(row.size());
  quantize_numbers(row, numbers);
  std::memcpy(out.data(), numbers.data(), out.size());
}

// Values of 8 bits, least significant first, or of 1 bit.
void store_bits(std::span<const double> row, size_t bits_per_value, std::span<uint8_t> out) {
  std::ranges::fill(out, uint8_t{0});
  for (size_t i = 0; i < row.size(); ++i) {
    if (bits_per_value == 8)
      out[i] = static_cast<uint8_t>(row[i]);
    else if (row[i] != 0)
      out[i / 8] = static_cast<uint8_t>(out[i / 8] | 1U << i % 8);
  }
}

// The maximum length of a point before its coordinates are rounded.
double longest_point(size_t length) {
  return kLongestPoint - std::sqrt(static_cast<double>(length)) / 2;
}

double length_of(std::span<const double> vector) {
  const double largest = largest_size(vector);
  if (largest == 0) return 0;
  double squares = 0;
  for (const double number : vector) squares += number / largest * (number / largest);
  return largest * std::sqrt(squares);
}

void store_point(std::span<const double> row, double unit, std::span<uint8_t> out) {
  std::vector<int16_t> numbers;
  for (const double number : row)
    numbers.push_back(static_cast<int16_t>(std::nearbyint(number / unit)));
  std::memcpy(out.data(), numbers.data(), out.size());
}

// Scales before it squares: values may be as large or as small as double allows.
void store_direction(std::span<const double> row, double unit, std::span<uint8_t> out) {
  const double largest = largest_size(row);
  std::vector<double> scaled;
  for (const double number : row) scaled.push_back(number / largest);
  store_point(scaled, unit * length_of(scaled), out);
}

void check_point(std::span<const double> row, double unit, const std::string& where) {
  check_numbers(row, where);
  constexpr double kRounding = 1e-9;
  if (length_of(row) > unit * longest_point(row.size()) * (1 + kRounding))
    throw Error(ErrorKind::data,
                "{}: is more than twice as long as the longest vector that the database was "
                "trained with; use the same descriptor",
                where);
}

/// The conversion of numbers to rows of one kind.
struct RowImport {
  size_t elements_per_value = 1;
  std::function<void(std::span<const double> row, std::span<uint8_t> out)> store;
  /// only of vectors, which are missing if all values are NaN
  std::function<void(std::span<const double> row, const std::string& where)> check = {};
  bool needs_direction = false;  ///< so vectors of zeros can only be skipped
};

bool is_zero_vector(std::span<const double> vector) {
  return std::ranges::all_of(vector, [](double number) { return number == 0; });
}

RowImport import_of(std::string_view kind, const ArrayRows& rows, double unit) {
  const bool is_bits = kind == kBitKind;
  if (rows.type().starts_with("<f") == is_bits)
    throw Error(ErrorKind::data, "{}: its values are of type {}; {}", rows.where(0), rows.type(),
                is_bits
                    ? "bits are uint8 (8 bits per value) or bool"
                    : "vectors are float16, float32 or float64. If its values are numbers, save "
                      "them as float32; if they are bits, train with --bits");
  const size_t bits = rows.type() == "|u1" ? 8 : 1;  // per value
  const size_t most = is_bits ? kMaxBits / bits : kMaxIntegers;
  if (rows.length() > most)
    throw Error(ErrorKind::data, "{}: has {} values; the maximum is {}", rows.where(0),
                rows.length(), most);
  if (is_bits) return {bits, [bits](auto row, auto out) { store_bits(row, bits, out); }};
  if (kind == kPointKind)
    return {1, [unit](auto row, auto out) { store_point(row, unit, out); },
            [unit](auto row, const std::string& where) { check_point(row, unit, where); }};
  if (kind == kDirectionKind)
    return {1, [unit](auto row, auto out) { store_direction(row, unit, out); }, check_vector, true};
  if (kind == kNarrowVectorKind) return {1, store_numbers<int8_t>, check_vector, true};
  return {1, store_numbers<int16_t>, check_vector, true};
}

// Writes the descriptors of all rows that are not missing.
void import_rows(const ArrayRows& rows, const RowImport& import, Unreadable unreadable,
                 const Monitor& monitor, std::span<uint8_t> out, std::vector<uint8_t>& is_missing) {
  const size_t row_bytes = out.size() / rows.count();
  const size_t block = std::max<size_t>(kBlockNumbers / rows.length(), 1);
  const size_t blocks = (rows.count() + block - 1) / block;
  std::vector<std::optional<Error>> errors(blocks);
  StepCounter counter(monitor, "import", rows.count());
  const auto import_row = [&](size_t i, std::span<const double> row) {
    const bool is_zero = import.needs_direction && is_zero_vector(row);
    is_missing[i] = is_zero || (import.check && is_missing_vector(row)) ? 1 : 0;
    if (is_missing[i] != 0 && unreadable == Unreadable::fail)
      throw Error(ErrorKind::data, "{} is {}; use --skip-unreadable to ignore it", rows.where(i),
                  is_zero ? "a vector of zeros, which has no direction" : "missing (all NaN)");
    if (is_missing[i] != 0) return;
    if (import.check) import.check(row, rows.where(i));
    import.store(row, out.subspan(i * row_bytes, row_bytes));
  };
  parallel_for(blocks, monitor, [&](size_t b) {
    const size_t first = b * block;
    const size_t count = std::min(block, rows.count() - first);
    std::vector<double> numbers(count * rows.length());
    try {
      rows.read(first, count, numbers);
      for (size_t i = 0; i < count; ++i)
        import_row(first + i, std::span(numbers).subspan(i * rows.length(), rows.length()));
    } catch (const Error& error) {
      errors[b] = error;
    }
    counter.add(count);
  });
  for (const auto& error : errors)  // the first error, for any order of threads
    if (error) throw Error(*error);
}

}  // namespace

std::string_view imported_kind(bool are_bits, const ImportSettings& settings) {
  const auto& [metric, value_bits] = settings;
  if (value_bits != 8 && value_bits != 16)
    throw Error(ErrorKind::usage, "--value-bits must be 16 or 8 bits per value, found {}",
                value_bits);
  const bool is_cosine = metric == DescriptorMetric::cosine;
  if (are_bits && (value_bits != 16 || !is_cosine))
    throw Error(ErrorKind::usage, "--value-bits and --metric have no effect on --bits; omit them");
  if (!is_cosine && value_bits != 16)
    throw Error(ErrorKind::usage, "--metric {} needs 16 bits per value; omit --value-bits",
                enum_name(metric));
  if (are_bits) return kBitKind;
  if (!is_cosine) return metric == DescriptorMetric::l2 ? kPointKind : kDirectionKind;
  return value_bits == 16 ? kVectorKind : kNarrowVectorKind;
}

std::string_view imported_kind(const SequenceSource& sequence, const ImportSettings& settings,
                               const Monitor& monitor) {
  const ArrayRows rows(sequence);
  warn_of_bytes(sequence, rows, monitor);
  return imported_kind(rows.type().starts_with('|'), settings);
}

void warn_of_bytes(const SequenceSource& sequence, const ArrayRows& rows, const Monitor& monitor) {
  if (rows.type() == "|u1")
    warn(monitor,
         "{}: uint8 values are compared as bits (Hamming distance). If they are numbers, save them "
         "as float32",
         sequence.argument.path.string());
}

size_t rows_in_range(const SequenceArgument& argument, size_t all) {
  const uint64_t last = argument.range.last.value_or(all);
  if (argument.range.first >= all || last > all)
    throw Error(ErrorKind::usage, "{}: has {}, which the range {} exceeds", argument.path.string(),
                counted(all, "row"), range_text(argument.range));
  return frame_count({argument.range.first, last, argument.range.step}).value();
}

ArrayRows::ArrayRows(const SequenceSource& sequence) : sequence_(sequence) {
  assert(sequence.kind == SequenceKind::descriptors);
  const std::string path = sequence.files.front().string();
  array_ = sequence.argument.array;
  if (!array_) array_ = std::make_shared<const NpyArray>(sequence.files.front());
  type_ = &number_type(array_->type(), path);
  if (!sequence.is_one_array()) {
    length_ = length_of_one(*array_, path);
    count_ = sequence.files.size();
    return;
  }
  const std::vector<size_t>& shape = array_->shape();
  if (shape.size() != 2 || shape[0] == 0 || shape[1] == 0)
    refuse_shape(path, shape, "n x d values, one row per frame");
  length_ = shape[1];
  count_ = rows_in_range(sequence.argument, shape[0]);
}

std::shared_ptr<const NpyArray> ArrayRows::array_in_memory() const {
  const SequenceArgument& argument = sequence_.argument;
  const bool is_whole = argument.range.is_all() && argument.sequence.selection.is_all();
  return is_whole && !array_->is_column_major() ? argument.array : nullptr;
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
  if (!sequence_.is_one_array()) {
    for (size_t row = 0; row < count; ++row) {
      const std::string path = where(first + row);
      const NpyArray file(sequence_.files[first + row]);
      if (file.type() != type() || length_of_one(file, path) != length_)
        throw Error(ErrorKind::data, "{}: holds {} values of type {}, but the first file {} of {}",
                    path, file.shape().back(), file.type(), length_, type());
      type_->read(file.value_bytes().data(), type_->bytes, length_, out.data() + row * length_, 1);
    }
    return;
  }
  const std::byte* values = array_->value_bytes().data();
  const size_t rows = array_->shape()[0];
  if (array_->is_column_major()) {  // the values of one column are contiguous
    const size_t step = sequence_.argument.range.step * type_->bytes;
    for (size_t x = 0; x < length_; ++x)
      type_->read(values + (x * rows + recorded(first)) * type_->bytes, step, count, out.data() + x,
                  length_);
    return;
  }
  const size_t row_bytes = length_ * type_->bytes;
  for (size_t row = 0; row < count; ++row)
    type_->read(values + recorded(first + row) * row_bytes, type_->bytes, length_,
                out.data() + row * length_, 1);
  array_->forget_values(recorded(first) * row_bytes,
                        (recorded(first + count - 1) - recorded(first) + 1) * row_bytes);
}

bool is_missing_vector(std::span<const double> vector) {
  return std::ranges::all_of(vector, [](double number) { return std::isnan(number); });
}

void check_numbers(std::span<const double> vector, const std::string& where) {
  const auto bad =
      std::ranges::find_if(vector, [](double number) { return !std::isfinite(number); });
  if (bad != vector.end())
    throw Error(ErrorKind::data, "{}: value {} is {}", where, bad - vector.begin(), *bad);
}

void check_vector(std::span<const double> vector, const std::string& where) {
  check_numbers(vector, where);
  if (is_zero_vector(vector))
    throw Error(ErrorKind::data,
                "{}: is a vector of zeros, which has no direction. Save a missing one as NaN",
                where);
}

void quantize_numbers(std::span<const double> vector, std::span<int8_t> out) {
  const double largest = largest_size(vector);
  for (size_t i = 0; i < vector.size(); ++i)
    out[i] = static_cast<int8_t>(std::nearbyint(vector[i] / largest * 127));
}

void quantize_numbers(std::span<const double> vector, std::span<int16_t> out) {
  const double largest = largest_size(vector);
  double squares = 0;
  for (const double number : vector) squares += number / largest * (number / largest);
  const double rounding = std::sqrt(static_cast<double>(vector.size())) / 2;
  const double scale = std::min(32767.0, (46340 - rounding) / std::sqrt(squares));
  for (size_t i = 0; i < vector.size(); ++i)
    out[i] = static_cast<int16_t>(std::nearbyint(vector[i] / largest * scale));
}

double coordinate_unit(std::string_view kind, std::span<const SequenceSource> sequences,
                       const Monitor& monitor) {
  if (kind == kDirectionKind) return 1 / longest_point(ArrayRows(sequences.front()).length());
  double unit = 0;
  for (const SequenceSource& sequence : sequences) {
    const ArrayRows rows(sequence);
    import_of(kind, rows, 0);
    std::vector<double> lengths(rows.count(), 0);
    parallel_for(rows.count(), monitor, [&](size_t i) {
      std::vector<double> row(rows.length());
      rows.read(i, 1, row);
      if (is_missing_vector(row)) return;
      check_numbers(row, rows.where(i));
      lengths[i] = length_of(row);
    });
    for (size_t i = 0; i < lengths.size(); ++i)
      if (!std::isfinite(2 * lengths[i]))
        throw Error(ErrorKind::data, "{}: is too long for Euclidean distances", rows.where(i));
    const double longest = *std::ranges::max_element(lengths);
    unit = std::max(unit, 2 * longest / longest_point(rows.length()));
  }
  return unit > 0 ? unit : 1;
}

DescriptorSet import_descriptors(const SequenceSource& source, std::string_view kind,
                                 Unreadable unreadable, const Monitor& monitor, double unit) {
  const ArrayRows rows(source);
  const RowImport import = import_of(kind, rows, unit);
  const DescriptorKind* described = find_descriptor_kind(kind);
  const ElementType element = described->shape.element;
  const DescriptorShape shape{element, rows.length() * import.elements_per_value};
  DescriptorSet set;
  set.descriptors.kind = described;
  set.descriptors.length = shape.length;
  set.descriptors.unit = unit;
  std::vector<uint8_t> is_missing(rows.count(), 0);  // the descriptors of missing rows stay zero
  const bool are_stored = element == ElementType::bits && rows.length() == shape.row_bytes();
  if (are_stored) set.descriptors.array = rows.array_in_memory();
  if (!set.descriptors.array) {
    set.descriptors.owned.resize(rows.count() * shape.row_bytes());
    import_rows(rows, import, unreadable, monitor, set.descriptors.owned, is_missing);
  }
  set.sequence = source.argument.sequence;
  set.sequence.frames = rows.count();
  for (size_t i = 0; i < rows.count(); ++i)
    if (is_missing[i] != 0) set.sequence.unreadable.push_back(i);
  for (size_t row = 0; row < rows.count(); ++row)
    set.sequence.frame_names.push_back(rows.name(row));
  if (set.sequence.unreadable.size() == rows.count())
    throw Error(ErrorKind::data, "{}: none of its {} can be read", source.argument.path.string(),
                counted(rows.count(), "row"));
  if (!source.is_one_array()) return set;
  const Selection selection = std::exchange(set.sequence.selection, {});  // of rows, all read above
  return selected(std::move(set), selection);
}

}  // namespace vpr
