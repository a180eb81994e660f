// A matrix of scores in a .npy file, and its values as integer frame distances.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "base/npy.h"
#include "match/frame_distances.h"

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

/// What whole numbers stand for: the distance k is of the score best + k * unit, or, of
/// similarities, best - k * unit, to the nearest.
struct GivenUnits {
  double best = 0;
  double unit = 1;
  bool is_exact = false;   ///< no score is rounded
  uint16_t largest = 0;    ///< also where there is no score
  double worst_score = 0;  ///< of the file
};

/// A matrix of scores of all pairs of query frames and references, memory-mapped; a block is read
/// when its distances are asked for. Whole numbers whose range fits 16 bits keep their unit; others
/// are rounded to 65535 steps from the best score to the worst, so that a distance is off by half a
/// step at most. The best distance is 0, but that distances which are never negative keep their 0.
/// Infinite scores on the bad side, like NaN, are none.
class GivenDistances {
 public:
  /// Reads the whole file once. Throws Error(input) if it can't be read; Error(data) if it is no
  /// such matrix, has no score, or an infinite one that is better than all; and
  /// Error(interrupted).
  GivenDistances(const std::filesystem::path& path, const ScoreFormat& format,
                 const Monitor& monitor);

  size_t queries() const { return file_.queries(); }
  size_t references() const { return file_.references(); }
  const GivenUnits& units() const { return units_; }
  /// Queries, and references, without any score; rising.
  const std::vector<size_t>& empty_queries() const { return empty_queries_; }
  const std::vector<size_t>& empty_references() const { return empty_references_; }

  /// Writes the distances of a query to references [first, first + count). May be called from
  /// several threads at once; throws Error(data) as the constructor does for a file that changed.
  void read(size_t query, size_t first, size_t count, uint16_t* out) const;
  /// One of them, by the definition of units: what read is compared with.
  uint32_t distance(size_t query, size_t reference) const;

  /// The checksum of the file.
  std::string fingerprint(const Monitor& monitor) const { return file_.fingerprint(monitor); }

 private:
  void scan(const Monitor& monitor);
  double score_of(double number) const;
  bool is_similarity() const { return file_.format().is_similarity; }

  ScoreFile file_;
  GivenUnits units_;
  std::vector<size_t> empty_queries_;
  std::vector<size_t> empty_references_;
};

/// The number of a frame as its descriptor: what stands for a frame of which only distances are
/// known. Numbers first, first + 1, ..., appended to `rows`.
void append_frame_numbers(std::vector<uint8_t>& rows, size_t first, size_t count);
/// The number that a descriptor is.
uint32_t frame_number(DescriptorRow row);

/// The distances that `query.given` holds, of the query frames to the references that descriptors
/// are the numbers of. Throws Error(usage) where nothing is given: distances of training frames to
/// each other are not known.
FrameDistances given_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query);
/// Of frames of one side nothing is known but whether they are the same: 0, or the largest.
uint32_t number_distance(DescriptorRow a, DescriptorRow b);
/// Nothing is known that frames could have in common.
Projector number_projector(const DescriptorRows& to, std::span<const ComponentValues> weights);
uint16_t largest_given(const DescriptorShape& shape);

}  // namespace vpr
