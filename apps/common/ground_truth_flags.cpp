#include "ground_truth_flags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/named_table.h"
#include "truth/formats.h"
#include "truth/presets.h"

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
  const GroundTruthOptions& given = flags.options;
  const auto take = [](auto& field, const auto& flag) {
    if (flag) field = flag;
  };
  take(options.radius_m, given.radius_m);
  take(options.angle_deg, given.angle_deg);
  take(options.reference_step, given.reference_step);
  take(options.max_difference_s, given.max_difference_s);
  take(options.offset_s, given.offset_s);
  take(options.reference_offset_s, given.reference_offset_s);
  if (given.matrix_rows != MatrixRows::automatic) options.matrix_rows = given.matrix_rows;
  GroundTruthOptions paths = given;
  visit_paths(options, [&](std::string_view name, std::filesystem::path& file) {
    visit_paths(paths, [&](std::string_view other, const std::filesystem::path& path) {
      if (name == other && !path.empty()) file = path;
    });
  });
  return argument;
}

}  // namespace

std::string ground_truth_help() {
  return fmt::format("file or folder, or a word: aligned, {}; formats below",
                     fmt::join(names_of(ground_truth_presets()), ", "));
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
  const auto add_path = [&](const std::string& flag, std::filesystem::path& path,
                            const std::string& help) {
    command
        .add_option(
            flag, [&path](const std::string& text) { path = text; }, help)
        .type_name("FILE")
        .group(kGroundTruthGroup);
  };
  GroundTruthOptions& options = flags.options;
  add_path("--ground-truth-reference", options.reference,
           "poses, tum, kitti, euroc, gps, utm: those of the training sequence; anchors: for a "
           "tolerance "
           "in meters");
  add_number(
      command, "--radius", flags.options.radius_m,
      "poses, tum, kitti, euroc, gps, utm, anchors: the same place within so many meters (utm: "
      "default 25)");
  add_number(command, "--angle", flags.options.angle_deg,
             "and with headings that differ by at most so many degrees (default: any)");
  add_number(command, "--reference-step", flags.options.reference_step,
             "aligned: query frame i is training frame STEP i (default 1)");
  add_path("--soft", options.soft, "matrix: .npy file of pairs to ignore");
  add_path(
      "--query-times", options.query_times,
      "tum, kitti, euroc, gps: when query frames were taken (a list, a folder of images named by "
      "their times, or a video); poses are found by time");
  add_path("--reference-times", options.reference_times, "the same of training frames");
  add_path("--query-pose-times", options.query_pose_times,
           "kitti: when the query's poses are of (times.txt)");
  add_path("--reference-pose-times", options.reference_pose_times,
           "the same of --ground-truth-reference");
  add_path("--query-images", options.query_images,
           "gps: the query's images, of which a CSV image,lat,lon has the names");
  add_path("--reference-images", options.reference_images, "the same of training images");
  add_number(command, "--max-difference", options.max_difference_s,
             "seconds from a frame to its nearest pose at most (default 0.02, of gps 1)");
  add_number(command, "--offset", options.offset_s,
             "seconds that are added to --query-times, where clocks differ");
  add_number(command, "--reference-offset", options.reference_offset_s,
             "seconds that are added to --reference-times");
  add_setting(command, "--matrix-rows", flags.options.matrix_rows,
              "matrix: rows are query or reference frames (default: as the format's authors)")
      .group(kGroundTruthGroup);
}

bool any_given(const GroundTruthFlags& flags) {
  return flags.tolerance_frames || !flags.format.empty() || flags.options != GroundTruthOptions{};
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
