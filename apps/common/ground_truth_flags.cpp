#include "ground_truth_flags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "ground_truth/formats.h"
#include "ground_truth/presets.h"

namespace vpr {
namespace {

void add_number(const Command& command, const std::string& flag, std::optional<double>& value,
                const std::string& help) {
  command.add_option(flag, value, help).type_name("NUMBER").group(kGroundTruthGroup);
}

// A flag wins over a data set.
GroundTruthArgument with_flags(GroundTruthArgument argument, const GroundTruthFlags& flags) {
  if (flags.tolerance_frames) argument.tolerance_frames = *flags.tolerance_frames;
  if (!flags.format.empty()) argument.format = flags.format;
  GroundTruthOptions& options = argument.options;
  if (!flags.reference.empty()) options.reference = flags.reference;
  if (!flags.soft.empty()) options.soft = flags.soft;
  if (flags.options.radius_m) options.radius_m = flags.options.radius_m;
  if (flags.options.angle_deg) options.angle_deg = flags.options.angle_deg;
  if (flags.options.reference_step) options.reference_step = flags.options.reference_step;
  if (flags.options.matrix_rows != MatrixRows::automatic)
    options.matrix_rows = flags.options.matrix_rows;
  return argument;
}

}  // namespace

std::string ground_truth_help() {
  std::vector<std::string_view> presets;
  for (const GroundTruthPreset& preset : ground_truth_presets()) presets.push_back(preset.name);
  return fmt::format("file or folder, or a word: aligned, {}; formats below",
                     fmt::join(presets, ", "));
}

void add_ground_truth_flags(const Command& command, GroundTruthFlags& flags,
                            const std::string& format_flag) {
  const auto add = [&](const std::string& flag, std::string& value, const std::string& help) {
    return command.add_option(flag, value, help).group(kGroundTruthGroup);
  };
  add_setting(command, "--tolerance", flags.tolerance_frames,
              "pairs this many frames off are the same place, too (default: the data set's, or 0)")
      .group(kGroundTruthGroup);
  add(format_flag, flags.format, "default: found by content").choices("FORMAT", format_names());
  command.add_footer("Ground truth formats:\n" + format_summaries());
  add("--ground-truth-reference", flags.reference,
      "poses, tum, kitti, utm: those of the training sequence");
  add_number(command, "--radius", flags.options.radius_m,
             "poses, tum, kitti, utm: the same place within so many metres (utm: default 25)");
  add_number(command, "--angle", flags.options.angle_deg,
             "and with headings that differ by at most so many degrees (default: any)");
  add_number(command, "--reference-step", flags.options.reference_step,
             "aligned: query frame i is training frame STEP i (default 1)");
  add("--soft", flags.soft, "matrix: .npy file of pairs to ignore");
  add_setting(command, "--matrix-rows", flags.options.matrix_rows,
              "matrix, mask: rows are query or reference frames (default: as the format's authors)")
      .group(kGroundTruthGroup);
}

bool any_given(const GroundTruthFlags& flags) {
  return flags.tolerance_frames || !flags.format.empty() || !flags.reference.empty() ||
         !flags.soft.empty() || value_to_json(flags.options) != value_to_json(GroundTruthOptions{});
}

std::optional<GroundTruthArgument> ground_truth_of(const DatasetQuery& query, DatabaseFamily family,
                                                   const GroundTruthFlags& flags) {
  const auto& named =
      family == DatabaseFamily::fabmap ? query.place_ground_truth : query.sequence_ground_truth;
  if (!named) return std::nullopt;
  return with_flags(*named, flags);
}

GroundTruthArgument ground_truth_argument(const std::string& text, const GroundTruthFlags& flags) {
  return with_flags(parse_ground_truth_argument(text, 0), flags);
}

}  // namespace vpr
