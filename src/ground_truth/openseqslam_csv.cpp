#include "ground_truth/openseqslam_csv.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/csv.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "ground_truth/builder.h"
#include "ground_truth/label_runs.h"
#include "ground_truth/numbers.h"
#include "ground_truth/writing.h"

namespace vpr {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto words = split_words(text);
  return words.size() == 1 ? words.front() : text;
}

// A whole number; nothing if it is not that large, but negative or beyond 64 bits.
std::optional<size_t> read_number(const GroundTruthBuilder& builder, const std::string& text,
                                  std::string_view what) {
  const auto number = parse_frame(trimmed(text));
  if (!number) builder.fail(fmt::format("{} \"{}\" is not a whole number", what, text));
  return number->in_range ? std::optional(number->value) : std::nullopt;
}

void read_row(GroundTruthBuilder& builder, const CsvRow& row, size_t sequence) {
  builder.at("line", row.line);
  if (row.fields.size() < 2 || row.fields.size() > 3)
    builder.fail(fmt::format("expected query, reference and tolerance, found {} columns",
                             row.fields.size()));
  const auto query = read_number(builder, row.fields[0], "query");
  const auto reference = read_number(builder, row.fields[1], "reference");
  const auto tolerance =
      row.fields.size() < 3 ? size_t{0} : read_number(builder, row.fields[2], "tolerance");
  if (!tolerance) builder.fail(fmt::format("tolerance {} is out of range", row.fields[2]));
  // Counted from 1, so that 0 is out of range, too.
  if (!query || *query == 0)
    return builder.note_out_of_range("query (from 1)", row.fields[0], builder.query());
  if (!reference || *reference == 0)
    return builder.note_out_of_range("reference (from 1)", row.fields[1], builder.train(sequence));
  const size_t at = *reference - 1;
  const FrameCount& train = builder.train(sequence);
  const size_t first = at - std::min(at, *tolerance);
  size_t last = *tolerance < kUnknownFrames - at ? at + *tolerance : kUnknownFrames;
  if (at >= train.frames)
    return builder.note_out_of_range("reference (from 1)", row.fields[1], train);
  last = std::min(last, train.frames - 1);
  builder.add(*query - 1, sequence, first, last, PlaceLabel::same);
}

}  // namespace

bool is_openseqslam_csv(const FileStart& start) {
  const auto fields = split(start.first_line, ',');
  return (fields.size() == 2 || fields.size() == 3) &&
         std::all_of(fields.begin(), fields.end(), [](std::string_view field) {
           return parse_frame(trimmed(field)).has_value();
         });
}

std::string read_openseqslam_csv(GroundTruthBuilder& builder) {
  const std::filesystem::path& path = builder.argument().path;
  const size_t sequence = builder.only_searched(path.string());
  if (builder.train(sequence).grows)
    throw Error(ErrorKind::usage,
                fmt::format("{}: its tolerances are cut off at the sequence's end; give the "
                            "numbers of frames",
                            path.string()));
  const MappedFile file(path);
  const std::vector<CsvRow> rows = parse_csv(file.text(), path.string());
  if (rows.empty()) builder.fail("is empty; expected lines of query, reference, tolerance");
  for (const CsvRow& row : rows) read_row(builder, row, sequence);
  return fmt::format("openseqslam2: {} with tolerances of their own, and {} more",
                     counted(rows.size(), "pair"),
                     counted(static_cast<uint64_t>(builder.argument().tolerance_frames), "frame"));
}

void write_openseqslam_csv(const InspectedGroundTruth& ground_truth, OutputFile& file,
                           const Monitor& monitor) {
  const size_t sequence = only_written_sequence(ground_truth, "openseqslam2");
  const size_t frames = ground_truth.scope.sequences[sequence].frames;
  for (size_t query = 0; query < ground_truth.truth.pairs.size(); ++query) {
    check_stop(monitor);
    for (const LabelRun& run : label_runs(ground_truth.truth, query, sequence, frames)) {
      if (run.label != PlaceLabel::same) continue;
      const size_t tolerance = (run.last - run.first) / 2;
      file.write(fmt::format("{},{},{}\n", query + 1, run.first + tolerance + 1, tolerance));
      if ((run.last - run.first) % 2 == 1)
        file.write(fmt::format("{},{},{}\n", query + 1, run.last + 1, 0));
    }
  }
}

}  // namespace vpr
