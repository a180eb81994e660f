#include "evaluation/travelled.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "evaluation/csv.h"
#include "evaluation/route.h"

namespace vpr {
namespace {

template <class T>
T number_of(const std::string& text, const std::string& place) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(double(value)))
    throw Error(ErrorKind::data, fmt::format("{}: \"{}\" is not a number that fits", place, text));
  return value;
}

}  // namespace

std::vector<double> read_travelled(const std::filesystem::path& path, size_t frames) {
  const std::string where = path.string();
  const MappedFile file(path);
  const std::vector<CsvRow> rows = parse_csv(file.text(), where);
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::data, fmt::format("{}: {}", where, what));
  };
  const auto columns = rows.empty() ? std::nullopt : find_pose_columns(rows[0].fields);
  if (!columns) fail("expected a header with the columns frame, x and y");
  std::vector<std::optional<std::pair<double, double>>> positions(frames);
  for (size_t r = 1; r < rows.size(); ++r) {
    const std::string place = fmt::format("{}, line {}", where, rows[r].line);
    const auto& fields = rows[r].fields;
    if (fields.size() != rows[0].fields.size())
      fail(fmt::format("line {}: expected {} columns, found {}", rows[r].line,
                       rows[0].fields.size(), fields.size()));
    const auto frame = number_of<uint64_t>(fields[columns->frame], place);
    if (frame >= frames)
      fail(fmt::format("line {}: frame {} is out of range; the query has {} frames", rows[r].line,
                       frame, frames));
    if (positions[frame])
      fail(fmt::format("line {}: frame {} is there twice", rows[r].line, frame));
    positions[frame] = {number_of<double>(fields[columns->x], place),
                        number_of<double>(fields[columns->y], place)};
  }
  std::vector<double> travelled;
  for (size_t frame = 0; frame < frames; ++frame) {
    if (!positions[frame]) fail(fmt::format("frame {} has no line", frame));
    if (frame == 0) {
      travelled.push_back(0);
      continue;
    }
    const auto [x, y] = *positions[frame];
    const auto [x0, y0] = *positions[frame - 1];
    // Rounded correctly everywhere, which hypot is not.
    travelled.push_back(travelled.back() + std::sqrt((x - x0) * (x - x0) + (y - y0) * (y - y0)));
  }
  if (!travelled.empty() && !std::isfinite(travelled.back()))
    fail("its positions are too far apart for metres");
  return travelled;
}

}  // namespace vpr
