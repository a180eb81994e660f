// A matrix of scores in a .npy file, and its values as integer frame distances.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "base/monitor.h"
#include "base/npy.h"
#include "match/frame_distances.h"

namespace vpr {

/// Whether smaller or larger scores are better.
enum class ScoreOrder { distance, similarity };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<ScoreOrder> = {"distance",
                                                                           "similarity"};

/// The meaning of the values of a matrix.
struct ScoreFormat {
  bool is_similarity = false;     ///< large scores are good; false: small ones
  bool train_first = false;       ///< rows of the file are references, columns are queries
  std::optional<double> missing;  ///< this value is not a score; NaN never is
};

/// Scores of queries x references: float16, float32, float64, bool, and integers of 8 to 64 bits,
/// little-endian, in C or Fortran order. Memory-mapped; scores are read on demand.
class ScoreFile {
 public:
  ScoreFile() = default;
  /// Throws Error(input) if the file cannot be read, Error(data) if it is not a matrix of these
  /// types, has no values, or may hold the indices or ranks of references.
  ScoreFile(const std::filesystem::path& path, const ScoreFormat& format);
  /// Throws Error(data) likewise. `name`: of the array in messages.
  ScoreFile(std::shared_ptr<const NpyArray> array, const std::string& name,
            const ScoreFormat& format);

  const std::string& name() const { return name_; }
  const ScoreFormat& format() const { return format_; }
  size_t queries() const { return queries_; }
  size_t references() const { return references_; }
  /// Whether the scores of one query are contiguous, rather than those of one reference.
  bool is_query_major() const { return is_query_major_; }
  /// Whether all scores are integers by their type.
  bool is_whole() const { return type_->is_whole; }
  /// Whether the scores look like indices of references, the best ones of each query.
  bool may_be_indices() const { return may_be_indices_; }

  /// Writes the scores of one query to references [first, first + count); NaN for missing scores.
  /// Thread-safe. Throws Error(data) for integers beyond 2^53, which double cannot represent
  /// exactly.
  void read_query(size_t query, size_t first, size_t count, double* scores) const;
  /// Writes the scores of one reference to queries [first, first + count), likewise.
  void read_reference(size_t reference, size_t first, size_t count, double* scores) const;
  /// Releases the memory of queries [first, first + count), or of references if those are
  /// contiguous.
  void forget(size_t first, size_t count) const;

  /// The checksum of the whole file, as in provenance.
  std::string fingerprint(const Monitor& monitor) const;

 private:
  void read(size_t index, size_t stride, size_t count, double* scores) const;

  std::string name_;
  ScoreFormat format_;
  std::shared_ptr<const NpyArray> array_;
  const NumberType* type_ = nullptr;
  bool is_query_major_ = true;
  bool may_be_indices_ = false;
  size_t queries_ = 0;
  size_t references_ = 0;
};

/// Warns if the scores may be indices.
void warn_of_indices(const ScoreFile& scores, const Monitor& monitor);

/// The meaning of integer distances: the distance k stands for the score best + k * unit or, for
/// similarities, best - k * unit, rounded to nearest.
struct ScoreUnits {
  ScoreOrder kind = ScoreOrder::distance;
  double best = 0;
  double unit = 1;
  bool is_exact = false;  ///< no score is rounded
  uint16_t largest = 0;   ///< also the distance of missing scores; not in files
};

VPR_FIELDS(ScoreUnits, kind, best, unit, is_exact)

/// A matrix of scores of all pairs of query frames and references, memory-mapped; a block is read
/// when its distances are requested. Integers with a range of 16 bits keep their unit; other scores
/// are rounded to 65535 steps from the best to the worst, so the error of a distance is at most
/// half a step. The best distance is 0, but for non-negative distances 0 stays 0. Infinite scores
/// at the worst end are missing, like NaN.
class PrecomputedDistances {
 public:
  /// Reads the whole file once. Throws Error(input) if it cannot be read; Error(data) if it is not
  /// a matrix of scores, has no score, or has an infinite best score; and Error(interrupted).
  PrecomputedDistances(ScoreFile file, const Monitor& monitor);

  size_t queries() const { return file_.queries(); }
  size_t references() const { return file_.references(); }
  const ScoreUnits& units() const { return units_; }
  /// Queries and references without any score; increasing.
  const std::vector<size_t>& empty_queries() const { return empty_queries_; }
  const std::vector<size_t>& empty_references() const { return empty_references_; }

  /// Writes the distances of a query to references [first, first + count). Thread-safe. Throws
  /// Error(data) as the constructor does if the file has changed.
  void read(size_t query, size_t first, size_t count, uint16_t* out) const;
  /// The reference implementation of read() for a single distance.
  uint32_t distance(size_t query, size_t reference) const;

  std::string fingerprint(const Monitor& monitor) const { return file_.fingerprint(monitor); }

 private:
  void scan(const Monitor& monitor);
  double score_of(double number) const;
  bool is_similarity() const { return file_.format().is_similarity; }

  ScoreFile file_;
  ScoreUnits units_;
  std::vector<size_t> empty_queries_;
  std::vector<size_t> empty_references_;
};

/// The number of a frame as its descriptor, for frames with precomputed distances only. Appends the
/// numbers first, first + 1, ... to `rows`.
void append_frame_numbers(std::vector<uint8_t>& rows, size_t first, size_t count);

}  // namespace vpr
