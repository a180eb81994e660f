// Opens a sequence from the command line: images, a list of them, a video, or arrays of
// descriptors.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/sequence.h"

namespace cv {
class Mat;
}

namespace vpr {

class NpyArray;

/// `PATH` or `PATH@FIRST:LAST[:STEP]`.
struct SequenceArgument {
  std::filesystem::path path;
  FrameRange range;
  std::string speed = {};  ///< applied once the frames are known (Selection); empty: none
  uint64_t seed = 1;       ///< of the speed
  Sequence sequence = {};  ///< without frames; a selection refers to the range's frames
  /// Descriptors in memory, one row per frame, instead of a file; `path` names them in messages.
  std::shared_ptr<const NpyArray> array = {};
};

/// A sequence to open, and its name in results.
struct NamedArgument {
  std::string name;
  SequenceArgument sequence = {};
  bool is_place = false;  ///< whether its frames are views of one place, for FAB-MAP
};

/// A path that exists as written takes precedence over a range. Throws Error(usage) for an empty or
/// reversed range, a step of 0, or a number that is too large.
SequenceArgument parse_sequence_argument(const std::string& text);

/// As parse_sequence_argument reads it; empty for an array in memory.
std::string argument_text(const SequenceArgument& argument);

/// Names for results: the name of the folder, list or video, with parents ("a/ref", "b/ref"),
/// extensions or ranges added if two names are equal, or if a name is taken. Bytes that are not
/// UTF-8 become %XX. Throws Error(usage) if the names are still equal: the same frames were passed
/// twice.
std::vector<std::string> sequence_names(const std::vector<SequenceArgument>& arguments,
                                        const std::vector<std::string>& taken = {});

/// The source of frames. Descriptors have no frames to decode.
enum class SequenceKind { images, video, descriptors };

/// Frames in order, not read yet. For images, `files` holds the range's files; the range of a video
/// is applied while it is read, because its length is unknown before. Descriptors are .npy files,
/// one per frame, or one file with one row per frame, whose range is also applied while it is read.
struct SequenceSource {
  SequenceArgument argument;
  SequenceKind kind = SequenceKind::images;
  std::vector<std::filesystem::path> files;
  /// An already decoded frame, in blue, green and red or in gray: then it is the only one.
  const cv::Mat* picture = nullptr;

  /// Whether its only file has one row per frame.
  bool is_one_array() const {
    return kind == SequenceKind::descriptors && files.size() == 1 && files.front() == argument.path;
  }
};

/// Folder: its images by extension, without hidden and other files, not recursive, in the order of
/// set_frame_order. Images of formats that cannot be read are an error, since they would shift
/// frame numbers. Text file (.txt, .lst, .csv): one image per line, in the file's order, relative
/// to the file; empty lines and lines that start with # are skipped. A .npy file, a folder of them
/// without images, or a list of them: descriptors. Anything else: a video. Throws Error(input) for
/// a missing path or an empty sequence, Error(usage) for a range that does not fit the frames.
SequenceSource open_sequence(const SequenceArgument& argument);

/// Whether a file in a folder is one of its frames by its name: it has the extension of an image
/// format, and is not hidden.
bool is_frame_name(const std::filesystem::path& path);

/// Whether a path is a device, which live queries open as a camera.
bool is_camera(const std::filesystem::path& path);

/// The frames of each subfolder of `folder` that is not hidden, in natural order. Throws
/// Error(input) if there is none.
std::vector<SequenceArgument> subfolder_arguments(const std::filesystem::path& folder);

/// Names of frames in order: the lines of a list (.txt, .lst, .csv; without empty lines and lines
/// that start with #; the files need not exist), or the paths of a sequence's frames. Nullopt for a
/// video or a single array. Throws as open_sequence does, and Error(usage) for a range that a list
/// does not have.
std::optional<std::vector<std::string>> known_frame_names(const SequenceArgument& argument);

/// The same. Throws also Error(usage) for frames without names.
std::vector<std::string> frame_names(const SequenceArgument& argument);

/// The file names of all frames, without folders; empty for a video or a single array.
std::vector<std::string> file_names(const SequenceSource& source);
/// The checksum of the names and sizes of the files of images or of a video, and of the content of
/// at most 16 of them, which are evenly spaced; empty for descriptors.
std::string images_checksum(const SequenceSource& source);

/// Finds frames by partial paths.
class FrameNames {
 public:
  explicit FrameNames(std::vector<std::string> names);

  /// The number of frames; 0 if their names are unknown.
  size_t count() const { return names_.size(); }
  const std::string& name(size_t frame) const { return names_[frame]; }
  /// The frame with this name: an equal path, or the one with the most equal last components (file
  /// name, folder, ...); if no file name is equal, the only one with this name without its
  /// extension. Backslashes separate folders as slashes do, unless a frame has them in its name.
  /// Nullopt if there is none, on a tie, or for several paths in one text.
  std::optional<size_t> find(std::string_view path) const;
  /// Whether a frame has the file name of `path`, with or without its extension.
  bool has(std::string_view path) const;

 private:
  std::vector<std::string> names_;
  std::map<std::string, std::vector<size_t>, std::less<>> by_file_name_;
  std::map<std::string, std::vector<size_t>, std::less<>> by_stem_;
};

/// Reads the names of the frames of a sequence; null: unknown.
using NameReader = std::function<std::vector<std::string>()>;

/// Reads the names of a sequence when they are needed, as frame_names does.
NameReader name_reader(SequenceArgument argument);

/// Nullopt if the frames have no names: `names` is null, or throws Error(usage). Throws what it
/// else throws.
std::optional<FrameNames> find_names(const NameReader& names);

}  // namespace vpr
