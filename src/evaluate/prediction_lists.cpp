#include "evaluate/prediction_lists.h"

#include <algorithm>
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
#include "base/parallel.h"
#include "base/text.h"
#include "truth/text_file.h"

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
  std::vector<std::vector<ScoredReference>> queries;
};

// Also "nan" and "inf", which no score may be.
bool is_number(const std::string& field) {
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error != std::errc::invalid_argument && end == field.data() + field.size();
}

// Pairs with or without a score, or one line per query: its name and its references, best first.
std::vector<Prediction> read_list(const fs::path& path) {
  std::vector<CsvRow> lines = read_list_rows(path);
  FileLocation location{path.string()};
  if (!lines.empty() && std::ranges::count(lines[0].fields, "query", lower_case) > 0) {
    if (lower_case(lines[0].fields[0]) != "query")
      location.fail("the columns are query, reference and optionally score, in this order");
    lines.erase(lines.begin());
  }
  const bool has_rankings = std::ranges::all_of(lines, [](const CsvRow& line) {
    const auto& fields = line.fields;
    return fields.size() > 3 || (fields.size() == 3 && !is_number(fields[2]));
  });
  std::vector<Prediction> all;
  for (const auto& [number, fields] : lines) {
    location.at("line", number);
    if (has_rankings) {
      if (std::set<std::string_view>(fields.begin() + 1, fields.end()).size() + 1 < fields.size())
        location.fail("a reference is listed twice. If these are scores, save them as .npy");
      for (size_t i = 1; i < fields.size(); ++i)
        all.push_back({fields[0], fields[i], std::nullopt, location});
      continue;
    }
    if (fields.size() != 2 && fields.size() != 3)
      location.fail(
          "expected a query, a reference and optionally a score; found {} fields. Names with "
          "blanks need commas between the fields",
          fields.size());
    Prediction prediction{fields[0], fields[1], std::nullopt, location};
    if (fields.size() == 3) {
      prediction.score = parse_real(fields[2]);
      if (!prediction.score) location.fail("the score {} is not a finite number", fields[2]);
    }
    if (!all.empty() && all.front().score.has_value() != prediction.score.has_value())
      location.fail("either all lines or none must have a score");
    all.push_back(std::move(prediction));
  }
  return all;
}

void read_query_file(std::vector<Prediction>& all, const fs::path& path) {
  const std::string file = read_whole_file(path);
  FileLocation location{path.string()};
  std::string heading;
  std::optional<std::string> query;
  size_t number = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(file))) {
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
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->path().extension() == ".txt") files.push_back(entry->path());
  if (error)
    throw Error(ErrorKind::input, "{}: cannot be read: {}", folder.string(), error.message());
  if (files.empty())
    throw Error(ErrorKind::input, "{}: there is no .txt file of a query", folder.string());
  std::ranges::sort(files, natural_less,
                    [](const fs::path& path) { return path.filename().string(); });
  return files;
}

/// The frames of one side of a list.
struct ListSide {
  const FrameNames& names;
  const char* noun;
  std::optional<size_t> frames;  ///< as stated, or by the names
  bool has_numbers = false;      ///< its cells are numbers of frames
};

// Cells are numbers if all of them are, and not all of them are names.
ListSide side_of(const std::vector<Prediction>& all, const FrameNames& names, const char* noun,
                 std::optional<size_t> stated, std::string Prediction::*cell) {
  const auto is_number = [](const std::string& text) { return parse_frame(text).has_value(); };
  const auto is_name = [&](const std::string& text) { return names.find(text).has_value(); };
  return {names, noun, names.count() ? names.count() : stated,
          std::ranges::all_of(all, is_number, cell) &&
              (!names.count() || !std::ranges::all_of(all, is_name, cell))};
}

size_t find_frame(const ListSide& side, const std::string& name, const FileLocation& location) {
  if (side.has_numbers) {
    const auto number = parse_frame(name);
    if (!number->in_range || (side.frames && number->value >= *side.frames))
      location.fail(side.frames ? fmt::format("the {} frame {} is out of range; there are {}",
                                              side.noun, name, counted(*side.frames, "frame"))
                                : fmt::format("{} is not a frame number", name));
    return number->value;
  }
  if (const auto frame = side.names.find(name)) return *frame;
  location.fail(
      side.names.count()
          ? fmt::format("no {} frame, or more than one, is called {}", side.noun, name)
          : fmt::format("{} is not a frame number. Name the frames with --query and --train "
                        "(folders, or lists of names)",
                        name));
}

ScoredLists collect(const std::vector<Prediction>& all, const FrameNames& queries,
                    const FrameNames& references, const ListFrames& stated) {
  constexpr uint64_t kMaxScores = uint64_t{1} << 28;  // if only the numbers in the file are known
  const ListSide query_side = side_of(all, queries, "query", stated.query, &Prediction::query);
  const ListSide train_side =
      side_of(all, references, "training", stated.train, &Prediction::reference);
  const bool is_bounded = query_side.frames && train_side.frames;
  ScoredLists lists{train_side.frames.value_or(0), {}};
  lists.queries.resize(query_side.frames.value_or(0));
  for (const Prediction& prediction : all) {
    const FileLocation& location = prediction.location;
    const size_t query = find_frame(query_side, prediction.query, location);
    const size_t reference = find_frame(train_side, prediction.reference, location);
    const size_t rows = std::max(lists.queries.size(), query + 1);
    lists.references = std::max(lists.references, reference + 1);
    if (!is_bounded && (uint64_t{rows} * lists.references > kMaxScores ||
                        std::max(rows, lists.references) > kMaxGrownFrames))
      location.fail(
          "the frame numbers up to here need {} x {} scores; without stated numbers of "
          "frames, the limits are {} scores and {} frames. Pass --query and --train, or "
          "--query-frames and --train-frames",
          rows, lists.references, kMaxScores, kMaxGrownFrames);
    lists.queries.resize(rows);
    auto& list = lists.queries[query];
    const double rank = static_cast<double>(list.size()) + 1;
    list.push_back({reference, prediction.score.value_or(rank)});
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
    return files.size() == 1 ? sums : checksum(std::as_bytes(std::span(sums)));
  };
  return scores;
}

}  // namespace

ScoreMatrix prediction_scores(const fs::path& path, const FrameNames& queries,
                              const FrameNames& references, std::optional<ScoreOrder> kind,
                              const ListFrames& stated) {
  const std::string name = path.string();
  std::error_code error;
  std::vector<fs::path> files = {path};
  std::vector<Prediction> all;
  if (fs::is_directory(path, error)) {
    files = text_files(path);
    for (const fs::path& file : files) read_query_file(all, file);
  } else {
    all = read_list(path);
  }
  if (all.empty()) throw Error(ErrorKind::data, "{}: lists no reference", name);
  const bool has_scores = all.front().score.has_value();
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
  return scores_of(std::make_shared<const ScoredLists>(collect(all, queries, references, stated)),
                   kind, has_scores, files);
}

bool is_index_array(const fs::path& path, size_t references) {
  const NpyArray array(path);
  const NumberType* type = find_number_type(array.type());
  return type != nullptr && type->is_whole && type->bytes >= 4 && array.shape().size() == 2 &&
         array.shape()[1] < references;
}

ScoreMatrix index_scores(const fs::path& path, size_t references) {
  const ScoreFile file(path, {});
  ScoredLists lists{references, {}};
  lists.queries.resize(file.queries());
  std::vector<double> row(file.references());
  for (size_t query = 0; query < lists.queries.size(); ++query) {
    file.read_query(query, 0, row.size(), row.data());
    for (size_t k = 0; k < row.size(); ++k) {
      if (row[k] == -1) continue;  // faiss found no further neighbor
      if (!(row[k] >= 0 && row[k] < static_cast<double>(references)))
        throw Error(ErrorKind::data, "{}, row {}: the index {} is out of range; there are {}",
                    path.string(), query, row[k], counted(references, "training frame"));
      lists.queries[query].push_back({static_cast<size_t>(row[k]), static_cast<double>(k) + 1});
    }
  }
  return scores_of(std::make_shared<const ScoredLists>(std::move(lists)), {}, false, {path});
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
