// Distances of query frames to training frames: integers, for descriptors of any kind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/monitor.h"
#include "base/parallel.h"
#include "database/descriptor_rows.h"
#include "database/train_statistics.h"

namespace vpr {

constexpr size_t divide_up(size_t value, size_t divisor) { return (value + divisor - 1) / divisor; }
constexpr size_t round_up(size_t value, size_t multiple) {
  return divide_up(value, multiple) * multiple;
}

/// Consecutive readable frames of one sequence. Windows lie within a stretch and never cross its
/// end: an unreadable frame and the end of a sequence end it.
struct FrameStretch {
  size_t first = 0;  ///< in all frames of the set
  size_t count = 0;
  size_t sequence = 0;
  size_t first_in_sequence = 0;

  size_t windows(size_t window_length) const {
    return count < window_length ? 0 : count - window_length + 1;
  }
};

/// The runs of one sequence between its unreadable frames.
std::vector<FrameStretch> readable_runs(const DescribedFrames& sequence);

/// The runs of several sequences, one after the other.
std::vector<FrameStretch> readable_runs(std::span<const DescribedFrames> sequences);

/// The number of frames of all sequences, including unreadable ones.
size_t count_frames(std::span<const DescribedFrames> sequences);

/// The number of windows in all runs; 0 if every run is shorter than a window.
size_t count_windows(std::span<const FrameStretch> runs, size_t window_length);

/// Whether each of `frames` frames is in a run: 1 or 0.
std::vector<uint8_t> readable_flags(std::span<const FrameStretch> runs, size_t frames);

/// Ranges of training frames begin at multiples of this number of frames, and are written in whole.
inline constexpr size_t kBlockFrames = 8;

/// The unit of distances: its name after a number, and its size in the units of the method.
struct DistanceUnit {
  std::string_view name;  ///< "bits"
  double size = 1;        ///< 2/65535 of a cosine distance
};

/// Frame distances, from 0 to `largest`, between any frame of a query and any range of training
/// frames; smaller is closer. Tiles are computed with one indirect call each. Descriptors must
/// outlive them.
struct FrameDistances {
  std::vector<DescribedFrames> train;  ///< the training sequences
  DescribedFrames query;
  size_t train_frames = 0;  ///< of all sequences, one after the other
  size_t query_frames = 0;
  std::vector<FrameStretch> train_runs;  ///< runs in which windows may lie, increasing
  std::vector<FrameStretch> query_runs;
  uint16_t largest = 0;

  /// Writes the distances of queries[t] to training frames [first, last) to out[t * stride] and on.
  /// `first` is a multiple of kBlockFrames; up to kBlockFrames - 1 more values may be written
  /// after each row, and `out` has room for them. Thread-safe.
  std::function<void(std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
                     size_t stride)>
      tile;

  /// The sum of a query frame's distances to all readable training frames. Exact for bits; rounded
  /// once for cosine distances and images. Not set if it takes as long as the row (row_sum).
  std::function<uint64_t(size_t query)> row_total;
  size_t readable_frames = 0;  ///< number of readable training frames

  /// Set for distances in order, as those that depend on earlier frames: call it with a query frame
  /// before its row, and then request each range of the row once. Query frames must come in order.
  /// Not set if any tile can be computed at any time.
  std::function<void(size_t query)> start_row;

  /// For distances in order: the distance of unrelated training frames before normalization.
  double typical_distance = 0;

  /// For a sequence against itself: past[q] is the exclusive upper bound of the training frames
  /// that query frame q may match. Non-decreasing, at most q. Empty: all frames.
  std::vector<uint32_t> past;

  /// The distances of another query to the same training frames, which are not prepared again. Not
  /// set for distances in order.
  std::function<FrameDistances(const DescribedFrames& query)> of_query;

  bool is_in_order() const { return static_cast<bool>(start_row); }
};

/// A score stage that was started for one query. The query arrives in one part or more: a part has
/// frames of the part before that a stage needs again, and new ones.
struct StartedStage {
  /// The scores of a part, whose first frames are the frames `kept` of the part before.
  std::function<FrameDistances(FrameDistances input, std::span<const size_t> kept)> scores;
  /// The frames of the last part that later scores need, increasing. Not set: none.
  std::function<std::vector<size_t>()> needed = {};
};

/// The minimum separation of two frames of one place that close a loop, inclusive.
struct LoopGap {
  std::optional<int64_t> nanoseconds;  ///< unset: `frames`
  size_t frames = 1;
};

/// Whether frame `match` is before frame `query` by at least the gap. `times_ns`, which increase,
/// are used only for a gap in time.
bool is_past(const LoopGap& gap, std::span<const int64_t> times_ns, size_t query, size_t match);

/// FrameDistances::past: for each frame, the number of frames from the first on that are past.
std::vector<uint32_t> past_frames(const LoopGap& gap, std::span<const int64_t> times_ns,
                                  size_t frames);

/// Weighted sums of the distances of a descriptor to fixed descriptors.
using Projector = std::function<ComponentValues(DescriptorRow)>;

/// Training frames in the format of the kernels. Sets the members of `distances` that compare its
/// query with them: tile and, if it is faster than the row, row_total.
using PreparedTraining = std::function<void(FrameDistances& distances)>;

/// An entry of the table of distances: the distance of two descriptors of an element type.
struct DistanceKind {
  ElementType element;
  DistanceUnit unit;
  uint16_t (*largest)(const DescriptorShape& shape);
  uint32_t (*pair)(DescriptorRow a, DescriptorRow b);  ///< for few pairs; equals the tiles
  /// Uses the contribution of each element of a descriptor to the sums. `weights` has one entry per
  /// row of `to`; for multiples of 2^-20, sums of bits are exact, and sums of cosine distances are
  /// rounded as doubles in a fixed order. The projector may outlive the descriptors.
  Projector (*projector)(const DescriptorRows& to, std::span<const ComponentValues> weights);
  /// `shape`: of all descriptors. Throws Error(data) for descriptors that the distance does not
  /// support.
  PreparedTraining (*prepare)(std::span<const DescribedFrames> train, const DescriptorShape& shape);
};

/// Numbers of differing bits, for codes of up to 65472 bits; bits of the padding count as well.
/// Codes of 22 words (LDB) have a separate kernel.
extern const DistanceKind kHammingDistance;

/// 1 - cos, from 0 to 2, in units of 2/65535 and rounded to nearest, ties up; for vectors of up to
/// 131071 values, of 8 bits, or of 16 bits with a squared length of at most kMaxSquaredLength
/// (database/imported.h). A vector of zeros is orthogonal to all others. Scalar products and
/// squared lengths are exact integers, so that every machine gives the same numbers.
extern const DistanceKind kCosineDistance;
extern const DistanceKind kWideCosineDistance;

/// |a - b| of two points, in the unit of their coordinates and rounded to nearest, ties up; for
/// points of up to 131071 coordinates that are at most kLongestPoint from the origin
/// (database/imported.h). Squares are exact. A row's total takes as long as the row.
extern const DistanceKind kPointDistance;

/// The mean absolute difference of two images of one size, in 256ths of a gray level and rounded to
/// nearest, ties up. Projections are exact if the number of pixels is a power of two.
extern const DistanceKind kGrayDistance;

/// The Hamming distance of the LDB codes plus the cosine distance of the HOG vectors, in units of
/// 2/256 and rounded to nearest, ties up. Rows of bytes 0 have a distance of 128.
extern const DistanceKind kLdbHogDistance;

/// The entry of an element type.
const DistanceKind& distance_of(ElementType element);

/// The distances of a query to training sequences, for the kind of their descriptors, which must be
/// the same for all. Throws Error(data) for descriptors of different shapes, and for a length that
/// the distance does not support.
FrameDistances frame_distances(std::span<const DescribedFrames> train,
                               const DescribedFrames& query);

uint16_t largest_distance(const DescriptorShape& shape);

/// The number of differing bits of two codes.
uint32_t hamming_distance(DescriptorRow a, DescriptorRow b);

/// The distance of two frames of one sequence.
uint32_t frame_distance(const DescriptorRows& rows, size_t a, size_t b);

/// Calls body(first, last) for chunks of a row of training frames, whose descriptors stay in the
/// second-level cache. Threads share rows that are long enough to gain from it.
void for_each_chunk(size_t frames, const std::function<void(size_t first, size_t last)>& body);

/// Computes the distances of a query frame to all training frames. `row` gets one entry per
/// training frame, followed by kBlockFrames unspecified ones.
void compute_row(const FrameDistances& distances, size_t query, std::vector<uint16_t>& row);

/// The same distances, in order, computed for 16 query frames at once: training frames are read
/// less often, and threads share shorter rows. Takes 32 bytes per training frame. Not for a
/// sequence against itself.
FrameDistances read_ahead(FrameDistances distances);

/// The sum of a row's distances to readable training frames; `row` has one entry per training
/// frame.
uint64_t row_sum(const FrameDistances& distances, std::span<const uint16_t> row);

/// Mean distance of a query frame to all readable training frames: their sum, divided once. 0 if
/// there are none.
double row_mean(const FrameDistances& distances, size_t query);

/// Mean distance over all pairs of readable query and training frames. 0 if there are none.
double mean_distance_between(const FrameDistances& distances);

/// Mean distance of two different readable frames of a sequence, over all pairs, from the distances
/// of the sequence to itself. 0 for fewer than two frames.
double mean_distance_within(const FrameDistances& own);

/// Converts constants measured with LDB, whose largest distance is 1386 bits, to another largest
/// distance: the size of one bit of LDB in its units. Exactly 1 for LDB.
constexpr double reference_bit(uint16_t largest) { return largest / double{kLdbBits}; }

}  // namespace vpr
