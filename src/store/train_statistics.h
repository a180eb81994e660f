// What is learned from the distances of training frames: bias and variance of each frame, and the
// leading principal components.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "describe/descriptor_rows.h"

namespace vpr {

inline constexpr size_t kMostComponents = 6;

/// One number a component; 0 for those that there are not.
using ComponentValues = std::array<double, kMostComponents>;

/// Found on a few training frames, the landmarks, which lie evenly among all views. The
/// component k of any descriptor is the sum of its distances to the landmarks, times their weights.
struct TrainComponents {
  DescriptorShape shape;
  std::vector<size_t> landmarks;  ///< among all training frames, rising
  std::vector<uint8_t> bytes;     ///< the landmarks' descriptors
  /// One entry a landmark: unit vectors at right angles to each other, the strongest component
  /// first, rounded to multiples of 2^-20.
  std::vector<ComponentValues> weights;
  /// A component of a frame, times this, is how much of it is taken from the frame's distances; in
  /// the units of CommonPart::weights.
  ComponentValues factor = {};
  /// How much a training frame shows of a component, from -127 to 127: a component, then a training
  /// frame.
  std::array<std::vector<int8_t>, kMostComponents> loadings;

  bool operator==(const TrainComponents&) const = default;
  DescriptorRows rows() const { return {shape, bytes}; }
};

struct FusedViews;

/// Which training frames each training frame is compared with.
struct StatisticsSettings {
  /// Frames of the same sequence up to max(neighbour_frames, neighbour_share * its frames) away
  /// show nearly the same place, and are left out.
  uint64_t neighbour_frames = 5;
  double neighbour_share = 0.02;
  uint64_t samples = 10'000;  ///< training frames to compare with; all where there are fewer
  uint64_t seed = 1;          ///< of their choice

  bool operator==(const StatisticsSettings&) const = default;
};

template <class Visitor>
void visit_fields(StatisticsSettings& settings, Visitor&& visit) {
  visit("neighbour_frames", settings.neighbour_frames);
  visit("neighbour_share", settings.neighbour_share);
  visit("samples", settings.samples);
  visit("seed", settings.seed);
}

/// How far each training frame is from the rest of the training data: the start of standardized
/// scores. One entry a training frame of the database, in the order of its codes.
struct TrainStatistics {
  StatisticsSettings settings;
  /// Mean frame distance of training frames that are no neighbours.
  double typical_distance = 0;
  /// A frame's own mean distance less the typical one: below 0 for a hub, a frame that is close to
  /// everything.
  std::vector<float> bias;
  std::vector<float> variance;  ///< of its distances
  /// Found when a score asks for them, and not stored.
  std::optional<TrainComponents> components = std::nullopt;
  /// What FAB-MAP knows of the frames, where scores are to be fused with it; not stored.
  std::shared_ptr<const FusedViews> fused = nullptr;

  bool operator==(const TrainStatistics&) const = default;
};

}  // namespace vpr
