#include "evaluate/score_matrix.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <utility>

#include "base/checksum.h"
#include "base/error.h"
#include "base/parallel.h"
#include "database/frame_descriptors.h"
#include "match/frame_distances.h"

namespace vpr {
namespace {

constexpr size_t kBlockValues = size_t{1} << 21;  // keys per block, 16 MiB
constexpr size_t kQueryValues = 1 << 20;          // values of query vectors per block
constexpr size_t kReferenceValues = 1 << 15;      // likewise of references: the second-level cache
constexpr size_t kLanes = 8;                      // partial sums, so that compilers can vectorize

// Vectors [first, first + count), scaled to length 1 if `is_unit`; NaN for a missing one.
std::vector<double> read_vectors(const ArrayRows& rows, size_t first, size_t count, bool is_unit) {
  std::vector<double> vectors(count * rows.length());
  rows.read(first, count, vectors);
  for (size_t i = 0; i < count; ++i) {
    const std::span<double> vector(vectors.data() + i * rows.length(), rows.length());
    if (is_missing_vector(vector)) continue;
    if (!is_unit) {
      check_numbers(vector, rows.where(first + i));
      continue;
    }
    check_vector(vector, rows.where(first + i));
    double largest = 0;
    for (const double value : vector) largest = std::max(largest, std::abs(value));
    double squares = 0;
    for (double& value : vector) {
      value /= largest;
      squares += value * value;
    }
    const double norm = std::sqrt(squares);
    for (double& value : vector) value /= norm;
  }
  return vectors;
}

// The scalar product or the squared Euclidean distance. The order of the sum is fixed.
template <bool kIsProduct>
double sum_of_pairs(const double* a, const double* b, size_t length) {
  const auto term = [](double x, double y) { return kIsProduct ? x * y : (x - y) * (x - y); };
  std::array<double, kLanes> sums = {};
  size_t i = 0;
  for (; i + kLanes <= length; i += kLanes)
    for (size_t lane = 0; lane < kLanes; ++lane) sums[lane] += term(a[i + lane], b[i + lane]);
  for (size_t lane = 0; i < length; ++i, ++lane) sums[lane] += term(a[i], b[i]);
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum;
}

// Writes a row of distances to all references for each of the queries [first, first + count).
void compute_distances(DescriptorMetric metric, const ArrayRows& query, const ArrayRows& reference,
                       size_t first, size_t count, std::span<double> distances) {
  const size_t length = query.length();
  const bool is_unit = metric != DescriptorMetric::l2;
  const std::vector<double> queries = read_vectors(query, first, count, is_unit);
  const size_t block = std::max<size_t>(kReferenceValues / length, 1);
  for (size_t r = 0; r < reference.count(); r += block) {
    const size_t together = std::min(block, reference.count() - r);
    const std::vector<double> references = read_vectors(reference, r, together, is_unit);
    for (size_t q = 0; q < count; ++q)
      for (size_t i = 0; i < together; ++i) {
        const double* a = queries.data() + q * length;
        const double* b = references.data() + i * length;
        distances[q * reference.count() + r + i] =
            metric == DescriptorMetric::cosine ? 1 - sum_of_pairs<true>(a, b, length)
                                               : std::sqrt(sum_of_pairs<false>(a, b, length));
      }
  }
}

bool has_bits(const ArrayRows& rows) { return !rows.type().starts_with("<f"); }

// Whether two arrays can be compared, by a metric if one is set.
void require_alike(const SequenceSource& query, const ArrayRows& queries,
                   const SequenceSource& reference, const ArrayRows& references, bool has_metric) {
  const bool have_bits = has_bits(queries);
  if (have_bits != has_bits(references) || (have_bits && queries.type() != references.type()))
    throw Error(ErrorKind::data, "{}: the values have type {}, but in {} they have type {}",
                queries.where(0), queries.type(), references.where(0), references.type());
  if (has_metric && have_bits)
    throw Error(ErrorKind::usage,
                "{}: has type {}, whose bits are compared by Hamming distances, so --metric has no "
                "effect. Omit it or, if the values are numbers, save them as float32",
                queries.where(0), queries.type());
  if (queries.length() != references.length()) {
    const bool is_transposed = queries.count() == references.length() ||
                               queries.length() == references.count() ||
                               queries.count() == references.count();
    throw Error(ErrorKind::data,
                "{}: the array is {} x {}, but {} is {} x {}. Rows are frames, and descriptors "
                "must have the same length{}",
                query.argument.path.string(), queries.count(), queries.length(),
                reference.argument.path.string(), references.count(), references.length(),
                is_transposed ? "; is an array transposed?" : "");
  }
}

}  // namespace

ScoreOrder order_of(const ScoreFormat& format) {
  return format.is_similarity ? ScoreOrder::similarity : ScoreOrder::distance;
}

ScoreFile ScoreInput::open() const {
  return array ? ScoreFile(array, path, format()) : ScoreFile(path, format());
}

void require_order(const ScoreInput& input) {
  if (input.is_distance == input.is_similarity)
    throw Error(ErrorKind::usage,
                "the scores have {}; use --distance (small is better) or --similarity (large is "
                "better)",
                input.is_distance ? "two orders" : "no order");
}

ScoreMatrix::ScoreMatrix(ScoreFile opened) {
  const auto file = std::make_shared<const ScoreFile>(std::move(opened));
  queries = block = file->queries();
  references = file->references();
  kind = order_of(file->format());
  fingerprint = [file](const Monitor& monitor) { return file->fingerprint(monitor); };
  compute = [file](size_t first, size_t count, std::span<double> scores) {
    const size_t width = file->references();
    if (file->is_query_major()) {
      for (size_t q = 0; q < count; ++q) file->read_query(first + q, scores.data() + q * width);
      return file->forget(first, count);
    }
    std::vector<double> column(count);
    for (size_t r = 0; r < width; ++r) {
      file->read_reference(r, first, count, column.data());
      for (size_t q = 0; q < count; ++q) scores[q * width + r] = column[q];
    }
    file->forget(0, width);
  };
}

void ScoreMatrix::for_each_row(size_t workers, const Monitor& monitor, const std::string& step,
                               const RowBody& body) const {
  if (queries == 0) return;
  const size_t together = std::clamp<size_t>(kBlockValues / std::max<size_t>(1, references), 1,
                                             std::min(block, queries));
  StepCounter counter(monitor, step, queries);
  parallel_for(workers, monitor, [&](size_t worker) {
    std::vector<double> scores;
    std::vector<uint64_t> keys;
    for (size_t first = worker * together; first < queries; first += workers * together) {
      const size_t count = std::min(together, queries - first);
      scores.resize(count * references);
      keys.resize(scores.size());
      if (references > 0) compute(first, count, scores);
      for (size_t i = 0; i < scores.size(); ++i) keys[i] = score_key(scores[i], kind);
      for (size_t q = 0; q < count; ++q)
        body(worker, first + q, std::span(keys).subspan(q * references, references));
      counter.add(count);
    }
  });
}

ScoreMatrix descriptor_scores(const SequenceSource& query, const SequenceSource& reference,
                              std::optional<DescriptorMetric> metric_of_vectors,
                              const Monitor& monitor) {
  const DescriptorMetric metric = metric_of_vectors.value_or(DescriptorMetric::cosine);
  for (const SequenceSource* sequence : {&query, &reference})
    if (sequence->kind != SequenceKind::descriptors)
      throw Error(ErrorKind::data, "{}: is not a .npy file of descriptors or a folder of them",
                  sequence->argument.path.string());
  const auto queries = std::make_shared<const ArrayRows>(query);
  const auto references = std::make_shared<const ArrayRows>(reference);
  require_alike(query, *queries, reference, *references, metric_of_vectors.has_value());
  ScoreMatrix scores;
  scores.queries = queries->count();
  scores.references = references->count();
  scores.block = kQueryValues;
  warn_of_bytes(query, *queries, monitor);
  if (has_bits(*queries)) {
    const auto import = [](const SequenceSource& sequence) {
      return std::make_shared<const DescriptorSet>(
          import_descriptors(sequence, kBitKind, Unreadable::fail, {}));
    };
    scores.compute = [q = import(query), r = import(reference)](size_t first, size_t count,
                                                                std::span<double> distances) {
      size_t next = 0;
      for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < r->rows().size(); ++k)
          distances[next++] = hamming_distance(q->rows()[first + i], r->rows()[k]);
    };
  } else {
    scores.block = std::max<size_t>(kQueryValues / queries->length(), 1);
    scores.compute = [queries, references, metric](size_t first, size_t count,
                                                   std::span<double> distances) {
      compute_distances(metric, *queries, *references, first, count, distances);
    };
  }
  scores.fingerprint = [query, reference](const Monitor& stop) {
    std::string sums;
    for (const SequenceSource* sequence : {&query, &reference})
      for (const auto& file : sequence->files) {
        check_stop(stop);
        sums += checksum(NpyArray(file).file_bytes());
      }
    return checksum(sums);
  };
  return scores;
}

ScoreLayout layout_of(const ScoreMatrix& matrix, size_t window_length) {
  assert(window_length >= 1);
  ScoreLayout layout;
  layout.window_length = window_length;
  layout.scope.query.frames = matrix.queries + window_length - 1;
  layout.scope.sequences = {{{std::string(kScoreColumns), matrix.references + window_length - 1}}};
  layout.columns = {{0, 0, matrix.references}};
  return layout;
}

void require_fit(const ScoreMatrix& matrix, const ScoreLayout& layout) {
  if (matrix.queries == row_count(layout) && matrix.references == column_count(layout)) return;
  throw Error(ErrorKind::data,
              "the scores are {} x {}, but the result has {} query windows and {} training "
              "windows. Pass the matrix that was saved with it",
              matrix.queries, matrix.references, row_count(layout), column_count(layout));
}

void label_row(const GroundTruth& truth, const ScoreLayout& layout, size_t row,
               std::vector<PlaceLabel>& labels) {
  labels.assign(column_count(layout), PlaceLabel::different);
  const size_t back = layout.window_length - 1;  // from the anchor to the first frame
  std::vector<PlaceLabel> frames;
  for (const ScoreLayout::Columns& columns : layout.columns) {
    frames.resize(columns.count + back);
    truth.label_row(layout.anchor(row), columns.sequence, frames);
    std::copy(frames.begin() + static_cast<std::ptrdiff_t>(back), frames.end(),
              labels.begin() + static_cast<std::ptrdiff_t>(columns.first));
  }
}

}  // namespace vpr
