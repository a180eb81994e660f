// How far query frames are from training frames: whole numbers, whatever frames are described by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "match/frame_runs.h"
#include "store/train_statistics.h"

namespace vpr {

/// Stretches of training frames begin at multiples of this many frames, and are written in whole.
inline constexpr size_t kStretchFrames = 8;

/// What a distance of 1 is: its name after a number, and how much it is of what the method
/// measures.
struct DistanceUnit {
  std::string_view name;  ///< "bits"
  double size = 1;        ///< 2/65535 of a cosine distance, 1/1024 of a deviation
};

/// What makes a score of a training frame's centred distance x: z = (x - mean) / deviation.
struct ScoreScale {
  double mean = 0;
  double deviation = 1;
};

/// Frame distances, from 0 to `largest`, between any frame of a query and any stretch of training
/// frames; smaller is closer. They come tile by tile, with one indirect call a tile. Descriptors
/// must outlive them. Makers fill all members; what decorates distances replaces those that it
/// changes.
struct FrameDistances {
  std::vector<DescriptorSpan> train;  ///< the training sequences, as given
  DescriptorSpan query;
  size_t train_frames = 0;  ///< of all sequences, one after the other
  size_t query_frames = 0;
  std::vector<FrameRun> train_runs;  ///< where windows may lie, rising
  std::vector<FrameRun> query_runs;
  uint16_t largest = 0;
  DistanceUnit unit;

  /// Writes the distances of queries[t] to training frames [first, last) to out[t * stride] and on.
  /// `first` is a multiple of kStretchFrames; up to kStretchFrames - 1 more values may be written
  /// behind each row, and `out` has room for them. May be called from several threads at once.
  std::function<void(std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
                     size_t stride)>
      tile;

  /// The sum of a query frame's distances to all readable training frames. Exact for bits; of
  /// cosine distances and of pictures, rounded once. Not set where it takes as long as the row
  /// (row_sum).
  std::function<uint64_t(size_t query)> row_total;
  size_t readable_frames = 0;  ///< how many those training frames are, whatever train_runs hold

  /// Distances that depend on the frames before: called with a query frame before its row, whose
  /// stretches are then asked for once each. Query frames come in order. Not set where any tile can
  /// be asked for at any time.
  std::function<void(size_t query)> start_row;

  /// Of scores that are learned: what made those of the last row, and what would make them if the
  /// training data, which learning starts from, had counted for little. Not set for distances.
  std::function<ScoreScale(size_t train_frame)> scale;
  std::function<ScoreScale(size_t train_frame)> learned_scale;

  /// Of distances that come in order: that of unrelated training frames, before they were scored.
  double typical_distance = 0;

  /// Of a walk against itself: windows that end at a query frame match those that end before so
  /// many training frames, which rise and never reach the frame itself. Empty: all.
  std::vector<uint32_t> past;

  /// The distances of another query to the same training frames, which are not prepared again. Not
  /// set where they come in order.
  std::function<FrameDistances(const DescriptorSpan& query)> of_query;

  bool is_in_order() const { return static_cast<bool>(start_row); }
};

/// Sums over a few fixed descriptors of the distance to one, times weights.
using Projector = std::function<ComponentValues(DescriptorRow)>;

/// A row of the table of distances: what two descriptors of an element type are compared by.
struct DistanceKind {
  std::string_view name;
  ElementType element;
  DistanceUnit unit;
  uint16_t (*largest)(const DescriptorShape& shape);
  uint32_t (*pair)(DescriptorRow a, DescriptorRow b);     ///< for few pairs; as the tiles say
  uint32_t (*plain)(DescriptorRow a, DescriptorRow b);    ///< the oracle: as the method is stated
  double (*unrounded)(DescriptorRow a, DescriptorRow b);  ///< the oracle's, before it is rounded
  /// By what each element of a descriptor adds to the sums. `weights` has an entry a descriptor;
  /// of multiples of 2^-20 sums of bits are exact, those of cosine distances are to the rounding of
  /// doubles in a fixed order. The descriptors may end before the projector.
  Projector (*projector)(const DescriptorRows& to, std::span<const ComponentValues> weights);
  FrameDistances (*make)(std::span<const DescriptorSpan> train, const DescriptorSpan& query);
};

/// One row for every element type.
std::span<const DistanceKind> distance_kinds();
/// The row of an element type, of which there is one.
const DistanceKind& distance_of(ElementType element);

/// The distances of a query to training sequences, by the kind of their descriptors, which is the
/// same for all. Throws
/// Error(data) for descriptors of different shapes, and for a length that the distance can't take.
FrameDistances frame_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query);

/// Differing bits, for codes of up to 65472 bits; bits of the padding count like any other. Codes
/// of 22 words (LDB) have a kernel of their own.
FrameDistances hamming_distances(std::span<const DescriptorSpan> train,
                                 const DescriptorSpan& query);
/// Differing bits of two codes of one length.
uint32_t hamming_distance(DescriptorRow a, DescriptorRow b);
/// The projector of Hamming distances: `weights` has one entry a row of `to`.
Projector hamming_projector(const DescriptorRows& to, std::span<const ComponentValues> weights);
/// The bits of a shape, which has at most 65472.
uint16_t largest_hamming(const DescriptorShape& shape);

/// 1 - cos, from 0 to 2, in units of 2/65535 and rounded to the nearest, a half up; of vectors of
/// up to 131071 numbers. A vector of zeros is at right angles to all. Scalar products and squared
/// lengths are exact integers, so that every machine gives the same numbers.
FrameDistances cosine_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query);
/// The cosine distance of two vectors of one length, in units of 2/65535.
uint32_t cosine_distance(DescriptorRow a, DescriptorRow b);
/// The projector of cosine distances: `weights` has one entry a row of `to`.
Projector cosine_projector(const DescriptorRows& to, std::span<const ComponentValues> weights);
/// The same for vectors of 16-bit numbers, whose squared length is kMostWideSquare at most
/// (describe/imported.h): a longer one throws Error(data).
FrameDistances wide_cosine_distances(std::span<const DescriptorSpan> train,
                                     const DescriptorSpan& query);
uint32_t wide_cosine_distance(DescriptorRow a, DescriptorRow b);
Projector wide_cosine_projector(const DescriptorRows& to, std::span<const ComponentValues> weights);
/// 65535, whatever the shape.
uint16_t largest_cosine(const DescriptorShape& shape);

/// |a - b| of two points, in the unit of their coordinates and rounded to the nearest, a half up;
/// of points of up to 131071 coordinates that are at most kLongestPoint from the origin
/// (describe/imported.h). Squares are exact. A row's total takes as long as the row.
FrameDistances point_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query);
uint32_t point_distance(DescriptorRow a, DescriptorRow b);
Projector point_projector(const DescriptorRows& to, std::span<const ComponentValues> weights);
/// Of opposite points, whatever the shape.
uint16_t largest_point(const DescriptorShape& shape);

/// The mean absolute difference of two pictures of one size, in 256ths of a grey level and rounded
/// to the nearest, a half up.
FrameDistances grey_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query);
uint32_t grey_distance(DescriptorRow a, DescriptorRow b);
/// Exact for pictures whose number of pixels is a power of two.
Projector grey_projector(const DescriptorRows& to, std::span<const ComponentValues> weights);
/// 255 grey levels, whatever the shape.
uint16_t largest_grey(const DescriptorShape& shape);

/// What makers of distances begin with: all members but those that give distances.
FrameDistances frames_to_compare(std::span<const DescriptorSpan> train,
                                 const DescriptorSpan& query);

/// The largest distance between descriptors of a shape.
uint16_t largest_distance(const DescriptorShape& shape);

/// The distance of two frames of one sequence.
uint32_t frame_distance(const DescriptorRows& rows, size_t a, size_t b);

/// The sum of a row's distances to readable training frames; `row` has one entry a training frame.
uint64_t row_sum(const FrameDistances& distances, std::span<const uint16_t> row);

/// Mean distance of a query frame to all readable training frames: their sum, divided once. 0 where
/// there are none.
double row_mean(const FrameDistances& distances, size_t query);

/// Mean distance of a readable query frame to a readable training frame, over all pairs. 0 where
/// either is empty.
double mean_distance_between(const FrameDistances& distances);

/// Mean distance of two different readable frames of a sequence, over all pairs, from the distances
/// of the sequence to itself. 0 of fewer than two.
double mean_distance_within(const FrameDistances& own);

/// What was measured with LDB, whose largest distance is 1386 bits, as a share of another largest
/// distance: so many of its units are one bit of LDB. Exactly 1 for LDB.
constexpr double reference_bit(uint16_t largest) { return largest / double{kLdbBits}; }

}  // namespace vpr
