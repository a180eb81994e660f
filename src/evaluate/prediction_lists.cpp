#include "evaluate/prediction_lists.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/npy.h"
#include "base/output.h"
#include "base/parallel.h"
#include "base/rows.h"
#include "base/text.h"
#include "truth/frame_cells.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

/// One line of a list, or one prediction in the file of a query.
struct Prediction {
  std::string query;
  std::string reference;
  std::optional<double> score;
  FileLocation location;
};

struct ScoredReference {
  size_t reference = 0;
  double score = 0;
};

struct ScoredLists {
  size_t references = 0;
  std::vector<std::vector<ScoredReference>> queries = {};
  bool has_names = false;
};

struct PredictionList {
  std::vector<Prediction> all = {};
  bool are_rankings = false;
  bool has_queries = true;               ///< surely, not only references
  bool are_ranks = false;                ///< instead of scores
  std::optional<ScoreOrder> order = {};  ///< in the header
};

// Whether the first cell of a line cannot be a reference like the other ones.
bool begins_with_query(std::span<const std::string_view> cells) {
  const auto folder = [](std::string_view path) { return path.substr(0, path.rfind('/') + 1); };
  return std::ranges::count(cells, cells[0]) > 1 ||
         (cells.size() > 1 && folder(cells[0]) != folder(cells[1]));
}

// A first column without a name, as pandas writes its index.
size_t index_columns(const Rows& rows) {
  return !rows.header().empty() && rows.header()[0].empty() ? 1 : 0;
}

// Whether lines have more references than one. Throws for a header that fits neither pairs nor
// rankings.
bool are_rankings(Rows& rows) {
  const size_t index = index_columns(rows);
  const std::span header = std::span(rows.header()).subspan(index);
  const size_t named = header.size();
  const bool has_score = rows.has("score");
  bool found = !rows.has("reference");
  while (rows.next()) {
    const auto cells = rows.cells().subspan(index);
    const bool is_score =
        named > 0 ? has_score : cells.size() == 3 && (parse_real(cells[2]) || is_missing(cells[2]));
    found = found || cells.size() > (is_score ? 3 : 2);
  }
  const bool fits = rows.has("reference") ? named == (has_score ? 3 : 2) : named > 3 && !has_score;
  if (named > 0 && (!fits || (found && lower_case(header[0]) != "query")))
    rows.fail(
        "the columns are query, reference and optionally score. Name the columns of a ranking "
        "query,reference, however many references follow");
  return found;
}

// Refuses a first line "0,1", as pandas names two columns: its query has one pair more than others.
void refuse_counted_header(const std::vector<Prediction>& all) {
  if (all.size() < 3 || all[0].query != "0" || all[0].reference != "1" || all[0].score) return;
  const auto pairs_of = [&](const std::string& query) {
    return std::ranges::count(all, query, &Prediction::query);
  };
  if (all.back().query != "0" && pairs_of("0") == pairs_of(all.back().query) + 1)
    all[0].location.fail(
        "0,1 is a pair or a header of pandas. Name the columns query,reference, or omit the "
        "header, as in to_csv(header=False)");
}

// Pairs with or without a score, or one line per query: its name and its references, best first.
PredictionList read_list(const fs::path& path) {
  Rows rows(path, path.string(), list_rules({"query", "reference", "score"}));
  PredictionList list;
  list.has_queries = !rows.header().empty();
  list.are_rankings = are_rankings(rows);
  for (const std::string& column : rows.header()) {
    list.are_ranks = list.are_ranks || lower_case(column) == "rank";
    if (const auto order = enum_value<ScoreOrder>(lower_case(column))) list.order = order;
  }
  std::set<std::string_view> queries;
  while (rows.next()) {
    const auto cells = rows.cells().subspan(index_columns(rows));
    list.has_queries = list.has_queries || begins_with_query(cells);
    if (list.are_rankings && cells.size() > 1) {
      if (std::set<std::string_view>(cells.begin() + 1, cells.end()).size() + 1 < cells.size())
        rows.fail(
            "a reference is listed twice. If these are scores, save them as .npy; names with "
            "blanks need commas between the fields");
      if (!queries.insert(cells[0]).second)
        rows.fail(
            "{} has a line before this one, but rankings have one line per query, which begins "
            "with it",
            cells[0]);
      for (const std::string_view reference : cells.subspan(1))
        list.all.push_back(
            {std::string(cells[0]), std::string(reference), std::nullopt, rows.location()});
      continue;
    }
    if (cells.size() != 2 && cells.size() != 3)
      rows.fail(
          "expected a query, a reference and optionally a score; found {} fields. Names with "
          "blanks need commas between the fields",
          cells.size());
    Prediction prediction{std::string(rows.text("query")), std::string(rows.text("reference")),
                          rows.number("score"), rows.location()};
    if (!prediction.score && !rows.text("score").empty())
      rows.fail("the score {} is not a finite number{}", rows.text("score"),
                decimal_comma_hint(rows.text("score")));
    if (!list.all.empty() && list.all.front().score.has_value() != prediction.score.has_value())
      rows.fail("either all lines or none must have a score");
    list.all.push_back(std::move(prediction));
  }
  if (rows.header().empty() && !list.are_rankings) refuse_counted_header(list.all);
  return list;
}

void read_query_file(std::vector<Prediction>& all, const fs::path& path) {
  const std::string file = read_whole_file(path);
  FileLocation location{path.string()};
  std::string heading;
  std::optional<std::string> query;
  size_t number = 0;
  for (const std::string_view line : split_lines(file)) {
    location.at("line", ++number);
    if (line.empty()) continue;
    if (line == "Query path:" || line == "Predictions paths:" || line == "Positives paths:") {
      heading = line;
    } else if (heading == "Query path:") {
      if (query) location.fail("there is a second query");
      query = std::string(line);
    } else if (heading == "Predictions paths:") {
      if (!query) location.fail("expected the query before its predictions");
      all.push_back({*query, std::string(line), std::nullopt, location});
    } else if (heading.empty()) {
      location.fail("expected \"Query path:\"");
    }
  }
  if (!query)
    FileLocation{path.string()}.fail(
        "there is no query; expected \"Query path:\" and \"Predictions paths:\"");
}

std::vector<fs::path> text_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : entries_of(folder, ErrorKind::input))
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  if (files.empty())
    throw Error(ErrorKind::input, "{}: there is no .txt file of a query", folder.string());
  std::ranges::sort(files, natural_less,
                    [](const fs::path& path) { return path.filename().string(); });
  return files;
}

// The end of a sentence: the likely reason why a field is not a name.
std::string_view field_hint(std::string_view text, const FileLocation& location) {
  if (text.ends_with(',') || text.ends_with(';') || text.ends_with(':'))
    return ". Separate all fields of the list by commas, or all by blanks";
  return location.number == 1 && text.find_first_of("./ ") == std::string_view::npos
             ? ". A header has the columns query, reference and optionally score"
             : "";
}

/// The frames of one side of a list.
struct ListSide {
  const FrameNames& names;
  std::optional<size_t> frames;  ///< as stated, or by the names
  const FrameCells& cells;
  bool has_numbers;

  ListSide(const FrameCells& column, const FrameNames& known, std::optional<size_t> stated)
      : names(known),
        frames(known.count() ? known.count() : stated),
        cells(column),
        has_numbers(!column.are_names &&
                    std::ranges::all_of(column.texts, [](std::string_view text) {
                      return parse_frame(text).has_value();
                    })) {}

  std::optional<size_t> find(const std::string& text) const {
    if (!has_numbers) return names.find(text);
    const auto number = parse_frame(text);
    const bool is_frame = number && number->in_range && !(frames && number->value >= *frames);
    return is_frame ? std::optional(number->value) : std::nullopt;
  }
  size_t require(const std::string& text, const FileLocation& location) const {
    if (const auto frame = find(text)) return *frame;
    if (has_numbers)
      location.fail(frames ? fmt::format("the {} frame {} is out of range; there are {}",
                                         cells.what, text, counted(*frames, "frame"))
                           : fmt::format("{} is not a frame number", text));
    location.fail(
        names.count() > 0
            ? fmt::format("no {} frame, or more than one, is called {}{}", cells.what, text,
                          field_hint(text, location))
            : fmt::format("{} is not a frame number{}. Name the frames with --query and --train "
                          "(folders, or lists of names)",
                          text, no_number_hint(text)));
  }
};

// faiss writes references without their query. Throws if the list may be like that.
void require_queries(const PredictionList& list, const ListSide& query, const ListSide& train) {
  if (list.has_queries) return;
  const auto& queries = query.cells.texts;
  const bool are_increasing = std::ranges::is_sorted(queries, natural_less) &&
                              std::ranges::adjacent_find(queries) == queries.end();
  const bool may_lack = list.are_rankings || (query.frames == list.all.size() && !are_increasing);
  if (may_lack && std::ranges::all_of(list.all, [&](const Prediction& one) {
        const double score = one.score.value_or(0);  // of a third reference, an integer
        return train.find(one.query) && score >= 0 && score == std::floor(score);
      }))
    list.all.front().location.fail(
        "cannot tell whether lines begin with the query or with its best reference. If it is the "
        "query, add the header query,reference (or query reference, if blanks separate the "
        "fields); otherwise save the references as a .npy array of integers");
}

ScoredLists collect(const PredictionList& list, const FrameNames& queries,
                    const FrameNames& references, const ListFrames& stated,
                    const Monitor& monitor) {
  // If only the numbers in the file are known:
  constexpr uint64_t kMaxScores = uint64_t{1} << 28;
  const size_t most_frames =
      std::clamp(1000 * list.all.size(), size_t{1} << 18, size_t{kMaxGrownFrames});
  const auto cells_of = [&](std::string_view noun, const FrameNames& names,
                            std::string Prediction::*cell) {
    FrameCells cells{noun, names.count() > 0 ? &names : nullptr};
    for (const Prediction& one : list.all) cells.texts.emplace_back(one.*cell);
    return cells;
  };
  FrameCells columns[] = {cells_of("query", queries, &Prediction::query),
                          cells_of("training", references, &Prediction::reference)};
  find_names(columns, {list.all.front().location.file},
             "If these are numbers, pass --query-frames and --train-frames instead of names",
             monitor);
  const ListSide query_side(columns[0], queries, stated.query);
  const ListSide train_side(columns[1], references, stated.train);
  require_queries(list, query_side, train_side);
  ScoredLists lists{train_side.frames.value_or(0)};
  lists.has_names = !query_side.has_numbers && !train_side.has_numbers;
  lists.queries.resize(query_side.frames.value_or(0));
  for (const Prediction& prediction : list.all) {
    const FileLocation& location = prediction.location;
    const size_t query = query_side.require(prediction.query, location);
    const size_t reference = train_side.require(prediction.reference, location);
    const size_t rows = std::max(lists.queries.size(), query + 1);
    lists.references = std::max(lists.references, reference + 1);
    const size_t grown =
        std::max(query_side.frames ? 0 : rows, train_side.frames ? 0 : lists.references);
    if (grown > most_frames || (grown > 0 && uint64_t{rows} * lists.references > kMaxScores))
      location.fail(
          "the frame numbers up to here need {} x {} scores; without stated numbers of "
          "frames, the limits are {} scores and {} frames for {}. Pass --query and --train, or "
          "--query-frames and --train-frames",
          rows, lists.references, kMaxScores, most_frames, counted(list.all.size(), "pair"));
    lists.queries.resize(rows);
    auto& scored = lists.queries[query];
    const double rank = static_cast<double>(scored.size()) + 1;
    scored.push_back({reference, prediction.score.value_or(rank)});
  }
  return lists;
}

ScoreMatrix scores_of(const std::shared_ptr<const ScoredLists>& lists,
                      std::optional<ScoreOrder> kind, bool has_scores,
                      const std::vector<fs::path>& files) {
  ScoreMatrix scores;
  scores.queries = scores.block = lists->queries.size();
  scores.references = lists->references;
  scores.kind = kind.value_or(ScoreOrder::distance);
  scores.has_scores = has_scores;
  scores.has_names = lists->has_names;
  scores.compute = [lists, kind = scores.kind](size_t first, size_t count, std::span<double> out) {
    std::ranges::fill(out, std::numeric_limits<double>::quiet_NaN());
    for (size_t q = 0; q < count; ++q)
      for (const auto& [reference, listed] : lists->queries[first + q]) {
        double& score = out[q * lists->references + reference];
        if (std::isnan(score) || is_better(listed, score, kind)) score = listed;
      }
  };
  scores.fingerprint = [files](const Monitor& monitor) {
    std::string sums;
    for (const fs::path& file : files) {
      check_stop(monitor);
      sums += checksum(MappedFile(file).bytes());
    }
    return files.size() == 1 ? sums : checksum(sums);
  };
  return scores;
}

}  // namespace

ScoreMatrix prediction_scores(const fs::path& path, const FrameNames& queries,
                              const FrameNames& references, std::optional<ScoreOrder> kind,
                              const ListFrames& stated, const Monitor& monitor) {
  const std::string name = path.string();
  std::error_code error;
  std::vector<fs::path> files = {path};
  PredictionList list;
  if (fs::is_directory(path, error)) {
    files = text_files(path);
    for (const fs::path& file : files) read_query_file(list.all, file);
  } else {
    list = read_list(path);
  }
  if (list.all.empty()) throw Error(ErrorKind::data, "{}: lists no reference", name);
  const bool has_scores = list.all.front().score.has_value() && !list.are_ranks;
  if (list.order && kind.value_or(*list.order) != *list.order)
    throw Error(ErrorKind::usage, "{}: its header names the scores {}. Omit --{}", name,
                enum_name(*list.order), enum_name(*kind));
  if (list.order) kind = list.order;
  if (has_scores && !kind)
    throw Error(ErrorKind::usage,
                "{}: the list has scores. Add --distance (lower is better) or --similarity (higher "
                "is better)",
                name);
  if (!has_scores && kind == ScoreOrder::similarity)
    throw Error(ErrorKind::usage,
                "{}: the list has no scores, and ranks are distances. Omit --similarity, or save a "
                "matrix as .npy",
                name);
  return scores_of(
      std::make_shared<const ScoredLists>(collect(list, queries, references, stated, monitor)),
      kind, has_scores, files);
}

bool is_index_array(const NpyArray& array, size_t references) {
  const NumberType* type = find_number_type(array.type());
  return type != nullptr && type->is_whole && type->name != "|b1" && array.shape().size() == 2 &&
         array.shape()[1] < references;
}

ScoreMatrix index_scores(ScoreFile indices, size_t references) {
  const auto file = std::make_shared<const ScoreFile>(std::move(indices));
  ScoredLists lists{references};
  lists.queries.resize(file->queries());
  std::vector<double> row(file->references());
  for (size_t query = 0; query < lists.queries.size(); ++query) {
    file->read_query(query, row.data());
    for (size_t k = 0; k < row.size(); ++k) {
      if (row[k] == -1) continue;  // faiss found no further neighbor
      if (!(row[k] >= 0 && row[k] < static_cast<double>(references)))
        throw Error(ErrorKind::data, "{}, row {}: the index {} is out of range; there are {}",
                    file->name(), query, row[k], counted(references, "training frame"));
      lists.queries[query].push_back({static_cast<size_t>(row[k]), static_cast<double>(k) + 1});
    }
    std::ranges::sort(row);
    for (size_t k = 1; k < row.size(); ++k)
      if (row[k] >= 0 && row[k] == row[k - 1])
        throw Error(
            ErrorKind::data,
            "{}, row {}: the index {} is listed twice. If these are scores, save one column "
            "per training frame",
            file->name(), query, row[k]);
  }
  ScoreMatrix scores =
      scores_of(std::make_shared<const ScoredLists>(std::move(lists)), {}, false, {});
  scores.fingerprint = [file](const Monitor& monitor) { return file->fingerprint(monitor); };
  return scores;
}

std::vector<MatchedFrame> best_pairs(const ScoreMatrix& matrix, const ScoreLayout& layout,
                                     size_t most, const Monitor& monitor) {
  std::vector<std::vector<uint32_t>> columns(matrix.queries);
  matrix.for_each_row(
      thread_count(), monitor, "pairs", [&](size_t, size_t query, std::span<const uint64_t> keys) {
        std::vector<uint32_t> order(keys.size());
        std::iota(order.begin(), order.end(), uint32_t{0});
        const auto end = order.begin() + static_cast<ptrdiff_t>(std::min(most, order.size()));
        std::partial_sort(order.begin(), end, order.end(), [&](uint32_t a, uint32_t b) {
          return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
        });
        for (auto column = order.begin(); column != end && keys[*column] != kNoScore; ++column)
          columns[query].push_back(*column);
      });
  std::vector<MatchedFrame> pairs;
  for (size_t query = 0; query < columns.size(); ++query)
    for (const uint32_t column : columns[query])
      pairs.push_back({layout.anchor(query), match_of_column(layout, column)});
  return pairs;
}

std::vector<MatchedFrame> best_pairs(const Result& result) {
  std::vector<MatchedFrame> pairs;
  for (const auto& best : result.best)
    if (best) pairs.push_back(anchors_of(*best, result.window_length()));
  return pairs;
}

}  // namespace vpr
