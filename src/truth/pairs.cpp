#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/rows.h"
#include "base/text.h"
#include "recordings/sequence_source.h"
#include "truth/frame_cells.h"
#include "truth/ground_truth.h"
#include "truth/readers.h"

namespace vpr {

namespace {

constexpr uint64_t kMaxLines = uint64_t{1} << 30;
constexpr size_t kPieceBytes = size_t{1} << 20;  // a query may have a line for every reference

/// A column of frames of one sequence, with the names of its recording.
struct FrameColumn {
  FrameCells& cells;
  const FrameCount& frames;
  std::optional<FrameNames> names = {};
  std::string unnamed = {};     ///< the end of a sentence: why there are no names
  bool are_names_lost = false;  ///< there were some
};

void read_names(FrameColumn& column, const NameReader& reader) {
  column.unnamed = ". To use file names with vpr-eval, pass the sequences: --query and --train";
  if (!reader) return;
  try {
    column.names.emplace(reader());
  } catch (const Error& error) {
    column.are_names_lost = error.kind() == ErrorKind::input;  // not those of a video
    column.unnamed = fmt::format(", and the names of its sequence are unknown: {}{}", error.what(),
                                 column.unnamed);
    return;
  }
  const size_t count = column.names->count();
  if (column.frames.grows || count == column.frames.frames) {
    column.cells.names = &*column.names;
    return;
  }
  column.names.reset();
  column.are_names_lost = count > 0;
  column.unnamed =
      fmt::format(", and its sequence has {}, but the result has {}{}", counted(count, "name"),
                  counted(column.frames.frames, "frame"), column.unnamed);
}

// Nullopt if no frame has this name, and `range` may exclude it.
std::optional<size_t> find_name(const GroundTruthBuilder& builder, const FrameColumn& column,
                                std::string_view text, const FrameRange& range) {
  if (column.cells.names == nullptr)
    builder.fail("{} \"{}\" is not a frame number{}{}", column.cells.what, shortened(text),
                 no_number_hint(text), column.unnamed);
  const auto frame = column.names->find(text);
  if (frame || (!range.is_all() && !column.names->has(text))) return frame;
  builder.fail("{} \"{}\" is {} the name of exactly one of {}{}", column.cells.what,
               shortened(text), column.cells.are_names ? "not" : "neither a frame number nor",
               counted(column.names->count(), "frame"),
               column.cells.what == "query" && range.is_all() && !column.names->has(text)
                   ? range_hint(builder.argument().path)
                   : "");
}

// Nullopt if the frame is out of range, which is reported, or outside `range`.
std::optional<size_t> read_frame(GroundTruthBuilder& builder, std::string_view text,
                                 const FrameColumn& column, const FrameRange& range) {
  const auto frame = parse_frame(text);
  if (!frame || column.cells.are_names) return find_name(builder, column, text, range);
  if (frame->in_range) return frame_in_range(range, frame->value);
  builder.report_out_of_range(column.cells.what, text, column.frames);
  return std::nullopt;
}

// Warns of numbers that may have been names.
void warn_of_lost_names(const GroundTruthBuilder& builder,
                        const std::vector<FrameColumn>& columns) {
  const FrameColumn* lost = nullptr;
  for (const FrameColumn& column : columns) {
    const auto& texts = column.cells.texts;
    const auto is_number = [](std::string_view text) { return parse_frame(text).has_value(); };
    if (!std::ranges::all_of(texts, is_number)) continue;
    if (std::ranges::count(texts, "0") > 0) return;  // frames count from 0
    if (column.are_names_lost) lost = &column;
  }
  if (lost != nullptr)
    warn(builder.monitor(), "{}: {} {} is read as the number of a frame, counted from 0{}",
         builder.argument().path.string(), lost->cells.what, lost->cells.texts.front(),
         lost->unnamed);
}

// Whether the query frame of the current row is in the range.
bool read_row(GroundTruthBuilder& builder, const Rows& rows, const FrameRange& range,
              const FrameColumn& queries, size_t sequence, const FrameColumn& references) {
  const auto query = read_frame(builder, rows.text("query"), queries, range);
  const auto reference = read_frame(builder, rows.text("reference"), references, {});
  const std::string_view label = rows.text("label");
  if (label != "same" && label != "ignore" && !label.empty())
    builder.fail("label \"{}\" is neither same nor ignore", label);
  if (query && reference)
    builder.add(*query, sequence, *reference, *reference,
                label == "ignore" ? PlaceLabel::ignore : PlaceLabel::same);
  return query.has_value();
}

std::string pairs_protocol(const GroundTruthBuilder& builder, size_t pairs) {
  const std::string text = "pairs: " + counted(pairs, "labeled pair");
  const auto tolerance = static_cast<uint64_t>(builder.argument().tolerance_frames);
  if (tolerance == 0) return text;
  return fmt::format("{}, each widened by {}", text, counted(tolerance, "training frame"));
}

std::string read_pairs_in_memory(GroundTruthBuilder& builder, std::span<const PlacePair> pairs) {
  for (size_t i = 0; i < pairs.size(); ++i) {
    const PlacePair& pair = pairs[i];
    builder.at("pair", i);
    const size_t sequence = pair.sequence.empty()
                                ? builder.only_searched("a pair without the name of its sequence")
                                : builder.find_sequence(pair.sequence);
    builder.add(pair.query, sequence, pair.reference, pair.reference, PlaceLabel::same);
  }
  return pairs_protocol(builder, pairs.size());
}

// Anchors have the same header as pairs, but a different meaning for the frames between them.
void warn_of_anchors(const GroundTruthBuilder& builder, Rows& rows) {
  constexpr size_t kFramesPerPair = 10;  // with fewer frames per pair, the pairs are dense
  if (rows.has("label") || rows.size() < 2 || builder.query().grows ||
      rows.size() * kFramesPerPair > builder.query().frames)
    return;
  std::optional<size_t> last;
  while (rows.next()) {
    const auto frame = parse_frame(rows.text("query"));
    if (!frame || (last && frame->value <= *last)) return;
    last = frame->value;
  }
  warn(builder.monitor(),
       "{} labels {} of {}, and recognitions of the other frames count as incorrect. If the pairs "
       "are anchors of a route, name the column anchor instead of reference",
       builder.argument().path.string(), rows.size(),
       counted(builder.query().frames, "query frame"));
}

struct Anchor {
  size_t query = 0;  ///< in the whole recording, if the path has a range
  size_t reference = 0;
  size_t line = 0;
};

/// By training sequence, with increasing query frames.
using Anchors = std::map<size_t, std::vector<Anchor>>;

Anchors read_file(GroundTruthBuilder& builder, const std::filesystem::path& path) {
  const std::string name = builder.argument().path.string();
  Rows rows(path, name, {{"query", "anchor", "reference", "sequence"}, 1});
  const std::string_view column = rows.has("anchor") ? "anchor" : "reference";
  if (!rows.has(column)) rows.fail("its header has no column anchor");
  const bool has_sequences = rows.has("sequence");
  const size_t only = has_sequences ? 0 : builder.only_searched(name);
  if (rows.size() == 0) rows.fail("has no anchors. Set at least one");
  Anchors anchors;
  while (rows.next()) {
    builder.at("line", rows.line());
    const size_t sequence = has_sequences ? builder.find_sequence(rows.text("sequence")) : only;
    const Anchor anchor{rows.frame("query", kMaxGrownFrames), rows.frame(column, kMaxGrownFrames),
                        rows.line()};
    const FrameCount& train = builder.train(sequence);
    if (!train.grows && anchor.reference >= train.frames)
      rows.fail("{} {} is out of range; there are {} frames", column, anchor.reference,
                train.frames);
    auto& known = anchors[sequence];
    if (!known.empty() && anchor.query <= known.back().query)
      rows.fail(
          "query {} is not after the previous anchor, {}; list anchors in the order of "
          "query frames",
          anchor.query, known.back().query);
    known.push_back(anchor);
  }
  return anchors;
}

/// Calls `use` for the query frames from the first to the last anchor, with their positions on the
/// training sequence, in frames.
template <class Use>
void for_each_position(GroundTruthBuilder& builder, const std::vector<Anchor>& anchors,
                       const FrameRange& range, Use&& use) {
  size_t next = 0;  // the first anchor at or after the frame
  for (size_t recorded = anchors.front().query; recorded <= anchors.back().query; ++recorded) {
    if (anchors[next].query < recorded) ++next;
    const auto query = frame_in_range(range, recorded);
    if (!query) continue;
    const Anchor& b = anchors[next];
    if (!builder.query().grows && *query >= builder.query().frames) {
      builder.at("line", b.line);
      builder.fail("query {} is out of range; there are {} frames{}", b.query,
                   builder.query().frames,
                   range.is_all() ? range_hint(builder.argument().path) : "");
    }
    auto position = static_cast<double>(b.reference);
    if (b.query != recorded) {
      const Anchor& a = anchors[next - 1];
      const auto from = static_cast<double>(a.reference);
      // The product is exact, and so is a position in the middle of two frames.
      position = from + static_cast<double>(recorded - a.query) * (position - from) /
                            static_cast<double>(b.query - a.query);
    }
    use(*query, position);
  }
}

/// The pose of the nearest frame, the earlier one on a tie, with the position on the straight line
/// between two neighboring frames; nullopt if one of their poses is unknown.
std::optional<Pose> pose_at(const Poses& poses, double position) {
  const auto before = static_cast<size_t>(position);
  const double share = position - static_cast<double>(before);
  if (before >= poses.size() || !poses[before]) return std::nullopt;
  if (share == 0) return poses[before];
  if (before + 1 >= poses.size() || !poses[before + 1]) return std::nullopt;
  Pose pose = *poses[share <= 0.5 ? before : before + 1];
  for (size_t k = 0; k < 3; ++k)
    pose.position[k] = poses[before]->position[k] +
                       share * (poses[before + 1]->position[k] - poses[before]->position[k]);
  return pose;
}

std::string in_meters(GroundTruthBuilder& builder, const Anchors& anchors,
                      const FrameRange& range) {
  const GroundTruthOptions& options = builder.argument().options;
  if (builder.argument().tolerance_frames != 0)
    throw Error(ErrorKind::usage,
                "anchors accept a tolerance in frames or a radius in meters, not both");
  const size_t sequence = builder.only_searched("a radius of anchors");
  const Poses train = read_train_poses(options.reference, options,
                                       builder.scope().sequences[sequence].names, builder.monitor())
                          .poses;
  builder.require_train_frames(sequence, train.size());
  Poses query;
  std::vector<bool> unplaced;
  if (const auto list = anchors.find(sequence); list != anchors.end())
    for_each_position(builder, list->second, range, [&](size_t frame, double position) {
      query.resize(std::max(query.size(), frame + 1));
      unplaced.resize(query.size(), true);
      query[frame] = pose_at(train, position);
      unplaced[frame] = false;
    });
  if (!builder.query().grows) query.resize(builder.query().frames);
  unplaced.resize(query.size(), true);
  builder.require_query_frames(query.size());
  return match_poses(builder, sequence, query, train, {}, unplaced);
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

}  // namespace

std::string read_pairs(GroundTruthBuilder& builder) {
  if (builder.argument().pairs) return read_pairs_in_memory(builder, *builder.argument().pairs);
  const std::filesystem::path& path = builder.argument().path;
  const SequenceArgument source = parse_sequence_argument(path.string());
  Rows rows(source.path, path.string(), {{"query", "reference", "sequence", "label"}, 2});
  builder.set_query_range(source);
  const size_t only_sequence =
      rows.has("sequence")
          ? 0
          : builder.only_searched(fmt::format("{} (it has no sequence column)", path.string()));
  const auto sequence_of_row = [&] {
    builder.at("line", rows.line());
    return rows.has("sequence") ? builder.find_sequence(rows.text("sequence")) : only_sequence;
  };
  std::vector<FrameCells> cells = {{"query"}};  // then of training sequences
  while (rows.next()) {
    const size_t sequence = sequence_of_row();
    cells.resize(std::max(cells.size(), sequence + 2), {"reference"});
    cells[0].texts.emplace_back(rows.text("query"));
    cells[sequence + 1].texts.emplace_back(rows.text("reference"));
  }
  std::vector<FrameColumn> columns;
  columns.reserve(cells.size());  // cells refer to their names
  for (size_t i = 0; i < cells.size(); ++i) {
    columns.push_back({cells[i], i == 0 ? builder.query() : builder.train(i - 1)});
    if (!cells[i].texts.empty())
      read_names(columns[i],
                 i == 0 ? builder.scope().query_names : builder.scope().sequences[i - 1].names);
  }
  find_names(cells, {path.string()},
             "Convert numbers to a matrix: vpr-eval convert --to matrix, with --query-frames and "
             "--train-frames",
             builder.monitor());
  warn_of_lost_names(builder, columns);
  size_t pairs = 0;
  while (rows.next()) {
    const size_t sequence = sequence_of_row();
    pairs +=
        read_row(builder, rows, source.range, columns[0], sequence, columns[sequence + 1]) ? 1 : 0;
  }
  if (builder.argument().format.empty()) warn_of_anchors(builder, rows);
  return pairs_protocol(builder, pairs);
}

void write_pairs_csv(const InspectedGroundTruth& ground_truth, Output& file,
                     const Monitor& monitor) {
  const auto& sequences = ground_truth.scope.sequences;
  const GroundTruth& truth = ground_truth.truth;
  const GroundTruthSummary summary = summarize(ground_truth, monitor);
  require_writable(summary.same + summary.ignored, kMaxLines, "pairs");
  const bool several = sequences.size() > 1;
  bool has_ignored = false;
  for (const auto& row : truth.pairs)
    for (const auto& pair : row) has_ignored = has_ignored || pair.label == PlaceLabel::ignore;
  file.write(fmt::format("query,{}reference{}\n", several ? "sequence," : "",
                         has_ignored ? ",label" : ""));
  for (size_t s = 0; s < sequences.size(); ++s) {
    const std::string name = several ? csv_field(sequences[s].sequence.name) + "," : "";
    for (size_t query = 0; query < truth.pairs.size(); ++query) {
      check_stop(monitor);
      std::string lines;
      for (const LabelStretch& run : label_runs(truth, query, s, sequences[s].sequence.frames)) {
        const std::string_view label = !has_ignored                    ? ""
                                       : run.label == PlaceLabel::same ? ",same"
                                                                       : ",ignore";
        for (size_t reference = run.first; reference <= run.last; ++reference) {
          lines += fmt::format("{},{}{}{}\n", query, name, reference, label);
          if (lines.size() < kPieceBytes) continue;
          check_stop(monitor);
          file.write(lines);
          lines.clear();
        }
      }
      file.write(lines);
    }
  }
}

std::string read_anchors(GroundTruthBuilder& builder) {
  const GroundTruthOptions& options = builder.argument().options;
  if (options.radius_m.has_value() == options.reference.empty())
    throw Error(ErrorKind::usage,
                "{}: a radius in meters needs both --radius and the poses of the training sequence "
                "(--ground-truth-train)",
                builder.argument().path.string());
  // Only the poses of training frames have times.
  const bool has_train_times = options.max_difference_s || options.train != TruthSide{};
  if (options.query != TruthSide{} || (has_train_times && !options.radius_m))
    throw Error(ErrorKind::usage,
                "with anchors, only the poses of training frames have times. Use --radius with "
                "--train-times, without times or offset of the query");
  const SequenceArgument source = parse_sequence_argument(builder.argument().path.string());
  const Anchors anchors = read_file(builder, source.path);
  size_t count = 0;
  for (const auto& [sequence, list] : anchors) count += list.size();
  const std::string within = options.radius_m ? in_meters(builder, anchors, source.range)
                                              : in_frames(builder, anchors, source.range);
  return fmt::format("anchors: {}, interpolated linearly, without places before and after them, {}",
                     counted(count, "anchor"), within);
}

std::string read_aligned(GroundTruthBuilder& builder) {
  const size_t sequence = builder.only_searched("the ground truth \"aligned\"");
  const double step = builder.argument().options.train_step.value_or(1);
  if (!(step > 0 && step <= 1e6))
    throw Error(ErrorKind::usage, "the reference step must be above 0, and at most a million");
  if (builder.query().grows || builder.train(sequence).grows)
    throw Error(ErrorKind::usage,
                "the ground truth \"aligned\" does not state the numbers of frames; pass them");
  const int tolerance = builder.argument().tolerance_frames;
  const double end = static_cast<double>(builder.train(sequence).frames) + tolerance;
  for (size_t frame = 0; frame < builder.query().frames; ++frame) {
    const double reference = std::floor(step * static_cast<double>(frame) + 0.5);
    if (!(reference < end)) break;
    builder.add_beyond_end(frame, sequence, static_cast<size_t>(reference));
  }
  const std::string of_query = step == 1 ? "i" : fmt::format("{} i", step);
  return fmt::format("aligned: query frame i is training frame {}, within {}", of_query,
                     counted(static_cast<uint64_t>(tolerance), "frame"));
}

}  // namespace vpr
