#include "evaluate/score_sources.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/csv.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "describe/frame_descriptors.h"
#include "describe/imported.h"
#include "match/frame_distances.h"
#include "truth/ground_truth.h"

namespace vpr {
namespace {

constexpr size_t kBlockNumbers = 1 << 20;      // of query vectors that are kept at once
constexpr size_t kReferenceNumbers = 1 << 15;  // of reference vectors: the second-level cache
constexpr size_t kLanes = 8;                   // sums of a product that are added last

void require_descriptors(const SequenceSource& sequence) {
  if (sequence.kind != SequenceKind::descriptors)
    throw Error(ErrorKind::data, fmt::format("{}: is no .npy file of descriptors, nor a folder of "
                                             "them",
                                             sequence.argument.path.string()));
}

void scale_to_unit(std::span<double> vector) {
  double largest = 0;
  for (const double number : vector) largest = std::max(largest, std::abs(number));
  double squares = 0;
  for (double& number : vector) {
    number /= largest;
    squares += number * number;
  }
  const double norm = std::sqrt(squares);
  for (double& number : vector) number /= norm;
}

// Vectors [first, first + count), of length 1 or as they are; NaN where one is missing.
std::vector<double> read_vectors(const ArrayRows& rows, size_t first, size_t count, bool is_unit) {
  std::vector<double> vectors(count * rows.length());
  rows.read(first, count, vectors);
  for (size_t i = 0; i < count; ++i) {
    const std::span<double> vector(vectors.data() + i * rows.length(), rows.length());
    if (is_missing_vector(vector)) continue;
    is_unit ? check_vector(vector, rows.where(first + i))
            : check_numbers(vector, rows.where(first + i));
    if (is_unit) scale_to_unit(vector);
  }
  return vectors;
}

// Sums of what pairs of numbers give, in a fixed order, which compilers can work on several of at
// once.
template <double (*of_pair)(double a, double b)>
double sum_of_pairs(const double* a, const double* b, size_t length) {
  std::array<double, kLanes> sums = {};
  size_t i = 0;
  for (; i + kLanes <= length; i += kLanes)
    for (size_t lane = 0; lane < kLanes; ++lane) sums[lane] += of_pair(a[i + lane], b[i + lane]);
  for (size_t lane = 0; i < length; ++i, ++lane) sums[lane] += of_pair(a[i], b[i]);
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum;
}

double product(double a, double b) { return a * b; }
double squared_difference(double a, double b) { return (a - b) * (a - b); }

double cosine_distance(const double* a, const double* b, size_t length) {
  return 1 - sum_of_pairs<product>(a, b, length);
}
double euclidean_distance(const double* a, const double* b, size_t length) {
  return std::sqrt(sum_of_pairs<squared_difference>(a, b, length));
}

/// How vectors are compared.
struct VectorMetric {
  bool is_of_unit_vectors;
  double (*distance)(const double* a, const double* b, size_t length);
};

/// A row for each DescriptorMetric.
constexpr std::array<VectorMetric, 3> kMetrics = {
    {{true, cosine_distance}, {false, euclidean_distance}, {true, euclidean_distance}}};

// `distances` has a row of all references for each of the queries [first, first + count).
void compute_distances(const VectorMetric& metric, const ArrayRows& query,
                       const ArrayRows& reference, size_t first, size_t count,
                       std::span<double> distances) {
  const size_t length = query.length();
  const std::vector<double> asked = read_vectors(query, first, count, metric.is_of_unit_vectors);
  const size_t block = std::max<size_t>(kReferenceNumbers / length, 1);
  for (size_t r = 0; r < reference.count(); r += block) {
    const size_t together = std::min(block, reference.count() - r);
    const std::vector<double> known =
        read_vectors(reference, r, together, metric.is_of_unit_vectors);
    for (size_t q = 0; q < count; ++q)
      for (size_t i = 0; i < together; ++i)
        distances[q * reference.count() + r + i] =
            metric.distance(asked.data() + q * length, known.data() + i * length, length);
  }
}

bool has_bits(const ArrayRows& rows) { return !rows.type().starts_with("<f"); }

// The checksum of the checksums of all files.
std::string fingerprint_of(const SequenceSource& query, const SequenceSource& reference,
                           const Monitor& monitor) {
  std::string text;
  for (const SequenceSource* sequence : {&query, &reference})
    for (const auto& file : sequence->files) {
      check_stop(monitor);
      text += checksum(NpyArray(file).file_bytes());
    }
  return checksum(std::as_bytes(std::span(text)));
}

// Of a d x n array, the lengths are numbers of frames.
[[noreturn]] void refuse_lengths(const SequenceSource& query, const SequenceSource& reference) {
  const ArrayRows a(query);
  const ArrayRows b(reference);
  const bool is_transposed =
      a.count() == b.length() || a.length() == b.count() || a.count() == b.count();
  throw Error(ErrorKind::data,
              fmt::format("{}: has descriptors of length {} ({} x {}), {} of length {} ({} x {}). "
                          "Rows are frames{}",
                          query.argument.path.string(), a.length(), a.count(), a.length(),
                          reference.argument.path.string(), b.length(), b.count(), b.length(),
                          is_transposed ? "; is an array transposed?" : ""));
}

ComputedScores bit_scores(const SequenceSource& query, const SequenceSource& reference) {
  const auto import = [](const SequenceSource& sequence) {
    return std::make_shared<const DescriptorSet>(
        import_descriptors(sequence, kBitKind, Unreadable::fail, {}));
  };
  const auto asked = import(query);
  const auto known = import(reference);
  ComputedScores scores;
  scores.queries = asked->rows().size();
  scores.references = known->rows().size();
  scores.block = kBlockNumbers;
  scores.compute = [asked, known](size_t first, size_t count, std::span<double> distances) {
    for (size_t q = 0; q < count; ++q)
      for (size_t i = 0; i < known->rows().size(); ++i)
        distances[q * known->rows().size() + i] =
            hamming_distance(asked->rows()[first + q], known->rows()[i]);
  };
  return scores;
}

ComputedScores vector_scores(const std::shared_ptr<const ArrayRows>& query,
                             const std::shared_ptr<const ArrayRows>& reference,
                             DescriptorMetric metric) {
  ComputedScores scores;
  scores.queries = query->count();
  scores.references = reference->count();
  scores.block = std::max<size_t>(kBlockNumbers / query->length(), 1);
  scores.compute = [query, reference, how = kMetrics[static_cast<size_t>(metric)]](
                       size_t first, size_t count, std::span<double> distances) {
    compute_distances(how, *query, *reference, first, count, distances);
  };
  return scores;
}

namespace fs = std::filesystem;

/// A line of a list, or of a query's file.
struct Prediction {
  std::string query;
  std::string reference;
  std::optional<double> score;
  std::string where;  ///< for errors: "pairs.txt: line 3"
};

struct Found {
  uint32_t reference = 0;
  double distance = 0;  ///< or similarity
};

/// What is found, by query.
struct Lists {
  size_t references = 0;
  std::vector<std::vector<Found>> queries;
};

std::string where_of(const fs::path& path, size_t line) {
  return fmt::format("{}: line {}", path.string(), line);
}

double parse_score(const std::string& text, const std::string& where) {
  double score = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), score);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(score))
    throw Error(ErrorKind::data, fmt::format("{}: the score {} is no finite number", where, text));
  return score;
}

void add_fields(std::vector<Prediction>& all, const std::vector<std::string>& fields,
                const std::string& where) {
  if (fields.size() != 2 && fields.size() != 3)
    throw Error(ErrorKind::data, fmt::format("{}: expected a query, a reference and perhaps a "
                                             "score, found {} words",
                                             where, fields.size()));
  Prediction one{fields[0], fields[1], std::nullopt, where};
  if (fields.size() == 3) one.score = parse_score(fields[2], where);
  if (!all.empty() && all.front().score.has_value() != one.score.has_value())
    throw Error(ErrorKind::data,
                fmt::format("{}: some lines have a score, and others none", where));
  all.push_back(std::move(one));
}

std::vector<Prediction> read_list(const fs::path& path) {
  const MappedFile file(path);
  std::vector<Prediction> all;
  if (path.extension() == ".csv") {
    for (const CsvRow& row : parse_csv(file.text(), path.string()))
      if (!(all.empty() && !row.fields.empty() && row.fields[0] == "query"))
        add_fields(all, row.fields, where_of(path, row.line));
    return all;
  }
  size_t line_number = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text()))) {
    ++line_number;
    const auto words = split_words(line);
    if (words.empty() || words.front().starts_with('#')) continue;
    add_fields(all, {words.begin(), words.end()}, where_of(path, line_number));
  }
  return all;
}

// One query's file. Lines that end in a colon say what is below them.
void read_query_file(std::vector<Prediction>& all, const fs::path& path) {
  const MappedFile file(path);
  std::string part;
  std::optional<std::string> query;
  size_t line_number = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text()))) {
    ++line_number;
    const std::string where = where_of(path, line_number);
    if (line.empty()) continue;
    if (line == "Query path:" || line == "Predictions paths:" || line == "Positives paths:") {
      part = line;
    } else if (part == "Query path:") {
      if (query) throw Error(ErrorKind::data, fmt::format("{}: a second query", where));
      query = std::string(line);
    } else if (part == "Predictions paths:") {
      if (!query) throw Error(ErrorKind::data, fmt::format("{}: there is no query yet", where));
      all.push_back({*query, std::string(line), std::nullopt, where});
    } else if (part.empty()) {
      throw Error(ErrorKind::data, fmt::format("{}: expected \"Query path:\"", where));
    }
  }
  if (!query)
    throw Error(ErrorKind::data,
                fmt::format("{}: has no query; predictions are files with \"Query path:\" and "
                            "\"Predictions paths:\"",
                            path.string()));
}

std::vector<fs::path> text_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->path().extension() == ".txt") files.push_back(entry->path());
  if (error)
    throw Error(ErrorKind::input,
                fmt::format("{}: can't be read: {}", folder.string(), error.message()));
  if (files.empty())
    throw Error(ErrorKind::input,
                fmt::format("{}: holds no .txt file of a query", folder.string()));
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

size_t find_frame(const FrameNames& names, const std::string& name, const std::string& where,
                  const char* side) {
  if (const auto frame = names.find(name)) return *frame;
  throw Error(ErrorKind::data,
              names.count() ? fmt::format("{}: no {} frame, or more than one, is called {}", where,
                                          side, name)
                            : fmt::format("{}: {} is no frame number; name the frames with --query "
                                          "and --train (folders, or lists of names)",
                                          where, name));
}

// Numbers alone can ask for any matrix; names say how many frames there are.
void check_size(const Prediction& one, size_t queries, size_t references, bool is_named) {
  constexpr uint64_t kMostScores = uint64_t{1} << 31;
  if (is_named || (uint64_t{queries} * references <= kMostScores &&
                   std::max(queries, references) <= kMaxGrownFrames))
    return;
  throw Error(ErrorKind::data,
              fmt::format("{}: the frame numbers up to here need {} x {} scores; the limits are {} "
                          "scores and {} frames. Name the frames with --query and --train "
                          "(folders, or lists of names)",
                          one.where, queries, references, kMostScores, kMaxGrownFrames));
}

Lists collect(const std::vector<Prediction>& all, const FrameNames& queries,
              const FrameNames& references) {
  Lists lists{references.count().value_or(0), {}};
  lists.queries.resize(queries.count().value_or(0));
  for (const Prediction& one : all) {
    const size_t query = find_frame(queries, one.query, one.where, "query");
    const size_t reference = find_frame(references, one.reference, one.where, "training");
    lists.references = std::max(lists.references, reference + 1);
    check_size(one, std::max(lists.queries.size(), query + 1), lists.references,
               queries.count() && references.count());
    if (query >= lists.queries.size()) lists.queries.resize(query + 1);
    std::vector<Found>& found = lists.queries[query];
    const double rank = static_cast<double>(found.size()) + 1;
    found.push_back({static_cast<uint32_t>(reference), one.score.value_or(rank)});
  }
  return lists;
}

void write_rows(const Lists& lists, ScoreOrder kind, size_t first, size_t count,
                std::span<double> out) {
  std::fill(out.begin(), out.end(), std::numeric_limits<double>::quiet_NaN());
  for (size_t q = 0; q < count; ++q)
    for (const Found& found : lists.queries[first + q]) {
      double& score = out[q * lists.references + found.reference];
      if (std::isnan(score) || is_better(found.distance, score, kind)) score = found.distance;
    }
}

}  // namespace

ScoreMatrix descriptor_scores(const SequenceSource& query, const SequenceSource& reference,
                              DescriptorMetric metric) {
  require_descriptors(query);
  require_descriptors(reference);
  const auto asked = std::make_shared<const ArrayRows>(query);
  const auto known = std::make_shared<const ArrayRows>(reference);
  if (has_bits(*asked) != has_bits(*known))
    throw Error(ErrorKind::data, fmt::format("{} are numbers of type {}, {} of {}", asked->where(0),
                                             asked->type(), known->where(0), known->type()));
  if (asked->length() != known->length()) refuse_lengths(query, reference);
  ComputedScores scores =
      has_bits(*asked) ? bit_scores(query, reference) : vector_scores(asked, known, metric);
  scores.fingerprint = [query, reference](const Monitor& monitor) {
    return fingerprint_of(query, reference, monitor);
  };
  return ScoreMatrix(std::move(scores));
}

ScoreMatrix prediction_scores(const fs::path& path, const FrameNames& queries,
                              const FrameNames& references, std::optional<ScoreOrder> kind) {
  std::error_code error;
  std::vector<fs::path> files = {path};
  std::vector<Prediction> all;
  if (fs::is_directory(path, error)) {
    files = text_files(path);
    for (const fs::path& file : files) read_query_file(all, file);
  } else {
    all = read_list(path);
  }
  if (all.empty())
    throw Error(ErrorKind::data, fmt::format("{}: lists no reference", path.string()));
  const bool has_scores = all.front().score.has_value();
  if (has_scores && !kind)
    throw Error(ErrorKind::usage,
                fmt::format("{}: has scores; say what they are: --distance (small is good) or "
                            "--similarity (large is)",
                            path.string()));
  if (!has_scores && kind == ScoreOrder::similarity)
    throw Error(ErrorKind::usage,
                fmt::format("{}: has no scores; ranks are distances: leave --similarity out",
                            path.string()));
  const auto lists = std::make_shared<const Lists>(collect(all, queries, references));
  ComputedScores scores;
  scores.queries = lists->queries.size();
  scores.references = lists->references;
  scores.block = lists->queries.size();
  scores.kind = kind.value_or(ScoreOrder::distance);
  scores.compute = [lists, kind = scores.kind](size_t first, size_t count, std::span<double> out) {
    write_rows(*lists, kind, first, count, out);
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

}  // namespace vpr
