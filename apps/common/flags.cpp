#include "flags.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/text.h"
#include "recordings/sequence.h"
#include "recordings/sequence_source.h"
#include "truth/formats.h"
#include "truth/frame_times.h"

namespace vpr {
namespace {

// Flags override the options of a data set.
GroundTruthArgument with_flags(GroundTruthArgument argument, const GroundTruthFlags& flags) {
  if (flags.tolerance_frames) argument.tolerance_frames = *flags.tolerance_frames;
  if (!flags.format.empty()) argument.format = flags.format;
  GroundTruthOptions& options = argument.options;
  GroundTruthOptions given = flags.options;
  visit_fields(options, [&](std::string_view name, auto& field, const auto&...) {
    visit_fields(given, [&](std::string_view other, auto& flag, const auto&...) {
      if constexpr (std::is_same_v<decltype(field), decltype(flag)>)
        if (name == other && flag != std::decay_t<decltype(flag)>{}) field = flag;
    });
  });
  return argument;
}

// Bytes from "512M", "2G", "1000000"; K, M, G are powers of 1024.
size_t parse_bytes(const std::string& text) {
  const size_t digits = std::min(text.find_last_not_of("KMG") + 1, text.size());
  const auto value = parse_number<uint64_t>(std::string_view(text).substr(0, digits));
  const std::string_view unit = std::string_view(text).substr(digits);
  const size_t shift = unit.empty() ? 0 : 10 * (std::string_view("KMG").find(unit) + 1);
  if (!value || unit.size() > 1 || *value >> (52 - shift) != 0)
    throw Error(ErrorKind::usage, "--max-memory takes bytes, as in 512M or 2G, found {}", text);
  return *value << shift;
}

}  // namespace

void add_rate_flags(const Command& command, SelectionSettings& flags, const std::string& sequences,
                    const std::string& group) {
  command.add_option("--fps", flags.fps,
                     fmt::format("select frames of {} at this rate, in frames per second; a ground "
                                 "truth still refers to all frames",
                                 sequences),
                     group);
  command.add_option("--recorded-fps", flags.recorded_fps,
                     "frame rate of the recording, unless times, a video or a data set state it",
                     group);
}

Flag add_speed_flag(const Command& command, std::string& speed, const std::string& help) {
  std::vector<std::string> names = names_of(speed_rules());
  names.emplace_back("NUMBER");
  command.add_footer("Speeds:\n" + speed_summaries());
  return command.add_option("--speed", speed, help).choices("SPEED", names);
}

SequenceArgument selected(SequenceArgument argument, const SelectionSettings& flags,
                          const std::filesystem::path& times, const Dataset* dataset,
                          const Session& session) {
  SelectionSettings settings = flags;
  if (dataset != nullptr && dataset->frames_per_second > 0)
    settings.fallback_fps = dataset->frames_per_second;
  return selected(std::move(argument), settings, times, session.options.process.seed,
                  session.monitor);
}

void require_descriptors(const SequenceArgument& argument) {
  if (open_sequence(argument).kind != SequenceKind::descriptors)
    throw Error(ErrorKind::usage, "{}: is not a .npy file or a folder of .npy files",
                argument.path.string());
}

std::string ground_truth_help() {
  return fmt::format("file or folder, aligned, or a preset ({}); see the formats below",
                     fmt::join(names_of(ground_truth_presets()), ", "));
}

namespace {

void add_number(const Command& command, const std::string& flag, std::optional<double>& value,
                const std::string& help) {
  command.add_option(flag, value, help, kGroundTruthGroup);
}

void add_path(const Command& command, const std::string& flag, std::filesystem::path& path,
              const std::string& help) {
  command.add_option(
      flag, [&path](const std::string& text) { path = text; }, help, kGroundTruthGroup, "FILE");
}

// The flags that assign poses to frames, by times or names.
void add_frame_flags(const Command& command, GroundTruthOptions& options) {
  add_path(
      command, "--query-times", options.query.times,
      "times of the query frames, for trajectories and gps: a list, a folder of images with times "
      "as names, or a video; poses are matched by time");
  add_path(command, "--train-times", options.train.times,
           "times of the training frames, as for --query-times");
  add_path(command, "--query-pose-times", options.query.pose_times,
           "times of the query's poses, for kitti (times.txt)");
  add_path(command, "--train-pose-times", options.train.pose_times,
           "times of the poses of --ground-truth-train, for kitti");
  add_path(command, "--query-images", options.query.images,
           "images of the query, for gps and trajectories that name their frames");
  add_path(command, "--train-images", options.train.images,
           "images of the training sequence, as for --query-images");
  add_number(command, "--max-difference", options.max_difference_s,
             "longest time from a frame to its nearest pose in seconds (default: 0.02; gps: 1)");
  add_number(command, "--offset", options.query.offset_s,
             "seconds added to --query-times, for clocks that differ (default: 0)");
  add_number(command, "--train-offset", options.train.offset_s,
             "seconds added to --train-times (default: 0)");
}

}  // namespace

void add_ground_truth_flags(const Command& command, GroundTruthFlags& flags,
                            const std::string& format_flag) {
  GroundTruthOptions& options = flags.options;
  command.add_option(
      "--tolerance",
      [&flags](const std::string& text) {
        flags.tolerance_frames = parse_number<int>(text);
        if (!flags.tolerance_frames)
          throw Error(ErrorKind::usage, "--tolerance counts frames, as in --tolerance 3, found {}",
                      text);
      },
      "frames by which the same place may be off (default: the data set's, or 0)", kEssentialGroup,
      "NUMBER");
  command
      .add_option(format_flag, flags.format, "format of the ground truth (default: detected)",
                  kGroundTruthGroup)
      .choices("FORMAT", format_names());
  command.add_footer("Ground truth formats:\n" + format_summaries());
  add_path(
      command, "--ground-truth-train", options.reference,
      "poses of the training sequence, for poses, trajectories, gps and utm, and for anchors with "
      "--radius");
  add_number(command, "--radius", options.radius_m,
             "largest distance of the same place in meters, for poses, trajectories, gps, utm and "
             "anchors (default for utm: 25)");
  add_number(command, "--ignore-radius", options.ignore_radius_m,
             "pairs farther apart than --radius, up to this distance in meters and within --angle, "
             "are ignored");
  add_number(command, "--angle", options.angle_deg,
             "largest difference of headings of the same place in degrees, with --radius "
             "(default: any)");
  add_number(command, "--train-step", options.train_step,
             "training frames per query frame, for aligned: query frame i shows training frame "
             "STEP * i (default: 1)");
  add_path(command, "--soft", options.soft, "pairs to ignore, for matrix (.npy)");
  add_frame_flags(command, options);
  add_setting(command, "--matrix-rows", options.matrix_rows,
              "frames that are rows of a matrix (default: auto, as usual for the format)",
              kGroundTruthGroup);
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

bool uses_option(const GroundTruthArgument& truth, std::string_view option) {
  const auto formats = ground_truth_formats();
  const auto named = std::ranges::find(formats, truth.format, &GroundTruthFormat::name);
  const GroundTruthFormat* format = truth.format.empty()     ? &detect_format(truth.path)
                                    : named != formats.end() ? &*named
                                                             : nullptr;
  return format != nullptr && std::ranges::find(format->options, option) != format->options.end();
}

void remove_selection_times(GroundTruthArgument& truth, const SelectionSettings& flags) {
  if (flags.fps && !truth.options.query.times.empty() && !uses_option(truth, "times"))
    truth.options.query.times.clear();
}

void refuse(bool is_given, const std::string& flag, const std::string& why) {
  if (is_given) throw Error(ErrorKind::usage, "{} {}", flag, why);
}

Flag add_unreadable_flag(const Command& command, bool& skip_unreadable) {
  return command.add_flag(
      "--skip-unreadable", skip_unreadable,
      "ignore frames that cannot be decoded; they keep their index and never match");
}

void add_memory_flag(const Command& command, size_t& bytes) {
  command.add_option(
      "--max-memory", [&bytes](const std::string& text) { bytes = parse_bytes(text); },
      fmt::format("memory for rings and recognitions in bytes, as in 512M (default: {}G)",
                  bytes >> 30),
      kWindowGroup, "BYTES");
}

Flag add_format_flag(const Command& command, TableFormat& format, const std::string& help) {
  return add_setting(command, "--format", format, help);
}

}  // namespace vpr
