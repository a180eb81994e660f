#include "ground_truth/anchors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "ground_truth/association.h"
#include "ground_truth/builder.h"
#include "ground_truth/named_rows.h"
#include "ground_truth/numbers.h"
#include "ground_truth/pairs_csv.h"
#include "images/sequence_argument.h"

namespace vpr {
namespace {

struct Anchor {
  size_t query = 0;  ///< of the whole recording, if the path has a range
  size_t reference = 0;
};

/// By training sequence, with rising query frames.
using Anchors = std::map<size_t, std::vector<Anchor>>;

size_t read_frame(const NamedRows& rows, const char* column) {
  const auto frame = parse_frame(rows.text(column));
  if (!frame || !frame->in_range || frame->value > kMostGrownFrames)
    rows.fail(fmt::format("{} \"{}\" is not a frame number", column, rows.text(column)));
  return frame->value;
}

Anchors read_file(GroundTruthBuilder& builder, const std::filesystem::path& path) {
  const std::string name = builder.argument().path.string();
  NamedRows rows(path, name, {"query", "reference"});
  const bool has_sequences = rows.has("sequence");
  const size_t only = has_sequences ? 0 : builder.only_searched(name);
  Anchors anchors;
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    builder.at("line", rows.line());
    const size_t sequence = has_sequences ? builder.find_sequence(rows.text("sequence")) : only;
    const Anchor anchor{read_frame(rows, "query"), read_frame(rows, "reference")};
    const FrameCount& train = builder.train(sequence);
    if (!train.grows && anchor.reference >= train.frames)
      rows.fail(fmt::format("reference {} is out of range; there are {} frames", anchor.reference,
                            train.frames));
    auto& known = anchors[sequence];
    if (!known.empty() && anchor.query <= known.back().query)
      rows.fail(
          fmt::format("query {} is not behind the anchor before, {}; anchors stand in the "
                      "order of query frames",
                      anchor.query, known.back().query));
    known.push_back(anchor);
  }
  return anchors;
}

/// Where on the training sequence a query frame is, in frames; nothing beyond the anchors.
std::optional<double> position_of(const std::vector<Anchor>& anchors, size_t& next, size_t query) {
  while (next < anchors.size() && anchors[next].query < query) ++next;
  if (next == anchors.size()) return std::nullopt;
  const Anchor& b = anchors[next];
  if (b.query == query) return static_cast<double>(b.reference);
  if (next == 0) return std::nullopt;
  const Anchor& a = anchors[next - 1];
  const double share =
      static_cast<double>(query - a.query) / static_cast<double>(b.query - a.query);
  const auto from = static_cast<double>(a.reference);
  return from + share * (static_cast<double>(b.reference) - from);
}

/// The query frames of the ground truth that lie between anchors, with their positions.
template <class Use>
void for_each_position(GroundTruthBuilder& builder, const std::vector<Anchor>& anchors,
                       const FrameRange& range, Use&& use) {
  if (anchors.empty()) return;
  size_t next = 0;
  for (size_t recorded = anchors.front().query; recorded <= anchors.back().query; ++recorded) {
    const auto query = frame_in_range(range, recorded);
    const auto position = position_of(anchors, next, recorded);
    if (!query || !position) continue;
    if (!builder.query().grows && *query >= builder.query().frames)
      builder.fail(fmt::format("query {} is out of range; there are {} frames{}", recorded,
                               builder.query().frames,
                               range.is_all() ? range_hint(builder.argument().path) : ""));
    use(*query, *position);
  }
}

/// The position on the straight line between the poses of two neighbouring frames; nothing where
/// one is unknown.
std::optional<Pose> pose_at(const Poses& poses, double position) {
  const auto before = static_cast<size_t>(position);
  const double share = position - static_cast<double>(before);
  if (before >= poses.size() || !poses[before]) return std::nullopt;
  if (share == 0) return poses[before];
  if (before + 1 >= poses.size() || !poses[before + 1]) return std::nullopt;
  Pose pose;
  for (size_t k = 0; k < 3; ++k)
    pose.position[k] = poses[before]->position[k] +
                       share * (poses[before + 1]->position[k] - poses[before]->position[k]);
  return pose;
}

std::string in_metres(GroundTruthBuilder& builder, const Anchors& anchors,
                      const FrameRange& range) {
  const GroundTruthOptions& options = builder.argument().options;
  if (builder.argument().tolerance_frames != 0)
    throw Error(ErrorKind::usage,
                "anchors take a tolerance in frames or a radius in metres, not both");
  const size_t sequence = builder.only_searched("a radius of anchors");
  const Poses train = read_train_poses(options.reference, options, builder.monitor()).poses;
  builder.require_train_frames(sequence, train.size());
  Poses query;
  std::vector<bool> nowhere;
  for (const auto& [anchored, list] : anchors)
    for_each_position(builder, list, range, [&](size_t frame, double position) {
      query.resize(std::max(query.size(), frame + 1));
      nowhere.resize(query.size(), true);
      query[frame] = pose_at(train, position);
      nowhere[frame] = false;
    });
  if (!builder.query().grows) query.resize(builder.query().frames);
  nowhere.resize(query.size(), true);
  builder.require_query_frames(query.size());
  return match_poses(builder, sequence, query, train, {}, nowhere);
}

std::string in_frames(GroundTruthBuilder& builder, const Anchors& anchors,
                      const FrameRange& range) {
  for (const auto& [sequence, list] : anchors)
    for_each_position(builder, list, range, [&, s = sequence](size_t query, double position) {
      const auto reference = static_cast<size_t>(std::floor(position + 0.5));
      builder.add(query, s, reference, reference, PlaceLabel::same);
    });
  return "within " + counted(static_cast<uint64_t>(builder.argument().tolerance_frames), "frame");
}

// Only positions of training frames go by time.
void check_times(const GroundTruthOptions& options) {
  const bool has_query_times =
      options.offset_s || !options.query_times.empty() || !options.query_pose_times.empty();
  const bool has_reference_times = options.reference_offset_s || options.max_difference_s ||
                                   !options.reference_times.empty() ||
                                   !options.reference_pose_times.empty();
  if (has_query_times || (has_reference_times && !options.radius_m))
    throw Error(ErrorKind::usage,
                "of anchors, only the poses of training frames go by time: give --radius with "
                "--reference-times, and no times or offset of the query");
}

}  // namespace

std::string read_anchors(GroundTruthBuilder& builder) {
  const GroundTruthOptions& options = builder.argument().options;
  if (options.radius_m.has_value() == options.reference.empty())
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: a tolerance of anchors in metres needs both --radius and the poses "
                    "of the training sequence (--ground-truth-reference)",
                    builder.argument().path.string()));
  check_times(options);
  const SequenceArgument source = parse_sequence_argument(builder.argument().path.string());
  const Anchors anchors = read_file(builder, source.path);
  size_t count = 0;
  for (const auto& [sequence, list] : anchors) count += list.size();
  const std::string within = options.radius_m ? in_metres(builder, anchors, source.range)
                                              : in_frames(builder, anchors, source.range);
  return fmt::format("anchors: {}, linear between them and nothing beyond, {}",
                     counted(count, "anchor"), within);
}

bool is_anchors_csv(const FileStart& start) {
  return start.path.filename().string().ends_with("anchors.csv") && is_pairs_csv(start);
}

}  // namespace vpr
