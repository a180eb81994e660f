#include "truth/formats.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/converters.h"
#include "base/error.h"
#include "base/named_table.h"
#include "base/text.h"
#include "truth/gps.h"
#include "truth/matrix_file.h"
#include "truth/pairs.h"
#include "truth/poses.h"
#include "truth/trajectory.h"
#include "truth/utm_names.h"

namespace vpr {
namespace {

constexpr size_t kStartBytes = 65536;

bool has_path(const GroundTruthFormat& format) {
  return std::find(format.options.begin(), format.options.end(), "path") != format.options.end();
}

// The names of all formats that use an option.
std::string format_names_of(std::string_view option) {
  std::vector<std::string_view> names;
  for (const GroundTruthFormat& format : ground_truth_formats())
    if (std::find(format.options.begin(), format.options.end(), option) != format.options.end())
      names.push_back(format.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

// The formats that use an option, for errors about options without effect.
std::string use_of(std::string_view option) {
  if (option == "range") return "; convert it to pairs, which accept one (vpr-eval convert)";
  return fmt::format("; {} belongs to {}", option, format_names_of(option));
}

}  // namespace

StartedFile open_start(const std::filesystem::path& path) {
  StartedFile opened;
  FileStart& start = opened.start;
  start.path = parse_sequence_argument(path.string()).path;
  std::error_code error;
  start.is_folder = std::filesystem::is_directory(start.path, error);
  if (start.is_folder) return opened;
  opened.file = MappedFile(start.path);
  start.bytes = opened.file.text().substr(0, kStartBytes);
  for (const std::string_view line : split_lines(without_byte_order_mark(start.bytes)))
    if (start.first_line.empty() && !line.starts_with('#')) start.first_line = line;
  return opened;
}

std::span<const GroundTruthFormat> ground_truth_formats() {
  static const std::vector<std::string_view> kPoseOptions = {"path", "range", "reference",
                                                             "radius_m", "angle_deg"};
  static const std::vector<std::string_view> kTimedOptions = {"path",     "range",     "reference",
                                                              "radius_m", "angle_deg", "times"};
  static const std::vector<GroundTruthFormat> kFormats = {
      {"aligned", "query frame i is training frame i", {"reference_step"}, nullptr, read_aligned},
      {"anchors",
       "CSV query,reference of a few frames, with linear interpolation",
       {"path", "range", "reference", "radius_m", "times"},
       is_anchors_csv,
       read_anchors},
      {"pairs",
       "CSV query,reference[,label] or query,sequence,reference[,label]",
       {"path", "range"},
       is_pairs_csv,
       read_pairs_csv,
       write_pairs_csv},
      {"poses", "CSV frame,x,y[,heading] of either side", kPoseOptions, is_pose_csv, read_poses},
      {"tum", "trajectories: time x y z qx qy qz qw", kTimedOptions, is_tum, read_tum_poses},
      {"kitti", "trajectories: 3 x 4 matrices", kTimedOptions, is_kitti, read_kitti_poses},
      {"euroc", "trajectories: CSV time in ns, x, y, z, qw, qx, qy, qz, ...", kTimedOptions,
       is_euroc, read_euroc_poses},
      {"gps",
       "latitude and longitude: CSV lat,lon",
       {"path", "range", "reference", "radius_m", "angle_deg", "times", "images"},
       is_gps,
       read_gps},
      {"utm", "images named @east@north@...", kPoseOptions, is_utm_names, read_utm_names},
      {"matrix",
       "0/1 matrix, .npy or .npz, optionally with a soft matrix to ignore",
       {"path", "soft", "matrix_rows"},
       is_matrix_file,
       read_matrix_file,
       write_matrix_file,
       ".npz"}};
  return kFormats;
}

std::string format_names(bool (*wanted)(const GroundTruthFormat& format)) {
  std::vector<std::string_view> names;
  for (const GroundTruthFormat& format : ground_truth_formats())
    if (wanted(format)) names.push_back(format.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string format_summaries() {
  std::string text;
  for (const GroundTruthFormat& format : ground_truth_formats())
    text += fmt::format("  {:<14}{}\n", format.name, format.summary);
  return text;
}

std::vector<std::string> format_names() { return names_of(ground_truth_formats()); }

const GroundTruthFormat& find_format(std::string_view name) {
  refuse_unconverted_format(name);
  return find_named(ground_truth_formats(), "ground truth format", name);
}

const GroundTruthFormat& detect_format(const std::filesystem::path& path) {
  const StartedFile opened = open_start(path);
  const FileStart& start = opened.start;
  for (const GroundTruthFormat& format : ground_truth_formats())
    if (format.recognize != nullptr && format.recognize(start)) return format;
  refuse_unconverted(start.path, start.bytes);
  if (start.path.extension() == ".csv") return find_format("pairs");
  throw Error(ErrorKind::usage,
              fmt::format("{}: the format of this ground truth cannot be detected; "
                          "pass --ground-truth-format, one of {}",
                          path.string(), format_names(has_path)));
}

void require_options(const GroundTruthFormat& format, const GroundTruthArgument& argument) {
  const GroundTruthOptions& options = argument.options;
  const auto check = [&](std::string_view option, bool is_given) {
    const bool uses =
        std::find(format.options.begin(), format.options.end(), option) != format.options.end();
    if (is_given && !uses)
      throw Error(ErrorKind::usage, fmt::format("{} has no effect on a ground truth of format {}{}",
                                                option, format.name, use_of(option)));
    if (option == "path" && uses && !is_given)
      throw Error(ErrorKind::usage,
                  fmt::format("the ground truth format {} needs a path", format.name));
  };
  check("path", !argument.path.empty());
  check("range", !parse_sequence_argument(argument.path.string()).range.is_all());
  check("reference", !options.reference.empty());
  check("soft", !options.soft.empty());
  check("radius_m", options.radius_m.has_value());
  check("angle_deg", options.angle_deg.has_value());
  check("reference_step", options.reference_step.has_value());
  GroundTruthOptions timed = options;
  bool has_times = timed.max_difference_s || timed.offset_s || timed.reference_offset_s;
  visit_paths(timed, [&](const char* name, const std::filesystem::path& file) {
    has_times = has_times || (std::string_view(name).ends_with("times") && !file.empty());
  });
  check("times", has_times);
  check("images", !options.query_images.empty() || !options.reference_images.empty());
  check("matrix_rows", options.matrix_rows != MatrixRows::automatic);
}

}  // namespace vpr
