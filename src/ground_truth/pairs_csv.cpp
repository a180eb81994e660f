#include "ground_truth/pairs_csv.h"

#include <map>
#include <optional>

#include <fmt/format.h>

#include "base/csv.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "ground_truth/builder.h"
#include "ground_truth/check.h"
#include "ground_truth/label_runs.h"
#include "ground_truth/numbers.h"
#include "ground_truth/writing.h"
#include "images/sequence.h"

namespace vpr {
namespace {

constexpr uint64_t kMostLines = uint64_t{1} << 30;

/// Column numbers of a pairs file.
struct PairColumns {
  size_t count = 0;
  bool has_sequence = false;
  bool has_label = false;
};

PairColumns read_header(const std::vector<CsvRow>& rows, const GroundTruthBuilder& builder) {
  if (!rows.empty()) {
    const auto& names = rows.front().fields;
    for (const bool has_sequence : {false, true}) {
      for (const bool has_label : {false, true}) {
        std::vector<std::string> wanted = {"query"};
        if (has_sequence) wanted.emplace_back("sequence");
        wanted.emplace_back("reference");
        if (has_label) wanted.emplace_back("label");
        if (names == wanted) return {wanted.size(), has_sequence, has_label};
      }
    }
  }
  builder.fail("expected the header query,reference[,label] or query,sequence,reference[,label]");
}

/// One side of a pair. `names` is filled when the first name is met.
struct PairSide {
  std::string_view what;
  const FrameCount& frames;
  const NameReader& reader;
  std::optional<FrameNames>& names;
};

size_t find_name(const GroundTruthBuilder& builder, const PairSide& side, const std::string& text) {
  if (!side.reader)
    builder.fail(
        fmt::format("{} \"{}\" is not a frame number. To use file names with vpr-eval, "
                    "give the sequences: --query and --train",
                    side.what, text));
  if (!side.names) side.names.emplace(side.reader());
  const size_t count = side.names->count().value_or(0);
  if (!side.frames.grows && count != side.frames.frames)
    builder.fail(
        fmt::format("{} \"{}\" is one of {}, and the result has {}. Use the sequence that "
                    "was evaluated",
                    side.what, text, counted(count, "name"), counted(side.frames.frames, "frame")));
  const auto frame = side.names->find(text);
  if (!frame)
    builder.fail(
        fmt::format("{} \"{}\" is neither a frame number nor the name of exactly one of {}",
                    side.what, text, counted(count, "frame")));
  return *frame;
}

// Nothing if the frame is out of range, which is noted, or outside `range`, which names ignore.
std::optional<size_t> read_frame(GroundTruthBuilder& builder, const std::string& text,
                                 const PairSide& side, const FrameRange& range) {
  const auto frame = parse_frame(text);
  if (!frame) return find_name(builder, side, text);
  if (frame->in_range) return frame_in_range(range, frame->value);
  builder.note_out_of_range(side.what, text, side.frames);
  return std::nullopt;
}

/// Names of the query's frames, and of the frames of each training sequence.
struct PairNames {
  std::optional<FrameNames> query;
  std::map<size_t, std::optional<FrameNames>> train;
};

PlaceLabel read_label(const GroundTruthBuilder& builder, const std::string& text) {
  if (text == "same" || text.empty()) return PlaceLabel::same;
  if (text == "ignore") return PlaceLabel::ignore;
  builder.fail(fmt::format("label \"{}\" is neither same nor ignore", text));
}

// Whether the row's query frame is one of the range.
bool read_row(GroundTruthBuilder& builder, const PairColumns& columns, const CsvRow& row,
              size_t only_sequence, const FrameRange& range, PairNames& names) {
  builder.at("line", row.line);
  if (row.fields.size() != columns.count)
    builder.fail(fmt::format("expected {} columns, found {}", columns.count, row.fields.size()));
  const size_t sequence =
      columns.has_sequence ? builder.find_sequence(row.fields[1]) : only_sequence;
  const GroundTruthScope& scope = builder.scope();
  const auto query = read_frame(builder, row.fields[0],
                                {"query", builder.query(), scope.query_names, names.query}, range);
  const auto reference = read_frame(builder, row.fields[columns.has_sequence ? 2 : 1],
                                    {"reference", builder.train(sequence),
                                     scope.sequences[sequence].names, names.train[sequence]},
                                    {});
  const PlaceLabel label =
      columns.has_label ? read_label(builder, row.fields.back()) : PlaceLabel::same;
  if (query && reference) builder.add(*query, sequence, *reference, *reference, label);
  return query.has_value();
}

void require_range(GroundTruthBuilder& builder, const SequenceArgument& source) {
  const auto in_range = frame_count(source.range);
  if (in_range && !builder.query().grows && *in_range != builder.query().frames)
    builder.fail(fmt::format("its range has {}, and the query has {}", counted(*in_range, "frame"),
                             builder.query().frames));
  if (source.range.is_all()) builder.set_query_hint(range_hint(source.path));
}

// A few anchors have the same header as pairs, and another meaning for the frames between them.
void warn_of_anchors(const GroundTruthBuilder& builder, const PairColumns& columns,
                     const std::vector<CsvRow>& rows) {
  constexpr size_t kFramesAPair = 10;  // with fewer frames to a pair it is no mere outline
  const size_t pairs = rows.size() - 1;
  if (columns.has_label || pairs < 2 || builder.query().grows ||
      pairs * kFramesAPair > builder.query().frames)
    return;
  for (size_t r = 2; r < rows.size(); ++r) {
    const auto before = parse_frame(rows[r - 1].fields.front());
    const auto frame = parse_frame(rows[r].fields.front());
    if (!before || !frame || frame->value <= before->value) return;
  }
  builder.warn_user(fmt::format(
      "{} labels {} of {}, and what is recognised in the others counts as wrong; if "
      "these are anchors, with the frames between them on the way, add "
      "--ground-truth-format anchors",
      builder.argument().path.string(), pairs, counted(builder.query().frames, "query frame")));
}

}  // namespace

bool is_pairs_csv(const FileStart& start) {
  return start.first_line.starts_with("query,") || start.first_line.starts_with("\"query\",");
}

std::string read_pairs_csv(GroundTruthBuilder& builder) {
  const std::filesystem::path& path = builder.argument().path;
  const SequenceArgument source = parse_sequence_argument(path.string());
  const MappedFile file(source.path);
  const std::vector<CsvRow> rows = parse_csv(file.text(), path.string());
  require_range(builder, source);
  const PairColumns columns = read_header(rows, builder);
  const size_t only_sequence =
      columns.has_sequence
          ? 0
          : builder.only_searched(fmt::format("{} (it has no sequence column)", path.string()));
  PairNames names;
  size_t pairs = 0;
  for (size_t r = 1; r < rows.size(); ++r)
    pairs += read_row(builder, columns, rows[r], only_sequence, source.range, names) ? 1 : 0;
  if (builder.argument().format.empty()) warn_of_anchors(builder, columns, rows);
  const std::string text = "pairs: " + counted(pairs, "labelled pair");
  const auto tolerance = static_cast<uint64_t>(builder.argument().tolerance_frames);
  if (tolerance == 0) return text;
  return fmt::format("{}, references within {} of one count", text, counted(tolerance, "frame"));
}

void write_pairs_csv(const InspectedGroundTruth& ground_truth, Output& file,
                     const Monitor& monitor) {
  const auto& sequences = ground_truth.scope.sequences;
  const GroundTruth& truth = ground_truth.truth;
  const GroundTruthSummary summary = summarise(ground_truth, monitor);
  require_writable(summary.same + summary.ignored, kMostLines, "pairs");
  const bool several = sequences.size() > 1;
  bool has_ignored = false;
  for (const auto& row : truth.pairs)
    for (const auto& pair : row) has_ignored = has_ignored || pair.label == PlaceLabel::ignore;
  file.write(fmt::format("query,{}reference{}\n", several ? "sequence," : "",
                         has_ignored ? ",label" : ""));
  for (size_t s = 0; s < sequences.size(); ++s) {
    const std::string name = several ? csv_field(sequences[s].name) + "," : "";
    for (size_t query = 0; query < truth.pairs.size(); ++query) {
      check_stop(monitor);
      std::string lines;
      for (const LabelRun& run : label_runs(truth, query, s, sequences[s].frames)) {
        const std::string_view label = !has_ignored                    ? ""
                                       : run.label == PlaceLabel::same ? ",same"
                                                                       : ",ignore";
        for (size_t reference = run.first; reference <= run.last; ++reference) {
          lines += fmt::format("{},{}{}{}\n", query, name, reference, label);
          write_piece(file, lines, monitor);
        }
      }
      file.write(lines);
    }
  }
}

}  // namespace vpr
