// How far each training frame is from the rest of the training data: the start of standardized
// scores.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "database/train_components.h"

namespace vpr {

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

/// One entry a training frame of the database, in the order of its codes.
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
