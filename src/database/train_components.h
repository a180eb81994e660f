// What the distances of training frames have in common: its leading principal components.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "descriptors/descriptor_rows.h"

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

}  // namespace vpr
