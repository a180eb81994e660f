// Flags of several programs: selections of sequences, ground truth, score matrices and tables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "command.h"
#include "database/archive.h"
#include "present/table.h"
#include "query/train_sequences.h"
#include "truth/dataset.h"
#include "truth/frame_times.h"

namespace vpr {

/// --fps and --recorded-fps. `sequences`: a noun for the help.
void add_rate_flags(const Command& command, SelectionSettings& flags, const std::string& sequences,
                    const std::string& group = kEssentialGroup);

/// --speed, and a section of the help with its values.
Flag add_speed_flag(const Command& command, std::string& speed,
                    const std::string& help =
                        "simulated walking speed of the query, with --seed (below); the ground "
                        "truth still refers to the recorded query");

/// The sequence with its rate and the selection of the flags and --seed. `times`: a file with the
/// times of its frames; empty: none. `dataset`: its data set, or null.
SequenceArgument selected(SequenceArgument argument, const SelectionSettings& flags,
                          const std::filesystem::path& times, const Dataset* dataset,
                          const Session& session);

/// Throws Error(usage) unless the argument is a .npy file or a folder of .npy files.
void require_descriptors(const SequenceArgument& argument);

/// Heading of the ground truth flags in the help.
inline constexpr const char* kGroundTruthGroup = "Ground truth";

/// Flags that describe a ground truth, except its path.
struct GroundTruthFlags {
  std::optional<int> tolerance_frames;  ///< nullopt: the data set's, or 0
  std::string format;
  GroundTruthOptions options;
};

/// The help of --ground-truth.
std::string ground_truth_help();

/// Adds the flags in a group of the help, and a section with the formats. `format_flag`: the name
/// of --ground-truth-format.
void add_ground_truth_flags(const Command& command, GroundTruthFlags& flags,
                            const std::string& format_flag = "--ground-truth-format");

/// The ground truth of a query of a data set for training frames or places; flags override it.
/// Nullopt if the data set has none.
std::optional<GroundTruthArgument> ground_truth_of(const DatasetQuery& query, DatabaseFamily family,
                                                   const GroundTruthFlags& flags);

/// The ground truth `text` of --ground-truth, with the flags.
GroundTruthArgument ground_truth_argument(const std::string& text, const GroundTruthFlags& flags);

/// Whether the format of a ground truth has an option, such as "times". Throws as detect_format
/// does.
bool uses_option(const GroundTruthArgument& truth, std::string_view option);

/// With --fps, --query-times states the times of the selection. Removes it from a ground truth
/// whose format does not use times. Throws as detect_format does.
void remove_selection_times(GroundTruthArgument& truth, const SelectionSettings& flags);

/// Throws Error(usage) "FLAG WHY" for a given flag.
void refuse(bool is_given, const std::string& flag, const std::string& why);

Flag add_unreadable_flag(const Command& command, bool& skip_unreadable);

/// --max-memory in bytes, or as "512M" or "2G", powers of 1024. The help shows the value of `bytes`
/// as the default.
void add_memory_flag(const Command& command, size_t& bytes);

/// --format of tables.
Flag add_format_flag(const Command& command, TableFormat& format,
                     const std::string& help =
                         "format of the table: text, csv, markdown or latex "
                         "(default: text)");

}  // namespace vpr
