// Protocols under which the field reports results on known data sets.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "truth/ground_truth.h"

namespace vpr {

/// Frames of both sequences show the same places at the same time; what differs is how far off a
/// match may be. Any --ground-truth takes its name.
struct GroundTruthPreset {
  std::string_view name;
  int tolerance_frames;
  /// The data set's query is every so manyth frame. It counts only for sequences of which that can
  /// be true, query frames = training frames / step, rounded up; others are compared one to one.
  uint32_t reference_step;
  std::string_view source;  ///< who reports so
};

/// All protocols, in the order in which help lists them.
std::span<const GroundTruthPreset> ground_truth_presets();

/// The protocol of a name; null if there is none.
const GroundTruthPreset* find_preset(std::string_view name);

/// The presets that `text` names: their names with commas, or DATASET-all for all of a data set
/// ("nordland-all"). Throws Error(usage) naming the nearest.
std::vector<const GroundTruthPreset*> find_presets(const std::string& text);

/// The ground truth that the preset stands for. `given` is what the user said: Error(usage) if it
/// fixes something else than the preset.
GroundTruthArgument preset_argument(const GroundTruthPreset& preset,
                                    const GroundTruthArgument& given,
                                    const GroundTruthScope& scope);

/// `protocol` with the preset's name and source.
std::string preset_protocol(const GroundTruthPreset& preset, const std::string& protocol);

}  // namespace vpr
