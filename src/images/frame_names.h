// Frames by their names, as lists of other programs have them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "images/sequence_argument.h"

namespace vpr {

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
