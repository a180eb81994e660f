// The frames of what the user names: a folder of images, a list of them, or a video.
#pragma once

#include <filesystem>
#include <vector>

#include "images/sequence_argument.h"

namespace vpr {

/// What frames come from.
enum class SequenceKind { images, video };

/// Frames in order, not read yet. For images `files` holds the range's files; a video is cut to its
/// range while it is read, since only then is its length known.
struct Sequence {
  SequenceArgument argument;
  SequenceKind kind = SequenceKind::images;
  std::vector<std::filesystem::path> files;
};

/// Folder: its images by extension, hidden files and other files left out, no recursion, in natural
/// order. Text file (.txt, .lst, .csv): one image a line, in the file's order, relative to the
/// file; empty lines and lines that start with # are skipped. Anything else: a video.
/// Throws Error(input) for a missing path or an empty sequence, Error(usage) for a range that does
/// not fit the frames there are.
Sequence open_sequence(const SequenceArgument& argument);

/// The frames of each sub-folder of `folder` that is not hidden, in natural order. Throws
/// Error(input) if there is none.
std::vector<SequenceArgument> subfolder_arguments(const std::filesystem::path& folder);

}  // namespace vpr
