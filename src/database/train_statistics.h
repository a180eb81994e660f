// Statistics of the distances between training frames: bias and variance of each frame, and the
// leading principal components.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/json_fwd.h"
#include "database/descriptor_rows.h"

namespace vpr {

inline constexpr size_t kMaxComponents = 6;

/// One value per component; 0 for missing components.
using ComponentValues = std::array<double, kMaxComponents>;

/// Estimated on a few training frames, the landmarks, which are spread evenly over all keyframes.
/// Component k of a descriptor is the weighted sum of its distances to the landmarks.
struct TrainComponents {
  DescriptorShape shape;
  std::vector<size_t> landmarks;  ///< indices of training frames, increasing
  std::vector<uint8_t> bytes;     ///< the landmarks' descriptors
  /// One entry per landmark: orthogonal unit vectors, the strongest component first, rounded to
  /// multiples of 2^-20.
  std::vector<ComponentValues> weights;
  /// Multiplier from a component of a frame to the amount subtracted from the distances of the
  /// frame, in the units of ComponentTerm::weights.
  ComponentValues factor = {};
  /// The loading of each training frame on each component, from -127 to 127, by component, then by
  /// training frame.
  std::array<std::vector<int8_t>, kMaxComponents> loadings;

  bool operator==(const TrainComponents&) const = default;
  DescriptorRows rows() const { return {shape, bytes}; }
};

/// A training frame of a place that the training sequences passed before. Frames count over all
/// sequences.
struct RepeatedPlace {
  uint32_t frame = 0;
  uint32_t first_pass = 0;  ///< the frame of the first pass, less than `frame`

  bool operator==(const RepeatedPlace&) const = default;
};

/// The training frames that each training frame is compared with.
struct StatisticsSettings {
  uint64_t neighbor_frames = 5;
  double neighbor_share = 0.02;
  uint64_t samples = 10'000;
  uint64_t seed = 1;

  bool operator==(const StatisticsSettings&) const = default;
};

VPR_FIELDS(StatisticsSettings,
           (neighbor_frames, "Frames of the same sequence this close are excluded."),
           (neighbor_share,
            "Same, as a share of the frames of the sequence; the larger one counts.", within(0, 1)),
           (samples, "Training frames to compare each frame with.", at_least(1)),
           (seed, "Seed of their choice."))

/// Distance statistics of each training frame to the rest of the training data: the initial values
/// of z-scores. One entry per training frame of the database, in the order of its codes.
struct TrainStatistics {
  StatisticsSettings settings;
  /// Mean distance of training frames that are not neighbors.
  double typical_distance = 0;
  /// The mean distance of a frame minus the typical one: negative for a hub, a frame that is close
  /// to everything.
  std::vector<float> bias;
  std::vector<float> variance;  ///< of its distances
  /// Computed on demand and not stored.
  std::optional<TrainComponents> components = std::nullopt;
  /// The typical distance of LDB codes alone, if the frames also have HOG vectors.
  std::optional<double> code_distance = std::nullopt;

  bool operator==(const TrainStatistics&) const = default;
};

}  // namespace vpr
