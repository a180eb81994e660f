// The frames of what the user names: a folder of images, a list of them, or a video; or arrays of
// what describes them.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "images/sequence_argument.h"

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

}  // namespace vpr
