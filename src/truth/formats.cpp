#include "truth/formats.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/column_names.h"
#include "base/converters.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/named_table.h"
#include "base/rows.h"
#include "base/text.h"
#include "truth/layouts.h"
#include "truth/positions.h"
#include "truth/readers.h"

namespace vpr {
namespace {

bool uses(const GroundTruthFormat& format, std::string_view option) {
  return std::ranges::find(format.options, option) != format.options.end();
}

// docs/guide/ground-truth.md has the sources with links.
constexpr std::array<GroundTruthPreset, 4> kPresets = {{
    {"nordland-exact", 0, 1, "the frame itself"},
    {"nordland-vpr-bench", 1, 10,
     "VPR-Bench, GSV-Cities, BoQ: one frame, every tenth frame is a query"},
    {"nordland-patch-netvlad", 2, 1, "Patch-NetVLAD, SelaVPR: two frames"},
    {"nordland-25m", 10, 1, "VPR-datasets-downloader: 25 m, which is ten frames"},
}};

uint32_t step_for(const GroundTruthPreset& preset, const GroundTruthScope& scope) {
  for (const auto& sequence : scope.sequences)
    if (sequence.searched && scope.query.frames > 1 &&
        (sequence.sequence.frames + preset.train_step - 1) / preset.train_step ==
            scope.query.frames)
      return preset.train_step;
  return 1;
}

// Two or three integers, as in a list of pairs without a header.
bool has_only_numbers(std::string_view line) {
  const std::vector<std::string> cells = first_row(std::string(line));
  return (cells.size() == 2 || cells.size() == 3) &&
         std::ranges::all_of(cells,
                             [](const std::string& cell) { return parse_frame(cell).has_value(); });
}

std::vector<GroundTruthFormat> make_formats() {
  using Options = std::vector<std::string_view>;
  static const Options kPoseOptions = {"path",     "range",     "reference",
                                       "radius_m", "angle_deg", "ignore_radius_m"};
  static const Options kNamedOptions = {"path",      "range",           "reference", "radius_m",
                                        "angle_deg", "ignore_radius_m", "times",     "images"};
  std::vector<GroundTruthFormat> formats = {
      {"aligned", "query frame i is training frame i", {"train_step"}, nullptr, read_aligned},
      {"anchors",
       "CSV query,anchor of a few frames, with linear interpolation",
       {"path", "range", "reference", "radius_m", "ignore_radius_m", "times"},
       [](const FileStart& start) {
         return has_columns(start.header, {"query", "anchor"});
       },
       read_anchors},
      {"labels",
       "CSV query,reference,label,tolerance of vpr-eval --ask-frames",
       {"path", "range"},
       [](const FileStart& start) {
         return has_columns(start.header, {"query", "reference", "label", "tolerance"});
       },
       read_labels},
      {"places",
       "CSV sequence,train,query,tolerance of vpr-eval --ask-fabmap",
       {"path"},
       [](const FileStart& start) {
         return has_columns(start.header, {"sequence", "train", "query", "tolerance"});
       },
       read_places},
      {"pairs",
       "CSV query,reference[,label] or query,sequence,reference[,label]",
       {"path", "range"},
       [](const FileStart& start) {
         return has_columns(start.header, {"query", "reference"});
       },
       read_pairs,
       write_pairs_csv},
      {"poses", "CSV frame,x,y[,heading] of either side", kPoseOptions,
       [](const FileStart& start) { return is_pose_table(start.header); }, read_poses},
      {"gps", "latitude and longitude: CSV lat,lon", kNamedOptions,
       [](const FileStart& start) {
         return is_gps_header(start.header) || (start.layout && start.layout->has("lat"));
       },
       read_gps},
      {"utm", "images named @east@north@...", kPoseOptions, is_utm_names, read_utm_names},
      {"matrix",
       "0/1 matrix, .npy or .npz, optionally with a soft matrix to ignore",
       {"path", "soft", "matrix_rows"},
       is_matrix_file,
       read_matrix_file,
       write_matrix_file,
       ".npz"}};
  for (const Layout& layout : layouts()) {
    if (layout.has("lat")) continue;  // read by gps
    const auto recognize = [&layout](const FileStart& start) { return start.layout == &layout; };
    formats.insert(std::ranges::find(formats, "gps", &GroundTruthFormat::name),
                   {layout.name, layout.summary, kNamedOptions, recognize, read_trajectories});
  }
  return formats;
}

}  // namespace

FileStart open_start(const std::filesystem::path& path) {
  FileStart start;
  start.path = parse_sequence_argument(path.string()).path;
  std::error_code error;
  start.is_folder = std::filesystem::is_directory(start.path, error);
  if (start.is_folder) return start;
  start.bytes = read_file_start(start.path, kFileStart);
  start.is_cut = start.bytes.size() == kFileStart;
  start.first_line = first_line_of(start.bytes);
  start.header = first_row(start.bytes);
  start.layout = detect_layout(start);
  return start;
}

std::span<const GroundTruthFormat> ground_truth_formats() {
  static const std::vector<GroundTruthFormat> kFormats = make_formats();
  return kFormats;
}

std::string format_names(const std::function<bool(const GroundTruthFormat&)>& wanted) {
  std::vector<std::string_view> names;
  for (const GroundTruthFormat& format : ground_truth_formats())
    if (wanted(format)) names.push_back(format.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string format_summaries() {
  std::string text;
  for (const GroundTruthFormat& format : ground_truth_formats())
    text += fmt::format("  {:<14}{}{}\n", format.name,
                        find_layout(format.name) ? "trajectory: " : "", format.summary);
  return text;
}

std::vector<std::string> format_names() { return names_of(ground_truth_formats()); }

const GroundTruthFormat& find_format(std::string_view name) {
  refuse_convertible_format(name);
  return find_named(ground_truth_formats(), "ground truth format", name);
}

const GroundTruthFormat& detect_format(const std::filesystem::path& path) {
  const FileStart start = open_start(path);
  for (const GroundTruthFormat& format : ground_truth_formats())
    if (format.recognize != nullptr && format.recognize(start)) return format;
  if (has_only_numbers(start.first_line))
    throw Error(ErrorKind::usage,
                "{}: has no header. If its numbers are frames that count from 0, add the line "
                "query,reference. The CSV of OpenSeqSLAM2, which counts from 1, is converted by "
                "scripts/convert/openseqslam2.py",
                path.string());
  if (has_columns(start.header, {"x", "y"}))
    throw Error(ErrorKind::data,
                "{}: has positions, but its header has no column frame. Add one with the number of "
                "each frame, from 0",
                path.string());
  if (start.bytes.starts_with('{') || start.bytes.starts_with('['))
    throw Error(
        ErrorKind::usage,
        "{}: is JSON, as results and reports are, not a ground truth. Write poses as a CSV "
        "time,x,y,z,qx,qy,qz,qw or image,x,y,z. To check a ground truth with the frames of a "
        "result, use vpr-eval check GROUND-TRUTH --result RESULT",
        path.string());
  refuse_convertible(start.path, start.bytes);
  if (const std::string hint = columns_hint(start); !hint.empty())
    throw Error(ErrorKind::usage, "{}{}", path.string(), hint);
  if (start.path.extension() == ".csv" || start.header.size() > 1)
    throw Error(
        ErrorKind::data,
        "{}: its header \"{}\" has no columns query,reference (pairs), query,anchor, frame,x,y "
        "(poses) or lat,lon (gps), between commas, semicolons or tabs, and its columns are not "
        "those of a trajectory, such as time,x,y,z. Rename them",
        path.string(), shortened(fmt::format("{}", fmt::join(start.header, ","))));
  if (first_row(start.first_line + "\n", kListSeparators).size() > 1)
    throw Error(ErrorKind::usage,
                "{}: cannot detect the format of its first line, \"{}\". Put commas between its "
                "columns, and their names into a first line: query,reference for pairs of frames "
                "or images, frame,x,y for positions, lat,lon for GPS",
                path.string(), shortened(start.first_line));
  throw Error(
      ErrorKind::usage,
      "{}: cannot detect the format of this ground truth. Pass --ground-truth-format, one of {}",
      path.string(), format_names([](const auto& format) { return uses(format, "path"); }));
}

void require_options(const GroundTruthFormat& format, const GroundTruthArgument& argument) {
  const GroundTruthOptions& options = argument.options;
  if (uses(format, "path") && argument.path.empty())
    throw Error(ErrorKind::usage, "the ground truth format {} needs a path", format.name);
  const auto refuse_unused = [&](std::string_view option, bool is_set, std::string_view flag = {}) {
    if (!is_set || uses(format, option)) return;
    throw Error(ErrorKind::usage, "{} has no effect on a ground truth of format {}. {}",
                flag.empty() ? option : flag, format.name,
                option == "range" ? "Convert it to pairs, which accept a range (vpr-eval convert)"
                                  : "It belongs to " + format_names([&](const auto& other) {
                                      return uses(other, option);
                                    }));
  };
  refuse_unused("path", !argument.path.empty());
  refuse_unused("range", !parse_sequence_argument(argument.path.string()).range.is_all());
  refuse_unused("reference", !options.reference.empty(), "--ground-truth-train");
  refuse_unused("soft", !options.soft.empty(), "--soft");
  refuse_unused("radius_m", options.radius_m.has_value(), "--radius");
  refuse_unused("angle_deg", options.angle_deg.has_value(), "--angle");
  refuse_unused("ignore_radius_m", options.ignore_radius_m.has_value(), "--ignore-radius");
  refuse_unused("train_step", options.train_step.has_value(), "--train-step");
  const auto has_times = [](TruthSide side) {
    side.images.clear();
    return side != TruthSide{};
  };
  refuse_unused("times",
                options.max_difference_s || has_times(options.query) || has_times(options.train),
                "an option of times (--offset, --max-difference, --query-times, ...)");
  refuse_unused("images", !options.query.images.empty() || !options.train.images.empty());
  refuse_unused("matrix_rows", options.matrix_rows != MatrixRows::automatic);
}

std::span<const GroundTruthPreset> ground_truth_presets() { return kPresets; }

const GroundTruthPreset* find_preset(std::string_view name) { return find_in(kPresets, name); }

GroundTruthArgument preset_argument(const GroundTruthPreset& preset, GroundTruthArgument argument,
                                    const GroundTruthScope& scope) {
  if (argument.tolerance_frames != 0 && argument.tolerance_frames != preset.tolerance_frames)
    throw Error(ErrorKind::usage, "{} has a tolerance of {} frames, not {}. Use aligned for others",
                preset.name, preset.tolerance_frames, argument.tolerance_frames);
  argument.format = "aligned";
  argument.tolerance_frames = preset.tolerance_frames;
  if (!argument.options.train_step) argument.options.train_step = step_for(preset, scope);
  return argument;
}

}  // namespace vpr
