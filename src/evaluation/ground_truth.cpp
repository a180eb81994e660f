#include "evaluation/ground_truth.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "evaluation/csv.h"

namespace vpr {
namespace {

// The index of the one sequence that was searched.
size_t only_searched(const GroundTruthScope& scope, std::string_view what) {
  size_t searched = 0;
  size_t index = 0;
  for (size_t s = 0; s < scope.sequences.size(); ++s) {
    if (!scope.sequences[s].searched) continue;
    ++searched;
    index = s;
  }
  if (searched == 1) return index;
  throw Error(ErrorKind::usage,
              fmt::format("{} needs exactly one training sequence, and the result has {}; use "
                          "pairs with a sequence column, or vpr-query --only-sequence",
                          what, searched));
}

GroundTruth aligned(const GroundTruthArgument& argument, const GroundTruthScope& scope) {
  const size_t sequence = only_searched(scope, "the ground truth \"aligned\"");
  GroundTruth truth;
  truth.tolerance_frames = argument.tolerance_frames;
  truth.protocol = fmt::format("aligned: query frame i is training frame i, within {} frames",
                               argument.tolerance_frames);
  truth.pairs.resize(scope.query_frames);
  // Frames of a query that is longer than the training sequence match its end, within the
  // tolerance.
  const size_t matched = scope.sequences[sequence].frames + size_t(argument.tolerance_frames);
  for (size_t frame = 0; frame < std::min(scope.query_frames, matched); ++frame)
    truth.pairs[frame].push_back(
        {static_cast<uint32_t>(sequence), static_cast<uint32_t>(frame), PlaceLabel::same});
  return truth;
}

/// Column numbers of a pairs file.
struct PairColumns {
  size_t count = 0;
  bool has_sequence = false;
  bool has_label = false;
};

PairColumns read_header(const std::vector<CsvRow>& rows, const std::string& where) {
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
  throw Error(ErrorKind::data, fmt::format("{}: expected the header query,reference[,label] or "
                                           "query,sequence,reference[,label]",
                                           where));
}

/// Reads the rows of one pairs file.
class PairReader {
 public:
  PairReader(const GroundTruthScope& scope, std::string where, PairColumns columns)
      : scope_(scope), where_(std::move(where)), columns_(columns) {
    truth_.pairs.resize(scope.query_frames);
    if (!columns.has_sequence)
      sequence_ = only_searched(scope, fmt::format("{} (it has no sequence column)", where_));
  }

  void add(const CsvRow& row) {
    line_ = row.line;
    if (row.fields.size() != columns_.count)
      fail(fmt::format("expected {} columns, found {}", columns_.count, row.fields.size()));
    const size_t query = index(row.fields[0], scope_.query_frames, "query");
    const size_t sequence = columns_.has_sequence ? find_sequence(row.fields[1]) : sequence_;
    const size_t frames = scope_.sequences[sequence].frames;
    const size_t reference = index(row.fields[columns_.has_sequence ? 2 : 1], frames, "reference");
    const PlaceLabel label = columns_.has_label ? read_label(row.fields.back()) : PlaceLabel::same;
    if (scope_.sequences[sequence].searched)
      truth_.pairs[query].push_back(
          {static_cast<uint32_t>(sequence), static_cast<uint32_t>(reference), label});
  }

  GroundTruth finish() {
    for (size_t query = 0; query < truth_.pairs.size(); ++query) {
      auto& pairs = truth_.pairs[query];
      std::sort(pairs.begin(), pairs.end());
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
      for (size_t i = 1; i < pairs.size(); ++i)
        if (pairs[i].sequence == pairs[i - 1].sequence &&
            pairs[i].reference == pairs[i - 1].reference)
          throw Error(ErrorKind::data,
                      fmt::format("{}: the pair of query {} and reference {} is labelled both same "
                                  "and ignore",
                                  where_, query, pairs[i].reference));
    }
    return std::move(truth_);
  }

 private:
  size_t index(const std::string& text, size_t count, std::string_view what) const {
    size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::invalid_argument || end != text.data() + text.size())
      fail(fmt::format("{} \"{}\" is not a frame number", what, text));
    if (error != std::errc{} || value >= count)
      fail(fmt::format("{} {} is out of range; the result has {} frames (0 to {})", what, text,
                       count, count - 1));
    return value;
  }

  size_t find_sequence(const std::string& name) const {
    for (size_t s = 0; s < scope_.sequences.size(); ++s)
      if (scope_.sequences[s].name == name) return s;
    fail(fmt::format("the result has no training sequence \"{}\"", name));
  }

  PlaceLabel read_label(const std::string& text) const {
    if (text == "same" || text.empty()) return PlaceLabel::same;
    if (text == "ignore") return PlaceLabel::ignore;
    fail(fmt::format("label \"{}\" is neither same nor ignore", text));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::data, fmt::format("{}, line {}: {}", where_, line_, what));
  }

  const GroundTruthScope& scope_;
  std::string where_;
  PairColumns columns_;
  GroundTruth truth_;
  size_t sequence_ = 0;  // of rows without a sequence column
  size_t line_ = 0;
};

GroundTruth read_pairs(const GroundTruthArgument& argument, const GroundTruthScope& scope) {
  const std::string where = argument.path.string();
  const MappedFile file(argument.path);
  const std::vector<CsvRow> rows = parse_csv(file.text(), where);
  const PairColumns columns = read_header(rows, where);
  PairReader reader(scope, where, columns);
  for (size_t r = 1; r < rows.size(); ++r) reader.add(rows[r]);
  GroundTruth truth = reader.finish();
  truth.tolerance_frames = argument.tolerance_frames;
  truth.protocol = fmt::format("pairs: {} labelled pairs, references within {} frames of one count",
                               rows.size() - 1, argument.tolerance_frames);
  return truth;
}

}  // namespace

PlaceLabel GroundTruth::label(size_t query, size_t sequence, size_t reference) const {
  PlaceLabel found = PlaceLabel::different;
  for (const Pair& pair : pairs[query]) {
    if (pair.sequence != sequence) continue;
    const int64_t away = std::abs(int64_t{pair.reference} - static_cast<int64_t>(reference));
    if (pair.label == PlaceLabel::same && away <= tolerance_frames) return PlaceLabel::same;
    if (pair.label == PlaceLabel::ignore && away == 0) found = PlaceLabel::ignore;
  }
  return found;
}

bool GroundTruth::has_match(size_t query) const {
  return std::any_of(pairs[query].begin(), pairs[query].end(),
                     [](const Pair& pair) { return pair.label == PlaceLabel::same; });
}

GroundTruth read_ground_truth(const GroundTruthArgument& argument, const GroundTruthScope& scope) {
  if (argument.tolerance_frames < 0)
    throw Error(ErrorKind::usage, "the tolerance must not be negative");
  if (argument.format == "aligned") return aligned(argument, scope);
  if (argument.format == "pairs") return read_pairs(argument, scope);
  throw Error(
      ErrorKind::usage,
      fmt::format("unknown ground truth format \"{}\"; choose aligned or pairs", argument.format));
}

GroundTruthArgument parse_ground_truth_argument(const std::string& text, int tolerance_frames) {
  if (text == "aligned") return {"aligned", {}, tolerance_frames};
  return {"pairs", text, tolerance_frames};
}

}  // namespace vpr
