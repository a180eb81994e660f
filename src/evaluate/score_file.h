// A matrix of scores in a .npy file.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/monitor.h"
#include "base/npy.h"

namespace vpr {

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
  /// types or has no values.
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
  /// Bytes per score.
  size_t score_bytes() const { return type_->bytes; }

  /// Writes the scores of one query to all references; NaN for missing scores. Thread-safe. Throws
  /// Error(data) for integers beyond 2^53, which double cannot represent exactly.
  void read_query(size_t query, double* scores) const;
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
  size_t queries_ = 0;
  size_t references_ = 0;
};

/// Warns if the scores may be indices of references, the best ones of each query. Throws
/// Error(data) if every row has the integers 0, 1, ... once.
void warn_of_indices(const ScoreFile& scores, const Monitor& monitor);

}  // namespace vpr
