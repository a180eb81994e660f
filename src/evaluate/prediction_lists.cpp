#include "evaluate/prediction_lists.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
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

std::vector<Prediction> read_list(const fs::path& path) {
  const MappedFile file(path);
  FileLocation location{path.string()};
  std::vector<Prediction> all;
  const auto add = [&](const std::vector<std::string>& fields, size_t line) {
    location.at("line", line);
    if (fields.size() != 2 && fields.size() != 3)
      location.fail(
          fmt::format("expected a query, a reference and optionally a score; found {} "
                      "fields",
                      fields.size()));
    Prediction prediction{fields[0], fields[1], std::nullopt, location};
    if (fields.size() == 3) {
      prediction.score = parse_real(fields[2]);
      if (!prediction.score)
        location.fail(fmt::format("the score {} is not a finite number", fields[2]));
    }
    if (!all.empty() && all.front().score.has_value() != prediction.score.has_value())
      location.fail("either all lines or none must have a score");
    all.push_back(std::move(prediction));
  };
  if (path.extension() == ".csv") {
    for (const CsvRow& row : parse_csv(file.text(), path.string()))
      if (!(all.empty() && !row.fields.empty() && row.fields[0] == "query"))
        add(row.fields, row.line);
    return all;
  }
  size_t number = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text()))) {
    ++number;
    const auto words = split_words(line);
    if (words.empty() || words.front().starts_with('#')) continue;
    add({words.begin(), words.end()}, number);
  }
  return all;
}

void read_query_file(std::vector<Prediction>& all, const fs::path& path) {
  const MappedFile file(path);
  FileLocation location{path.string()};
  std::string heading;
  std::optional<std::string> query;
  size_t number = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text()))) {
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
    throw Error(ErrorKind::input,
                fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
  if (files.empty())
    throw Error(ErrorKind::input,
                fmt::format("{}: there is no .txt file of a query", folder.string()));
  std::ranges::sort(files, natural_less,
                    [](const fs::path& path) { return path.filename().string(); });
  return files;
}

size_t find_frame(const FrameNames& names, const std::string& name, const FileLocation& location,
                  const char* side) {
  if (const auto frame = names.find(name)) return *frame;
  location.fail(
      names.count()
          ? fmt::format("no {} frame, or more than one, is called {}", side, name)
          : fmt::format("{} is not a frame number. Name the frames with --query and --train "
                        "(folders, or lists of names)",
                        name));
}

ScoredLists collect(const std::vector<Prediction>& all, const FrameNames& queries,
                    const FrameNames& references) {
  constexpr uint64_t kMaxScores = uint64_t{1} << 31;
  const bool is_bounded = queries.count() && references.count();  // not by the numbers in the file
  ScoredLists lists{references.count().value_or(0), {}};
  lists.queries.resize(queries.count().value_or(0));
  for (const Prediction& prediction : all) {
    const FileLocation& location = prediction.location;
    const size_t query = find_frame(queries, prediction.query, location, "query");
    const size_t reference = find_frame(references, prediction.reference, location, "training");
    const size_t rows = std::max(lists.queries.size(), query + 1);
    lists.references = std::max(lists.references, reference + 1);
    if (!is_bounded && (uint64_t{rows} * lists.references > kMaxScores ||
                        std::max(rows, lists.references) > kMaxGrownFrames))
      location.fail(
          fmt::format("the frame numbers up to here need {} x {} scores; the limits are "
                      "{} scores and {} frames. Name the frames with --query and --train "
                      "(folders, or lists of names)",
                      rows, lists.references, kMaxScores, kMaxGrownFrames));
    lists.queries.resize(rows);
    auto& list = lists.queries[query];
    const double rank = static_cast<double>(list.size()) + 1;
    list.push_back({reference, prediction.score.value_or(rank)});
  }
  return lists;
}

}  // namespace

ScoreMatrix prediction_scores(const fs::path& path, const FrameNames& queries,
                              const FrameNames& references, std::optional<ScoreOrder> kind) {
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
  if (all.empty()) throw Error(ErrorKind::data, fmt::format("{}: lists no reference", name));
  const bool has_scores = all.front().score.has_value();
  if (has_scores && !kind)
    throw Error(ErrorKind::usage,
                fmt::format("{}: the list has scores. Add --distance (lower is better) or "
                            "--similarity (higher is better)",
                            name));
  if (!has_scores && kind == ScoreOrder::similarity)
    throw Error(ErrorKind::usage,
                fmt::format("{}: the list has no scores, and ranks are distances. Omit "
                            "--similarity",
                            name));
  const auto lists = std::make_shared<const ScoredLists>(collect(all, queries, references));
  ComputedScores scores;
  scores.queries = scores.block = lists->queries.size();
  scores.references = lists->references;
  scores.kind = kind.value_or(ScoreOrder::distance);
  scores.are_ranks = !has_scores;
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
  return ScoreMatrix(std::move(scores));
}

std::vector<BestPair> best_pairs(const ScoreMatrix& matrix, const ScoreLayout& layout, size_t most,
                                 const Monitor& monitor) {
  std::vector<std::vector<uint32_t>> columns(matrix.queries());
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
  std::vector<BestPair> pairs;
  for (size_t query = 0; query < columns.size(); ++query)
    for (const uint32_t column : columns[query])
      pairs.push_back({layout.anchor(query), match_of_column(layout, column)});
  return pairs;
}

std::vector<BestPair> best_pairs(const Result& result) {
  std::vector<BestPair> pairs;
  const size_t length = result.window_length();
  for (const auto& best : result.best)
    if (best)
      pairs.push_back(
          {anchor_of(best->query, length), {best->sequence, anchor_of(best->train, length)}});
  return pairs;
}

}  // namespace vpr
