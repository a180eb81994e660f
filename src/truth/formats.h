// The formats of ground truth: what they are called, how they are recognised, read and written.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/mapped_file.h"
#include "base/output.h"
#include "truth/ground_truth.h"

namespace vpr {

class GroundTruthBuilder;

/// What a format may be recognised by.
struct FileStart {
  std::filesystem::path path;
  bool is_folder = false;
  std::string_view bytes;       ///< the file's first 64 KiB
  std::string_view first_line;  ///< that is neither empty nor a comment (#), without its end
};

/// An open file (of a folder only its name), and its start.
struct StartedFile {
  MappedFile file;
  FileStart start;
};

/// `path` may end in a range. Throws Error(input) if the file can't be read.
StartedFile open_start(const std::filesystem::path& path);

/// A row of the table of formats.
struct GroundTruthFormat {
  std::string_view name;
  std::string_view summary;  ///< for help texts
  /// Which of "path", "range" (of frames, behind the path), "reference", "soft", "radius_m",
  /// "angle_deg", "reference_step", "matrix_rows" it uses; "times": all that say when frames and
  /// poses are of; "images": those that a list's names are of.
  std::vector<std::string_view> options;
  bool (*recognise)(const FileStart& start);         ///< null: by its name only
  std::string (*read)(GroundTruthBuilder& builder);  ///< returns the protocol in words
  /// Null: can't be written. Throws Error(usage) for several training sequences, if it can't name
  /// them, and Error(output).
  void (*write)(const InspectedGroundTruth& truth, Output& file, const Monitor& monitor) = nullptr;
  std::string_view ignores_in = {};  ///< extension of files that hold ignored pairs; empty: all
};

/// All formats, in the order in which content is recognised and help lists them.
std::span<const GroundTruthFormat> ground_truth_formats();

/// "pairs, aligned, ...": the names of those for which `wanted` is true.
std::string format_names(bool (*wanted)(const GroundTruthFormat& format));
/// Names and summaries, a line each, for help texts.
std::string format_summaries();
/// The names of all formats.
std::vector<std::string> format_names();

/// The format of a name. Throws Error(usage), naming the nearest, if there is none.
const GroundTruthFormat& find_format(std::string_view name);

/// The format of a file by its content. Throws Error(input) if the file can't be read, Error(usage)
/// if it is of no format that can be told; a .csv file that is none is taken for pairs, whose
/// reader says what is wrong.
const GroundTruthFormat& recognise_format(const std::filesystem::path& path);

/// Checks what an argument gives. Throws Error(usage) if the format lacks its path, or an option is
/// given that it does not use.
void require_options(const GroundTruthFormat& format, const GroundTruthArgument& argument);

}  // namespace vpr
