// The frames of a sequence and their names: images, a list of them, a video, or arrays of
// descriptors.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sequence/sequence_argument.h"

namespace cv {
class Mat;
}

namespace vpr {

/// What frames come from. Of descriptors there is no frame to decode.
enum class SequenceKind { images, video, descriptors };

/// Frames in order, not read yet. For images `files` holds the range's files; a video is cut to its
/// range while it is read, since only then is its length known. Descriptors are .npy files, one a
/// frame, or one with a row a frame, which is cut to its range when it is read, too.
struct Sequence {
  SequenceArgument argument;
  SequenceKind kind = SequenceKind::images;
  std::vector<std::filesystem::path> files;
  /// A frame that is decoded already, in blue, green and red or in grey: then it is the only one.
  const cv::Mat* picture = nullptr;

  /// Whether its only file has a row a frame.
  bool is_one_array() const {
    return kind == SequenceKind::descriptors && files.size() == 1 && files.front() == argument.path;
  }
};

/// Folder: its images by extension, hidden files and other files left out, no recursion, in natural
/// order. Text file (.txt, .lst, .csv): one image a line, in the file's order, relative to the
/// file; empty lines and lines that start with # are skipped. A .npy file, a folder of them without
/// images, or a list of them: descriptors. Anything else: a video.
/// Throws Error(input) for a missing path or an empty sequence, Error(usage) for a range that does
/// not fit the frames there are.
Sequence open_sequence(const SequenceArgument& argument);

/// Whether a file in a folder is one of its frames by its name: it has the extension of an image
/// format, and is not hidden.
bool is_frame_name(const std::filesystem::path& path);

/// The frames of each sub-folder of `folder` that is not hidden, in natural order. Throws
/// Error(input) if there is none.
std::vector<SequenceArgument> subfolder_arguments(const std::filesystem::path& folder);

/// Names of frames in order: the lines of a list (.txt, .lst, .csv; empty lines and lines that
/// start with # are no names, and no file needs to be there), or the paths of a sequence's frames.
/// Throws as open_sequence does, and Error(usage) for a range of a list that it does not have, or a
/// video.
std::vector<std::string> frame_names(const SequenceArgument& argument);

/// Finds frames by paths that begin anywhere.
class FrameNames {
 public:
  /// Without names, a frame is called by its number, from 0.
  explicit FrameNames(std::vector<std::string> names);

  /// How many there are; nothing where they are called by numbers.
  std::optional<size_t> count() const;
  /// The frame of that name: the same path, or else the one whose last components (file name,
  /// folder, ...) agree most; if no file name agrees, the only one that has this name without its
  /// extension. Nothing if no name agrees, or several agree equally.
  std::optional<size_t> find(std::string_view path) const;

 private:
  std::vector<std::string> names_;
  std::map<std::string, std::vector<size_t>, std::less<>> by_file_name_;
  std::map<std::string, std::vector<size_t>, std::less<>> by_stem_;
};

}  // namespace vpr
