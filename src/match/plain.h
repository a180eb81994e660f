// Reference implementations: distances, windows and z-scores as stated in the papers, one scalar
// operation after the other. Also the baseline of speed-ups.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "describe/descriptor_rows.h"
#include "match/components.h"
#include "match/zscore_model.h"

namespace vpr {

/// Differing bits, counted byte by byte with a table of 256 entries.
uint32_t plain_hamming(DescriptorRow a, DescriptorRow b);

/// (1 - cos) * 65535 / 2 of two vectors of signed 8-bit integers, rounded to nearest, ties up; cos
/// is 0 for a vector of zeros.
uint32_t plain_cosine(DescriptorRow a, DescriptorRow b);

/// As plain_cosine for vectors of signed 16-bit integers, little-endian.
uint32_t plain_wide_cosine(DescriptorRow a, DescriptorRow b);

/// The Euclidean distance of vectors of signed 16-bit integers, little-endian, rounded to nearest,
/// ties up.
uint32_t plain_point(DescriptorRow a, DescriptorRow b);

/// The mean absolute difference of two images with 8-bit gray levels, times 256, rounded to
/// nearest, ties up.
uint32_t plain_gray(DescriptorRow a, DescriptorRow b);

/// The distances before rounding and clamping.
double plain_hamming_unrounded(DescriptorRow a, DescriptorRow b);
double plain_cosine_unrounded(DescriptorRow a, DescriptorRow b);
double plain_wide_cosine_unrounded(DescriptorRow a, DescriptorRow b);
double plain_point_unrounded(DescriptorRow a, DescriptorRow b);
double plain_gray_unrounded(DescriptorRow a, DescriptorRow b);

/// The reference distance of two frames, by the element type of their descriptors.
uint32_t plain_distance(const DescriptorRows& a, size_t frame_a, const DescriptorRows& b,
                        size_t frame_b);

/// D(query_window, train_window) by definition: the sum over k < window_length of the reference
/// distances of train[train_window + k] and query[query_window + k]. Both windows must fit.
uint32_t plain_window_distance(const DescriptorRows& train, size_t train_window,
                               const DescriptorRows& query, size_t query_window,
                               size_t window_length);

/// The parts of a query's scores that do not depend on the training frame.
struct PlainUpdates {
  std::vector<double> row_means;      ///< per query frame: mean distance over the training frames
  std::vector<CommonWeights> common;  ///< per query frame
  /// Per query frame: the frame whose distances are learned before it is scored.
  std::vector<std::optional<size_t>> learned;
};

/// `centered_over`: all training frames of the row mean, including unreadable ones.
PlainUpdates plain_updates(std::span<const DescriptorSpan> centered_over,
                           const DescriptorSpan& query, const ScoreBasis& basis,
                           const Monitor& monitor);

/// z of every query frame to one training frame, within [-32, 32). W, S1 and S2 are the weight, the
/// sum and the sum of squares: mean S1 / W, variance S2 / W - mean^2. `frame`: its index in the
/// training frames of the basis.
std::vector<double> plain_frame_scores(DescriptorRow train, size_t frame,
                                       const DescriptorRows& query, const PlainUpdates& updates,
                                       const ScoreBasis& basis);

/// The maximum difference of a window's score in fixed point to that in double precision: rounding
/// costs half a unit per frame, and single-precision statistics may cost the same again.
double score_tolerance(size_t window_length);

}  // namespace vpr
