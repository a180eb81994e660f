#include "base/npy.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/converters.h"
#include "base/error.h"
#include "base/named_table.h"

namespace vpr {

namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr size_t kMaxHeader = 65536;

// The text between `before` and `after` in a header; nullopt if either is missing.
std::optional<std::string_view> between(std::string_view text, std::string_view before,
                                        std::string_view after) {
  const size_t start = text.find(before);
  if (start == std::string_view::npos) return std::nullopt;
  text.remove_prefix(start + before.size());
  const size_t end = text.find(after);
  if (end == std::string_view::npos) return std::nullopt;
  return text.substr(0, end);
}

// The contents of the parentheses of "(3, 4)": 3, 4; a trailing comma is allowed.
std::optional<std::vector<size_t>> parse_shape(std::string_view text) {
  std::vector<size_t> shape;
  while (!text.empty()) {
    size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) return std::nullopt;
    shape.push_back(value);
    text.remove_prefix(static_cast<size_t>(end - text.data()));
    while (!text.empty() && (text.front() == ' ' || text.front() == ',')) text.remove_prefix(1);
  }
  return shape;
}

constexpr int64_t kMaxExact = int64_t{1} << 53;

/// IEEE 754's 16-bit format.
struct Half {
  uint16_t bits;
};

double number(Half half) {
  const double sign = half.bits >> 15 != 0 ? -1 : 1;
  const int exponent = half.bits >> 10 & 31;
  const int fraction = half.bits & 1023;
  if (exponent == 31)
    return fraction != 0 ? std::numeric_limits<double>::quiet_NaN()
                         : sign * std::numeric_limits<double>::infinity();
  return sign *
         (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25));
}

template <class T>
double number(T value) {
  if constexpr (std::is_integral_v<T> && sizeof(T) == 8) {
    if (!std::cmp_less_equal(value, kMaxExact) || !std::cmp_greater_equal(value, -kMaxExact))
      throw Error(
          ErrorKind::data,
          "there are integers beyond 2^53, which float64 cannot represent; scale them down first");
  }
  return static_cast<double>(value);
}

template <class T>
void read_numbers(const std::byte* from, size_t stride, size_t count, double* out,
                  size_t out_stride) {
  for (size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, from + i * stride, sizeof(T));
    out[i * out_stride] = number(value);
  }
}

template <class T>
constexpr NumberType row(std::string_view name) {
  return {name, sizeof(T), std::is_integral_v<T>, read_numbers<T>};
}

constexpr std::array<NumberType, 12> kTypes = {
    row<Half>("<f2"),     row<float>("<f4"),   row<double>("<f8"),   row<uint8_t>("|b1"),
    row<uint8_t>("|u1"),  row<int8_t>("|i1"),  row<uint16_t>("<u2"), row<int16_t>("<i2"),
    row<uint32_t>("<u4"), row<int32_t>("<i4"), row<uint64_t>("<u8"), row<int64_t>("<i8")};

}  // namespace

std::optional<NpyHeader> parse_npy_header(std::string_view file) {
  if (file.size() < 10 || file.substr(0, 6) != kMagic) return std::nullopt;
  const auto byte = [&](size_t i) { return static_cast<size_t>(static_cast<uint8_t>(file[i])); };
  const size_t version = byte(6);
  if (version < 1 || version > 3) return std::nullopt;
  const size_t start = version == 1 ? 10 : 12;
  if (file.size() < start) return std::nullopt;
  size_t length = byte(8) | byte(9) << 8;
  if (version > 1) length |= byte(10) << 16 | byte(11) << 24;
  if (length > kMaxHeader || length > file.size() - start) return std::nullopt;
  const std::string_view text = file.substr(start, length);
  const auto type = between(text, "'descr': '", "'");
  const auto order = between(text, "'fortran_order': ", ",");
  const auto shape_text = between(text, "'shape': (", ")");
  if (!type || (order != "False" && order != "True") || !shape_text) return std::nullopt;
  const auto shape = parse_shape(*shape_text);
  if (!shape) return std::nullopt;
  return NpyHeader{std::string(*type), *shape, order == "True" && shape->size() > 1,
                   start + length};
}

std::string npy_header(std::string_view type, const std::vector<size_t>& shape,
                       bool is_column_major) {
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': ({}{}), }}", type,
                                 is_column_major ? "True" : "False", fmt::join(shape, ", "),
                                 shape.size() == 1 ? "," : "");
  const size_t total = (10 + text.size() + 1 + 63) / 64 * 64;
  text.append(total - 10 - text.size() - 1, ' ');
  text += '\n';
  std::string header(kMagic);
  header +=
      {'\x01', '\x00', static_cast<char>(text.size() & 0xff), static_cast<char>(text.size() >> 8)};
  return header + text;
}

NpyArray::NpyArray(const std::filesystem::path& path) : name_(path.string()), file_(path) {
  const auto header = parse_npy_header(file_.text());
  if (!header) refuse_convertible(path, file_.text().substr(0, kMaxNpyHeader), true);
  const NumberType* const type = &number_type_of(name_, header);
  size_t bytes = type->bytes;
  bool overflow = false;
  for (const size_t extent : header->shape)
    overflow = __builtin_mul_overflow(bytes, extent, &bytes) || overflow;
  const size_t found = file_.bytes().size() - header->offset;
  if (overflow || bytes != found)
    throw Error(ErrorKind::data,
                "{}: its shape ({}) does not fit the {} bytes that follow; the file is truncated "
                "or damaged",
                name_, fmt::join(header->shape, ", "), found);
  if (header->offset % type->bytes != 0)
    throw Error(ErrorKind::data, "{}: its values are not aligned", name_);
  header_ = *header;
  values_ = file_.bytes().subspan(header_.offset);
  count_ = bytes / type->bytes;
}

NpyArray::NpyArray(const std::string& name, NpyHeader header, std::span<const std::byte> values)
    : name_(name), header_(std::move(header)), values_(values) {
  count_ = values.size() / number_type_of(name_, header_).bytes;
}

std::string NpyArray::header_bytes() const {
  if (file_.bytes().empty()) return npy_header(type(), shape(), is_column_major());
  return std::string(file_.text().substr(0, header_.offset));
}

void NpyArray::require(std::string_view type, size_t dimensions) const {
  if (header_.type != type || shape().size() != dimensions)
    throw Error(ErrorKind::data, "{}: expected {} dimensions of type {}, found {} of type {}",
                name_, dimensions, type, shape().size(), header_.type);
  if (is_column_major())
    throw Error(ErrorKind::data,
                "{}: is in Fortran order; save it in C order, as with numpy.ascontiguousarray",
                name_);
}

const NumberType& number_type_of(const std::string& name, const std::optional<NpyHeader>& header) {
  if (!header) throw Error(ErrorKind::data, "{}: is not a .npy array of numbers", name);
  const std::string& type = header->type;
  if (const NumberType* const found = find_number_type(type)) return *found;
  throw Error(ErrorKind::data, "{}: values of type {} are not supported. Save {}", name, type,
              type.starts_with('>') ? fmt::format("array.astype(\"<{}\")", type.substr(1))
                                    : "an array of numbers");
}

const NumberType* find_number_type(std::string_view name) { return find_in(kTypes, name); }

}  // namespace vpr
