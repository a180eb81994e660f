#include "ground_truth/frame_times.h"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/mapped_file.h"
#include "base/text.h"
#include "base/utf8.h"
#include "ground_truth/numbers.h"
#include "images/sequence.h"
#include "images/video_reader.h"

namespace vpr {
namespace {

/// In which a video has a byte that no text has.
constexpr size_t kStartBytes = 65536;

/// The column of times by a header's names; 0 where none is called so.
size_t time_column(const std::vector<std::string_view>& header) {
  for (const std::string_view name : {"time", "timestamp", "time_s", "timestamp_ns"})
    for (size_t i = 0; i < header.size(); ++i)
      if (header[i] == name) return i;
  return 0;
}

bool is_text(const std::filesystem::path& path) {
  const MappedFile file(path);
  return file.text().substr(0, kStartBytes).find('\0') == std::string_view::npos;
}

}  // namespace

int64_t read_time(const FileLocation& location, std::string_view text, TimeUnit unit) {
  const auto time = parse_time(text, unit);
  if (!time) location.fail(fmt::format("\"{}\" is no time", text));
  return *time;
}

void refuse_time_order(const FileLocation& location, int64_t before, int64_t time) {
  location.fail(fmt::format(
      "its time {} {}; times must rise", time_text(time),
      time == before ? "is that of the frame before"
                     : fmt::format("is before that of the frame before, {}", time_text(before))));
}

std::vector<int64_t> read_time_list(const std::filesystem::path& path) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  const MappedFile file(source.path);
  FileLocation location{path.string()};
  std::vector<int64_t> times;
  std::optional<TimeUnit> unit;
  std::optional<int64_t> before;
  bool is_first = true;
  size_t column = 0;
  size_t line_number = 0;
  size_t index = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text()))) {
    ++line_number;
    const auto cells = cells_of(line);
    if (cells.empty() || cells[0].starts_with('#')) continue;
    location.at("line", line_number);
    if (std::exchange(is_first, false) && !unit_of_time(cells[0])) {
      column = time_column(cells);  // a header
      continue;
    }
    if (column >= cells.size()) location.fail("has no time");
    if (!unit) unit = unit_of_time(cells[column]);
    if (!unit) location.fail(fmt::format("\"{}\" is no time", cells[column]));
    const int64_t time = read_time(location, cells[column], *unit);
    if (before && time <= *before) refuse_time_order(location, *before, time);
    before = time;
    if (frame_in_range(source.range, index++)) times.push_back(time);
  }
  if (times.empty()) location.fail("has no times");
  return times;
}

std::vector<int64_t> times_of_names(const Sequence& sequence) {
  FileLocation location;
  std::vector<int64_t> times;
  std::optional<TimeUnit> unit;
  for (const std::filesystem::path& file : sequence.files) {
    location.file = file.string();
    const std::string name = file.stem().string();
    if (!unit) unit = unit_of_time(name);
    if (!unit)
      location.fail(
          fmt::format("its name \"{}\" is not a time; scripts/convert/exif.py lists when "
                      "JPEG images were taken",
                      name));
    const int64_t time = read_time(location, name, *unit);
    if (!times.empty() && time <= times.back()) refuse_time_order(location, times.back(), time);
    times.push_back(time);
  }
  return times;
}

std::vector<int64_t> read_frame_times(const std::filesystem::path& path, const Monitor& monitor) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  std::error_code error;
  if (std::filesystem::is_directory(source.path, error))
    return times_of_names(open_sequence(source));
  if (is_text(source.path)) return read_time_list(path);
  return read_video_times(source, monitor);
}

}  // namespace vpr
