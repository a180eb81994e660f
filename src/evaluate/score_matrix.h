// A query x reference matrix of scores, read or computed in blocks of rows; never whole in memory.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "database/imported.h"
#include "evaluate/score_file.h"
#include "query/score_layout.h"

namespace vpr {

ScoreOrder order_of(const ScoreFormat& format);

/// A matrix of scores of any program, by the names of flags.
struct ScoreInput {
  std::string path;                            ///< empty: none
  std::shared_ptr<const NpyArray> array = {};  ///< in memory; `path` names it in messages
  bool is_distance = false;
  bool is_similarity = false;
  bool train_first = false;
  std::optional<double> missing = {};

  bool has_order() const { return is_distance || is_similarity; }
  ScoreFormat format() const { return {is_similarity, train_first, missing}; }
  ScoreOrder order() const { return order_of(format()); }
  /// Throws as ScoreFile does.
  ScoreFile open() const;
};

template <class Visitor>
void visit_fields(ScoreInput& input, Visitor&& visit) {
  visit("distance", input.is_distance);
  visit("similarity", input.is_similarity);
  visit("train_first", input.train_first);
  visit("missing", input.missing);
}

/// Throws Error(usage) unless the scores are either distances or similarities.
void require_order(const ScoreInput& input);

/// Scores that are read or computed on demand.
struct ScoreMatrix {
  size_t queries = 0;
  size_t references = 0;
  size_t block = 1;  ///< maximum number of queries that are computed together
  ScoreOrder kind = ScoreOrder::distance;
  bool has_scores = true;  ///< false: ranks 1, 2, ... by query, comparable within a query only
  bool has_names = false;  ///< the frames of the query and of training were named
  /// Writes the scores of queries [first, first + count) to all references, row by row; NaN for a
  /// missing score. Thread-safe.
  std::function<void(size_t first, size_t count, std::span<double> scores)> compute;
  /// The checksum of the file or of the sources of computed scores, as in provenance.
  std::function<std::string(const Monitor& monitor)> fingerprint;

  ScoreMatrix() = default;
  explicit ScoreMatrix(ScoreFile file);
  /// Throws as ScoreFile does.
  ScoreMatrix(const std::filesystem::path& path, const ScoreFormat& format)
      : ScoreMatrix(ScoreFile(path, format)) {}

  /// Receives the keys (score_key) of one query to all references, valid during the call.
  using RowBody = std::function<void(size_t worker, size_t query, std::span<const uint64_t> keys)>;
  /// Calls body once per query, in any order. `workers` (at least 1) calls may run at once, each
  /// with its own number below `workers`. Throws Error(data) for 64-bit integers beyond 2^53, which
  /// double cannot represent exactly.
  void for_each_row(size_t workers, const Monitor& monitor, const std::string& step,
                    const RowBody& body) const;
};

/// Distances of all pairs of descriptors: for vectors the metric (default: cosine), with sums of
/// float64 in a fixed order; for uint8, with a warning, and bool the Hamming distance, without a
/// metric. A row of NaN has no scores. Throws Error(data) for sequences without descriptors or of
/// different types or lengths; invalid vectors (import_descriptors) are found when scores are read.
ScoreMatrix descriptor_scores(const SequenceSource& query, const SequenceSource& reference,
                              std::optional<DescriptorMetric> metric_of_vectors,
                              const Monitor& monitor);

/// A matrix with one training sequence, called "references". window_length is at least 1.
ScoreLayout layout_of(const ScoreMatrix& matrix, size_t window_length);

/// Throws Error(data) unless the matrix has the rows and columns of the layout.
void require_fit(const ScoreMatrix& matrix, const ScoreLayout& layout);

/// The labels of all columns for the query window `row`; resizes `labels`.
void label_row(const GroundTruth& truth, const ScoreLayout& layout, size_t row,
               std::vector<PlaceLabel>& labels);

}  // namespace vpr
