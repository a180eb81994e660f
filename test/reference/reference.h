// Reference implementations: distances, windows and z-scores as stated in the papers, one scalar
// operation after the other.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "database/descriptor_rows.h"
#include "match/components.h"
#include "match/match.h"
#include "match/zscores.h"

namespace vpr {

/// Differing bits, counted byte by byte.
uint32_t reference_hamming(DescriptorRow a, DescriptorRow b);

/// The distance of two descriptors before rounding and clamping: differing bits; (1 - cos) * 65535
/// / 2, where cos is 0 for a vector of zeros; the Euclidean distance; or the mean absolute
/// difference of two images, times 256; LDB and HOG: a sum. Integers are signed and little-endian.
double reference_unrounded(ElementType element, DescriptorRow a, DescriptorRow b);

/// Rounded to nearest, ties up, and at most 65535; of two descriptors, the sum of both so rounded.
uint32_t reference_distance(ElementType element, DescriptorRow a, DescriptorRow b);
uint32_t reference_distance(const DescriptorRows& a, size_t frame_a, const DescriptorRows& b,
                            size_t frame_b);

/// D(query_window, train_window): the sum over k < window_length of the reference distances of
/// train[train_window + k] and query[query_window + k]. Both windows must fit.
uint32_t reference_window_distance(const DescriptorRows& train, size_t train_window,
                                   const DescriptorRows& query, size_t query_window,
                                   size_t window_length);

/// The parts of a query's scores that do not depend on the training frame.
struct ReferenceUpdates {
  std::vector<double> row_means;  ///< per query frame: mean distance over the training frames
  std::vector<ComponentWeights> common;  ///< per query frame
  /// Per query frame: the frame whose distances are learned before it is scored.
  std::vector<std::optional<size_t>> learned;
};

/// `centered_over`: all training frames of the row mean, including unreadable ones.
ReferenceUpdates reference_updates(std::span<const DescribedFrames> centered_over,
                                   const DescribedFrames& query, const ScoreBasis& basis,
                                   const Monitor& monitor);

/// z of every query frame to one training frame, within [-32, 32), from the weight W, the sum S1
/// and the sum of squares S2 of learned distances: mean S1 / W, variance S2 / W - mean^2. `frame`:
/// the index of the training frame in the basis.
std::vector<double> reference_frame_scores(DescriptorRow train, size_t frame,
                                           const DescriptorRows& query,
                                           const ReferenceUpdates& updates,
                                           const ScoreBasis& basis);

/// The maximum error of a window's score in deviations: rounding costs half a unit per frame, and
/// single-precision statistics may cost the same again.
double score_tolerance(size_t window_length);

/// The cells whose distance differs from the reference implementation's, with the correct distance.
std::vector<Cell> wrong_cells(std::span<const Cell> cells, std::span<const DescribedFrames> train,
                              const DescriptorRows& query, size_t window_length,
                              const Monitor& monitor);

/// The cells whose biased sum of z-scores differs from the reference implementation's by more than
/// score_tolerance, with the correct sum, rounded to fixed point. `basis`: of all sequences.
std::vector<Cell> wrong_scores(std::span<const Cell> cells, std::span<const DescribedFrames> train,
                               const DescribedFrames& query, size_t window_length,
                               const ScoreBasis& basis, const Monitor& monitor);

}  // namespace vpr
