#include "ground_truth/npy_stream.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "base/mapped_file.h"

namespace vpr {
namespace {

// Values 0 and 1 of a row; the index of the first that is another.
template <class T>
size_t take_bits(std::span<const std::byte> bytes, std::span<uint8_t> values) {
  for (size_t i = 0; i < values.size(); ++i) {
    T value;
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    if (!(value == T{0} || value == T{1})) return i;
    values[i] = value == T{1} ? 1 : 0;
  }
  return values.size();
}

struct BitType {
  std::string_view name;
  size_t (*take)(std::span<const std::byte>, std::span<uint8_t>);
};

const BitType* find_type(std::string_view name) {
  static constexpr BitType kTypes[] = {
      {"|b1", take_bits<uint8_t>},  {"|u1", take_bits<uint8_t>},  {"|i1", take_bits<int8_t>},
      {"<u2", take_bits<uint16_t>}, {"<i2", take_bits<int16_t>},  {"<u4", take_bits<uint32_t>},
      {"<i4", take_bits<int32_t>},  {"<u8", take_bits<uint64_t>}, {"<i8", take_bits<int64_t>},
      {"<f4", take_bits<float>},    {"<f8", take_bits<double>}};
  for (const BitType& type : kTypes)
    if (type.name == name) return &type;
  return nullptr;
}

}  // namespace

NpyStream::NpyStream(const std::filesystem::path& path) : location_{path.string()} {
  const auto file = std::make_shared<MappedFile>(path);
  fill_ = [file, at = size_t{0}](std::span<std::byte> bytes) mutable {
    const size_t count = std::min(bytes.size(), file->bytes().size() - at);
    std::copy_n(file->bytes().begin() + static_cast<ptrdiff_t>(at), count, bytes.begin());
    at += count;
    return count;
  };
  open();
}

NpyStream::NpyStream(ZipFile& archive, size_t index, const std::string& where) : location_{where} {
  const auto entry = std::make_shared<ZipFile::Entry>(archive, index);
  fill_ = [entry](std::span<std::byte> bytes) { return entry->read(bytes); };
  open();
}

void NpyStream::read_bytes(std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const size_t count = fill_(bytes);
    if (count == 0) location_.fail("ends early; the file is truncated or damaged");
    bytes = bytes.subspan(count);
  }
}

void NpyStream::open() {
  constexpr size_t kFixed = 10;  // magic, version and, for version 1, the length of the rest
  std::string start(kFixed, '\0');
  const auto read_to = [&](size_t size) {
    const size_t before = start.size();
    if (size <= before) return;
    start.resize(size);
    read_bytes(std::as_writable_bytes(std::span(start)).subspan(before));
  };
  read_bytes(std::as_writable_bytes(std::span(start)));
  const auto byte = [&](size_t i) { return size_t{static_cast<uint8_t>(start[i])}; };
  size_t length = byte(8) | byte(9) << 8;
  if (byte(6) == 1) {
    read_to(kFixed + length);
  } else {
    read_to(kFixed + 2);
    length |= byte(10) << 16 | byte(11) << 24;
    if (length <= kMaxNpyHeader) read_to(kFixed + 2 + length);
  }
  const auto header = parse_npy_header(start);
  if (!header || find_type(header->type) == nullptr || header->shape.size() != 2)
    location_.fail("is no matrix of bool, integers or floats, little-endian (.npy)");
  header_ = *header;
  rows_ = header_.shape[header_.is_column_major ? 1 : 0];
  cols_ = header_.shape[header_.is_column_major ? 0 : 1];
}

void NpyStream::next_row(std::span<uint8_t> values) {
  row_.resize(cols_ * *npy_value_size(header_.type));
  read_bytes(row_);
  location_.at("row", row_number_++);
  const size_t good = find_type(header_.type)->take(row_, values);
  if (good < values.size())
    location_.fail(fmt::format("column {} is neither 0 nor 1; is it a ground truth?", good));
}

void NpyStream::require_end() {
  std::byte more{};
  location_.at({}, 0);
  if (fill_({&more, 1}) != 0) location_.fail("is longer than its shape says");
}

}  // namespace vpr
