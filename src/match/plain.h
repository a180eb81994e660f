// Reference implementations: distances, windows and standardized scores as the papers state them,
// one scalar operation after the other. Also the yardstick of speed-ups.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "describe/descriptor_rows.h"
#include "match/components.h"
#include "match/standardization.h"

namespace vpr {

/// Differing bits, counted byte by byte with a table of 256 entries.
uint32_t plain_hamming(DescriptorRow a, DescriptorRow b);

/// (1 - cos) * 65535 / 2 of two vectors of signed 8-bit numbers, rounded to the nearest, a half up;
/// with cos 0 for a vector of zeros.
uint32_t plain_cosine(DescriptorRow a, DescriptorRow b);

/// The same of two vectors of signed 16-bit numbers, the lower byte first.
uint32_t plain_wide_cosine(DescriptorRow a, DescriptorRow b);

/// The root of the sum of squared differences of signed 16-bit numbers, the lower byte first,
/// rounded to the nearest, a half up.
uint32_t plain_point(DescriptorRow a, DescriptorRow b);

/// The mean absolute difference of two pictures of 8-bit grey levels, times 256, rounded to the
/// nearest, a half up.
uint32_t plain_grey(DescriptorRow a, DescriptorRow b);

/// The same before they are rounded, and not cut off.
double plain_hamming_unrounded(DescriptorRow a, DescriptorRow b);
double plain_cosine_unrounded(DescriptorRow a, DescriptorRow b);
double plain_wide_cosine_unrounded(DescriptorRow a, DescriptorRow b);
double plain_point_unrounded(DescriptorRow a, DescriptorRow b);
double plain_grey_unrounded(DescriptorRow a, DescriptorRow b);

/// The plain distance of two frames, by the element type of their descriptors.
uint32_t plain_distance(const DescriptorRows& a, size_t frame_a, const DescriptorRows& b,
                        size_t frame_b);

/// D(query_window, train_window) by its definition: the sum over k < window_length of the plain
/// distances of train[train_window + k] and query[query_window + k]. Both windows must fit.
uint32_t plain_window_distance(const DescriptorRows& train, size_t train_window,
                               const DescriptorRows& query, size_t query_window,
                               size_t window_length);

/// What the scores of a query need that does not depend on the training frame.
struct PlainUpdates {
  std::vector<double> row_means;      ///< per query frame: mean distance over the training frames
  std::vector<CommonWeights> common;  ///< per query frame
  /// Per query frame: the frame whose distances are learned before it is scored.
  std::vector<std::optional<size_t>> learned;
};

/// `centred_over`: all training frames that rows are centred over, with what can't be read.
PlainUpdates plain_updates(std::span<const DescriptorSpan> centred_over,
                           const DescriptorSpan& query, const ScoreBasis& basis,
                           const Monitor& monitor);

/// z of every query frame to one training frame, within [-32, 32). W, S1 and S2 are the weight, the
/// sum and the sum of squares: mean S1 / W, variance S2 / W - mean^2. `frame`: which of the
/// basis's training frames it is.
std::vector<double> plain_frame_scores(DescriptorRow train, size_t frame,
                                       const DescriptorRows& query, const PlainUpdates& updates,
                                       const ScoreBasis& basis);

/// The largest difference of a window's score in fixed point from that in double precision: half a
/// unit per frame is rounded away, and single-precision statistics may cost as much again.
double score_tolerance(size_t window_length);

}  // namespace vpr
