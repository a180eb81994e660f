// The tables of ground truth formats (names, detection, readers and writers) and of the presets
// of published results.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/output.h"
#include "truth/ground_truth.h"

namespace vpr {

class GroundTruthBuilder;
struct Layout;

/// A file (for a folder only its name) and its beginning, by which its format is detected.
struct FileStart {
  std::filesystem::path path;
  bool is_folder = false;
  std::string bytes;    ///< the first 64 KiB
  bool is_cut = false;  ///< the file has more
  /// the first line that is neither empty nor a comment (#), without its end
  std::string first_line;
  std::vector<std::string> header;  ///< of a table
  const Layout* layout = nullptr;   ///< of a trajectory (detect_layout); null: it is none
};

/// `path` may end in a range. Throws Error(input) if the file cannot be read.
FileStart open_start(const std::filesystem::path& path);

/// An entry of the table of formats.
struct GroundTruthFormat {
  std::string_view name;
  std::string_view summary;  ///< for help texts
  /// The options that it uses: "path", "range" (of frames, after the path), "reference", "soft",
  /// "radius_m", "angle_deg", "ignore_radius_m", "train_step", "matrix_rows"; "times": all options
  /// with times of frames and poses; "images": the images named in a list.
  std::vector<std::string_view> options;
  /// null: selected only by its name
  std::function<bool(const FileStart& start)> recognize;
  std::string (*read)(GroundTruthBuilder& builder);  ///< returns the protocol as text
  /// Null: cannot be written. Throws Error(usage) if the format cannot name several training
  /// sequences, and Error(output).
  void (*write)(const InspectedGroundTruth& truth, Output& file, const Monitor& monitor) = nullptr;
  /// extension of the files that can hold ignored pairs; empty: all
  std::string_view ignores_in = {};
};

/// All formats, in the order of detection and help.
std::span<const GroundTruthFormat> ground_truth_formats();

/// "pairs, aligned, ...": the names of the formats for which `wanted` is true.
std::string format_names(const std::function<bool(const GroundTruthFormat&)>& wanted);
/// Names and summaries for help texts, one format per line.
std::string format_summaries();
std::vector<std::string> format_names();

/// The format with this name. Throws Error(usage) with the nearest name if there is none.
const GroundTruthFormat& find_format(std::string_view name);

/// Detects the format of a file by its content. Throws Error(input) if the file cannot be read,
/// Error(usage) if no format matches, Error(data) for a .csv file whose header matches none.
const GroundTruthFormat& detect_format(const std::filesystem::path& path);

/// Checks the options of an argument. Throws Error(usage) if the path is missing although the
/// format needs it, or if an option is set that the format does not use.
void require_options(const GroundTruthFormat& format, const GroundTruthArgument& argument);

/// Both sequences show the same places at the same time; presets differ in the tolerance of a
/// match. --ground-truth accepts the name.
struct GroundTruthPreset {
  std::string_view name;
  int tolerance_frames;
  /// The data set's query has every `train_step`-th frame. Applies only to sequences with query
  /// frames = training frames / step, rounded up; others are compared one to one.
  uint32_t train_step;
  std::string_view source;  ///< the publications that use it
};

/// All presets, in the order of the help text.
std::span<const GroundTruthPreset> ground_truth_presets();

/// The preset with this name, or null.
const GroundTruthPreset* find_preset(std::string_view name);

/// The ground truth of a preset, with the other options of `argument`. Throws Error(usage) if the
/// tolerance of `argument` contradicts the preset.
GroundTruthArgument preset_argument(const GroundTruthPreset& preset, GroundTruthArgument argument,
                                    const GroundTruthScope& scope);

}  // namespace vpr
