// Protocols of published results on known data sets.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "truth/ground_truth.h"

namespace vpr {

/// Both sequences show the same places at the same time; presets differ in the tolerance of a
/// match. --ground-truth accepts the name.
struct GroundTruthPreset {
  std::string_view name;
  int tolerance_frames;
  /// The data set's query has every `reference_step`-th frame. Applies only to sequences with query
  /// frames = training frames / step, rounded up; others are compared one to one.
  uint32_t reference_step;
  std::string_view source;  ///< the publications that use it
};

/// All presets, in the order of the help text.
std::span<const GroundTruthPreset> ground_truth_presets();

/// The preset with this name, or null.
const GroundTruthPreset* find_preset(std::string_view name);

/// The presets in `text`: names separated by commas, or DATASET-all for all of a data set
/// ("nordland-all"). Throws Error(usage) with the nearest name.
std::vector<const GroundTruthPreset*> find_presets(const std::string& text);

/// The ground truth of a preset. `given` is the user's argument: Error(usage) if it contradicts the
/// preset.
GroundTruthArgument preset_argument(const GroundTruthPreset& preset,
                                    const GroundTruthArgument& given,
                                    const GroundTruthScope& scope);

std::string preset_protocol(const GroundTruthPreset& preset, const std::string& protocol);

}  // namespace vpr
