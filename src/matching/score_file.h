// A matrix of scores of any program, in a .npy file: the one reader of such files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/monitor.h"
#include "base/npy.h"

namespace vpr {

/// The meaning of the values of a matrix.
struct ScoreFormat {
  bool is_similarity = false;     ///< large scores are good, or else small ones
  bool references_first = false;  ///< rows of the file are references, columns are queries
  std::optional<double> missing;  ///< this value is not a score; NaN never is
};

/// Scores of queries x references: float16, float32, float64, bool, and integers of 8 to 64 bits,
/// little-endian, in C or Fortran order. Memory-mapped; a score is read when it is asked for.
class ScoreFile {
 public:
  ScoreFile() = default;
  /// Throws Error(input) if the file can't be read, Error(data) if it is not such a matrix, or has
  /// no values.
  ScoreFile(const std::filesystem::path& path, const ScoreFormat& format);

  const std::string& name() const { return name_; }
  const ScoreFormat& format() const { return format_; }
  size_t queries() const { return queries_; }
  size_t references() const { return references_; }
  /// Whether the scores of one query lie side by side, or else those of one reference.
  bool is_query_major() const { return is_query_major_; }
  /// Whether all scores are integers by their type.
  bool is_whole() const { return type_->is_whole; }

  /// Writes the scores of one query to references [first, first + count); NaN where there is none.
  /// May be called from several threads at once. Throws Error(data) for integers beyond 2^53, which
  /// doubles do not tell apart.
  void read_query(size_t query, size_t first, size_t count, double* scores) const;
  /// The same for the scores of one reference to queries [first, first + count).
  void read_reference(size_t reference, size_t first, size_t count, double* scores) const;
  /// Releases the memory of queries [first, first + count), or of references where those lie side
  /// by side.
  void forget(size_t first, size_t count) const;

  /// The checksum of the whole file, as in provenance.
  std::string fingerprint(const Monitor& monitor) const;

 private:
  void read(size_t index, size_t stride, size_t count, double* scores) const;
  size_t line_values() const { return is_query_major_ ? references_ : queries_; }

  std::string name_;
  ScoreFormat format_;
  NpyArray array_;
  const NumberType* type_ = nullptr;
  bool is_query_major_ = true;
  size_t queries_ = 0;
  size_t references_ = 0;
};

}  // namespace vpr
