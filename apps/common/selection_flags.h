// Flags that choose frames of a sequence: --fps, --recorded-fps and --warp.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "session.h"
#include "truth/dataset.h"

namespace vpr {

struct SelectionFlags {
  std::string warp;                    ///< how queries are replayed; empty: as they are
  std::optional<double> fps;           ///< sequences are thinned to it; none: they are not
  std::optional<double> recorded_fps;  ///< of sequences that don't say it themselves
  std::optional<double> otherwise;     ///< the same where no data set says it either; no flag
};

/// Adds both flags. `sequences`: what is thinned, in words.
void add_rate_flags(const Command& command, SelectionFlags& flags, const std::string& sequences);

/// Throws Error(usage) for rates out of range.
void check_rates(const SelectionFlags& flags);

/// Query times that --fps asks for are not those of a ground truth whose format has none: leaves
/// them out of it. Throws what detect_format throws.
void leave_times_to_rate(GroundTruthArgument& truth, const SelectionFlags& flags);

/// The sequence with its rate, thinned (truth/sequence_rate.h) and replayed as the flags and --seed
/// say. `times`: a file that says when its frames were taken; empty: none. `dataset`: whose
/// sequence it is; null: of none.
SequenceArgument selected(SequenceArgument argument, const SelectionFlags& flags,
                          const std::filesystem::path& times, const Dataset* dataset,
                          const Session& session);

/// Adds the flag, and what it takes to the help's end. `about`: what is replayed, and what for.
Flag add_warp_flag(const Command& command, std::string& warp,
                   const std::string& about =
                       "replay the query so, with --seed (below); the "
                       "ground truth stays that of the query as it is");

}  // namespace vpr
