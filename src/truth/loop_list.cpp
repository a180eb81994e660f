#include "truth/loop_list.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "truth/text_file.h"
#include "truth/times.h"

namespace vpr {

namespace {

/// Where a list has what.
struct LoopColumns {
  size_t query = 0;
  size_t match = 1;
  std::optional<size_t> score;
  size_t count = 0;
};

/// A line as text.
struct LoopLine {
  std::string_view query;
  std::string_view match;
  std::optional<std::string_view> score;
  size_t number = 0;
};

LoopColumns read_header(const FileLocation& location, const std::vector<std::string_view>& names) {
  const auto column = [&](std::string_view name) -> std::optional<size_t> {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return std::nullopt;
    return static_cast<size_t>(found - names.begin());
  };
  const auto query = column("query");
  const auto match = column("match");
  if (!query || !match) location.fail("expected the header query,match[,score], or numbers");
  return {*query, *match, column("score"), names.size()};
}

LoopColumns columns_of(const FileLocation& location, size_t cells) {
  if (cells != 2 && cells != 3)
    location.fail(fmt::format("expected query, match and maybe a score; found {} columns", cells));
  LoopColumns columns{0, 1, {}, cells};
  if (cells == 3) columns.score = 2;
  return columns;
}

std::vector<LoopLine> read_lines(FileLocation& location, std::string_view text) {
  std::vector<LoopLine> lines;
  std::optional<LoopColumns> columns;
  size_t number = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(text))) {
    ++number;
    const auto cells = cells_of(line);
    if (cells.empty() || cells[0].starts_with('#')) continue;
    location.at("line", number);
    if (!columns) {
      const bool is_header = !parse_real(cells[0]);
      columns = is_header ? read_header(location, cells) : columns_of(location, cells.size());
      if (is_header) continue;
    }
    if (cells.size() != columns->count)
      location.fail(fmt::format("expected {} columns, found {}", columns->count, cells.size()));
    LoopLine& found = lines.emplace_back();
    found = {cells[columns->query], cells[columns->match], {}, number};
    if (columns->score) found.score = cells[*columns->score];
  }
  return lines;
}

bool is_by_time(const std::vector<LoopLine>& lines, const Trajectory& trajectory,
                LoopFrames frames) {
  if (frames != LoopFrames::automatic) return frames == LoopFrames::time;
  bool are_beyond = !lines.empty() && !trajectory.times_ns.empty();
  for (const LoopLine& line : lines)
    for (const std::string_view text : {line.query, line.match}) {
      if (text.find_first_of(".eE") != std::string_view::npos) return true;
      const auto frame = parse_frame(text);
      if (frame && frame->in_range && frame->value < trajectory.poses.size()) are_beyond = false;
    }
  return are_beyond;
}

size_t frame_of_index(const FileLocation& location, std::string_view text, size_t frames) {
  const auto frame = parse_frame(text);
  if (!frame) location.fail(fmt::format("\"{}\" is not a frame number", text));
  if (!frame->in_range || frame->value >= frames)
    location.fail(fmt::format("there is no frame {}; the trajectory has {} (0 to {})", text, frames,
                              frames == 0 ? 0 : frames - 1));
  return frame->value;
}

size_t frame_of_time(const FileLocation& location, std::string_view text, TimeUnit unit,
                     const Trajectory& trajectory, int64_t max_difference_ns) {
  const int64_t time = read_time(location, text, unit);
  const size_t frame = nearest_time(trajectory.times_ns, time);
  const int64_t difference = std::abs(trajectory.times_ns[frame] - time);
  if (difference > max_difference_ns)
    location.fail(
        fmt::format("the pose nearest to the time {} is {} s away, and --max-difference "
                    "is {} s",
                    text, time_text(difference), time_text(max_difference_ns)));
  return frame;
}

void require_order(const FileLocation& location, const ListedLoop& loop) {
  if (loop.match < loop.query) return;
  location.fail(loop.match == loop.query
                    ? fmt::format("frame {} can't close a loop with itself", loop.query)
                    : fmt::format("frame {} closes a loop with the later frame {}; give the later "
                                  "of the two as query",
                                  loop.query, loop.match));
}

std::optional<double> read_score(const FileLocation& location, const LoopLine& line) {
  if (!line.score) return std::nullopt;
  const auto score = parse_real(*line.score);
  if (!score) location.fail(fmt::format("the score \"{}\" is not a number", *line.score));
  return score;
}

constexpr double kMostGap = 1e9;

}  // namespace

LoopList read_loop_list(const std::filesystem::path& path, const Trajectory& trajectory,
                        const LoopListRules& rules) {
  const MappedFile file(path);
  FileLocation location{path.string()};
  const std::vector<LoopLine> lines = read_lines(location, file.text());
  LoopList list;
  list.name = path.string();
  list.is_by_time = is_by_time(lines, trajectory, rules.frames);
  if (list.is_by_time && trajectory.times_ns.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: names frames by time stamps, and {} has none; give them with "
                            "--times",
                            path.string(), trajectory.name));
  std::optional<TimeUnit> unit;
  for (const LoopLine& line : lines) {
    location.at("line", line.number);
    if (!unit) unit = unit_of_time(line.query);
    const auto frame = [&](std::string_view text) {
      if (!list.is_by_time) return frame_of_index(location, text, trajectory.poses.size());
      if (!unit) location.fail(fmt::format("\"{}\" is no time", text));
      return frame_of_time(location, text, *unit, trajectory, rules.max_difference_ns);
    };
    const ListedLoop loop{frame(line.query), frame(line.match), read_score(location, line),
                          line.number};
    for (const size_t end : {loop.query, loop.match})
      if (!trajectory.poses[end])
        location.fail(fmt::format("{} has no pose of frame {}", trajectory.name, end));
    require_order(location, loop);
    list.has_scores = loop.score.has_value();
    list.loops.push_back(loop);
  }
  return list;
}

LoopGap parse_loop_gap(const std::string& text, const std::string& flag) {
  const bool is_time = text.ends_with('s');
  const auto value = parse_real(is_time ? text.substr(0, text.size() - 1) : text);
  const bool is_whole = value && *value == std::floor(*value);
  if (!value || !(*value > 0 && *value <= kMostGap) || (!is_time && !is_whole))
    throw Error(ErrorKind::usage,
                fmt::format("{} says how long ago a place must have been left, in seconds or in "
                            "frames, as in {} 30s or {} 300; found \"{}\"",
                            flag, flag, flag, text));
  if (!is_time) return {{}, static_cast<size_t>(*value)};
  return {std::llround(*value * double{kSecond}), 0};
}

bool is_past(const LoopGap& gap, std::span<const int64_t> times_ns, size_t query, size_t match) {
  if (match >= query) return false;
  if (!gap.nanoseconds) return query - match >= gap.frames;
  return times_ns[query] - times_ns[match] >= *gap.nanoseconds;
}

std::vector<uint32_t> past_frames(const LoopGap& gap, std::span<const int64_t> times_ns,
                                  size_t frames) {
  std::vector<uint32_t> past;
  uint32_t count = 0;
  for (size_t frame = 0; frame < frames; ++frame) {
    while (is_past(gap, times_ns, frame, count)) ++count;
    past.push_back(count);
  }
  return past;
}

}  // namespace vpr
