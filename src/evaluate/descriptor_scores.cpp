#include "evaluate/descriptor_scores.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "describe/frame_descriptors.h"
#include "describe/imported.h"
#include "match/frame_distances.h"

namespace vpr {
namespace {

constexpr size_t kBlockNumbers = 1 << 20;      // of query vectors that are kept at once
constexpr size_t kReferenceNumbers = 1 << 15;  // of reference vectors: the second-level cache
constexpr size_t kLanes = 8;                   // sums of a product that are added last

void require_descriptors(const Sequence& sequence) {
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
std::string fingerprint_of(const Sequence& query, const Sequence& reference,
                           const Monitor& monitor) {
  std::string text;
  for (const Sequence* sequence : {&query, &reference})
    for (const auto& file : sequence->files) {
      check_stop(monitor);
      text += checksum(NpyArray(file).file_bytes());
    }
  return checksum(std::as_bytes(std::span(text)));
}

// Of a d x n array, the lengths are numbers of frames.
[[noreturn]] void refuse_lengths(const Sequence& query, const Sequence& reference) {
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

ComputedScores bit_scores(const Sequence& query, const Sequence& reference) {
  const auto import = [](const Sequence& sequence) {
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

}  // namespace

ScoreMatrix descriptor_scores(const Sequence& query, const Sequence& reference,
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

}  // namespace vpr
