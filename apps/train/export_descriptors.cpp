// vpr-train export --descriptors: the descriptors of a database for other programs.
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/npy.h"
#include "base/text.h"
#include "present/database_report.h"
#include "run/train.h"
#include "train_inputs.h"

namespace vpr {
namespace {

// Whole numbers are the same as float32.
template <class T>
std::vector<std::byte> as_floats(DescriptorRow row) {
  std::vector<std::byte> bytes;
  for (size_t i = 0; i < row.size(); i += sizeof(T)) {
    T number;
    std::memcpy(&number, row.data() + i, sizeof(T));
    const auto value = static_cast<float>(number);
    const auto* first = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof(value));
  }
  return bytes;
}

// Coordinates are numbers of their unit.
std::vector<std::byte> as_points(DescriptorRow row, double unit) {
  std::vector<float> values;
  for (size_t i = 0; i < row.size(); i += sizeof(int16_t)) {
    int16_t number = 0;
    std::memcpy(&number, row.data() + i, sizeof(number));
    values.push_back(static_cast<float>(number * unit));
  }
  const auto bytes = std::as_bytes(std::span(values));
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> as_bytes(DescriptorRow row, size_t count) {
  const auto* first = reinterpret_cast<const std::byte*>(row.data());
  return {first, first + count};
}

/// How rows of an element type are written.
struct ExportedRows {
  std::string_view type;
  size_t numbers = 0;  ///< of a row
};

ExportedRows layout_of(const DescriptorShape& shape) {
  switch (shape.element) {
    case ElementType::bits:
      return {npy_type<uint8_t>(), (shape.length + 7) / 8};
    case ElementType::gray_levels:
      return {npy_type<uint8_t>(), shape.length};
    case ElementType::int8:
    case ElementType::int16:
    case ElementType::points16:
    case ElementType::frame_numbers:
      break;
  }
  return {npy_type<float>(), shape.length};
}

std::vector<std::byte> exported(const DescriptorStore& store, DescriptorRow row) {
  const DescriptorShape shape = store.shape();
  switch (shape.element) {
    case ElementType::int8:
      return as_floats<int8_t>(row);
    case ElementType::int16:
      return as_floats<int16_t>(row);
    case ElementType::points16:
      return as_points(row, store.unit);
    case ElementType::bits:
    case ElementType::gray_levels:
    case ElementType::frame_numbers:
      break;
  }
  return as_bytes(row, layout_of(shape).numbers);
}

// As imports have it; numbers that can't say so stay 0.
std::vector<std::byte> missing(const ExportedRows& layout) {
  if (layout.type != npy_type<float>()) return std::vector<std::byte>(layout.numbers, std::byte{});
  const std::vector<float> none(layout.numbers, std::numeric_limits<float>::quiet_NaN());
  const auto bytes = std::as_bytes(std::span(none));
  return {bytes.begin(), bytes.end()};
}

}  // namespace

void export_descriptors(const Session& session, const std::string& path, const std::string& file) {
  if (!session.options.output.empty())
    throw Error(ErrorKind::usage, "--descriptors names the file to write; leave out -o");
  session.outputs.claim_file(file);
  const SequenceDatabase database = read_sequence_database(path);
  const ExportedRows layout = layout_of(database.descriptors.shape());
  Output& output = session.outputs.file(file);
  output.write(npy_header(layout.type, {database.descriptors.rows().size(), layout.numbers}));
  for (const DescriptorSpan& sequence : descriptor_spans(database)) {
    auto unreadable = sequence.unreadable.begin();
    for (size_t i = 0; i < sequence.rows.size(); ++i) {
      const bool is_missing = unreadable != sequence.unreadable.end() && *unreadable == i;
      if (is_missing) ++unreadable;
      output.write(is_missing ? missing(layout) : exported(database.descriptors, sequence.rows[i]));
    }
  }
  session.print_result(
      fmt::format("{}: {} of {} numbers, {}\n", file,
                  counted(database.descriptors.rows().size(), "row"), layout.numbers, layout.type),
      database_json(database, stored_thresholds(database, session.monitor), session.run));
}

}  // namespace vpr
