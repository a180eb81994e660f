#include "ground_truth/pose_csv.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.h"
#include "ground_truth/gps.h"
#include "ground_truth/named_rows.h"
#include "ground_truth/numbers.h"
#include "images/sequence_argument.h"

namespace vpr {
namespace {

const std::vector<std::string> kNeeded = {"frame", "x", "y"};

/// Where a file has positions: in columns x and y, unless there are latitudes and longitudes.
std::optional<GpsColumns> position_columns(const NamedRows& rows) {
  if (rows.has("x") && rows.has("y")) return std::nullopt;
  auto columns = find_gps_columns(rows.header());
  if (!columns)
    rows.fail(
        fmt::format("its header has no column {} (or lat and lon)", rows.has("x") ? "y" : "x"));
  return columns;
}

// Nothing where the row has no fix.
std::optional<CsvPose> read_row(const NamedRows& rows, const std::optional<GpsColumns>& gps) {
  CsvPose pose;
  if (gps) {
    pose.place = read_fix(rows, *gps);
    if (!pose.place) return std::nullopt;
    pose.position = earth_position(*pose.place);
  } else {
    pose.position = {rows.real("x"), rows.real("y"), 0};
  }
  if (rows.has("heading")) pose.heading_deg = rows.real("heading");
  pose.floor = rows.text("floor");
  return pose;
}

// The frame of the present row, as it counts in the range; nothing outside the range.
std::optional<size_t> read_frame(const NamedRows& rows, const FrameRange& range) {
  const auto frame = parse_frame(rows.text("frame"));
  if (!frame || !frame->in_range)
    rows.fail(fmt::format("\"{}\" is not a frame number", rows.text("frame")));
  return frame_in_range(range, frame->value);
}

void require_room(const NamedRows& rows, const PoseCsvRules& rules, const SequenceArgument& source,
                  size_t frame) {
  if (!rules.frames && frame >= rules.most_frames)
    rows.fail("the frame is too large; give their number");
  if (!rules.frames || frame < *rules.frames) return;
  rows.fail(fmt::format("frame {} is out of range; there are {} frames{}", rows.text("frame"),
                        *rules.frames, source.range.is_all() ? range_hint(source.path) : ""));
}

}  // namespace

bool has_pose_columns(const std::vector<std::string>& header) {
  return std::all_of(kNeeded.begin(), kNeeded.end(), [&](const std::string& column) {
    return std::find(header.begin(), header.end(), column) != header.end();
  });
}

std::vector<std::optional<CsvPose>> read_pose_csv(const std::filesystem::path& path,
                                                  const PoseCsvRules& rules) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  NamedRows rows(source.path, path.string(), {"frame"});
  const auto gps = position_columns(rows);
  const auto in_range = frame_count(source.range);
  if (in_range && rules.frames && *in_range != *rules.frames)
    rows.fail(fmt::format("its range has {}, and the sequence has {}", counted(*in_range, "frame"),
                          *rules.frames));
  std::vector<std::optional<CsvPose>> poses(rules.frames.value_or(0));
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    const auto frame = read_frame(rows, source.range);
    if (!frame) continue;
    require_room(rows, rules, source, *frame);
    if (*frame >= poses.size()) poses.resize(*frame + 1);
    if (poses[*frame]) rows.fail(fmt::format("frame {} is given twice", rows.text("frame")));
    poses[*frame] = read_row(rows, gps);
  }
  return poses;
}

}  // namespace vpr
