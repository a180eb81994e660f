// The grids of vpr-tune: what the flags say, or defaults.
#pragma once

#include <span>
#include <string>

#include "run/sweep.h"

namespace vpr {

/// Lists as the flags take them; an empty one stands for the default.
struct GridFlags {
  std::string windows;     ///< c_l or c_w
  std::string thresholds;  ///< t_r or t_p
  std::string margins;     ///< instead of t_r, with --decide margin
};

/// The default c_l are those of 5, 10, 20, 40 and 80 that fit the query and a training sequence (5
/// where none does); the default t_r, or margins, go over the scale of the settings. Throws
/// Error(usage) as the lists do.
Grid sequence_grid(const GridFlags& flags, const SequenceQuerySettings& settings,
                   const SequenceDatabase& database, const DescriptorSet& query);
Grid fabmap_grid(const GridFlags& flags);

/// The c_l to calibrate: those of the list, or by default those of 10, 20 and 40 that fit (10 where
/// none does).
std::vector<uint64_t> calibrated_lengths(const std::string& windows,
                                         const SequenceDatabase& database,
                                         const DescriptorSet& query);

/// For help: "windows ..., default ...".
std::string window_length_help();
std::string calibrated_lengths_help();
std::string distance_threshold_help();
std::string margin_help();
std::string fabmap_window_help();
std::string place_threshold_help();

}  // namespace vpr
