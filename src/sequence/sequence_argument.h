// A sequence on the command line: a folder, list or video, a range of its frames, and its name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace vpr {

struct Replay;

/// Frames first, first + step, ... below last; `last` absent: to the end.
struct FrameRange {
  uint64_t first = 0;
  std::optional<uint64_t> last;
  uint64_t step = 1;

  bool is_all() const { return first == 0 && !last && step == 1; }
  bool operator==(const FrameRange&) const = default;
};

/// The frame of the range that frame `recorded` of the whole recording is; nothing outside it.
std::optional<uint64_t> frame_in_range(const FrameRange& range, uint64_t recorded);

/// How many frames a range has whose end is given; nothing for one to the end.
std::optional<uint64_t> frame_count(const FrameRange& range);

/// `PATH` or `PATH@FIRST:LAST[:STEP]`.
struct SequenceArgument {
  std::filesystem::path path;
  FrameRange range;
  std::optional<double> fps = {};  ///< frames a second, of those that are kept; none: not known
  /// Which of the range's frames are kept (thinning.h); null: all.
  std::shared_ptr<const Replay> kept = {};
};

/// A path that exists as written wins over a range in its name. Throws Error(usage) for an empty or
/// reversed range, a step of 0, or a number that is too large.
SequenceArgument parse_sequence_argument(const std::string& text);

/// "@10:20", "@:20:2"; empty for all frames.
std::string range_text(const FrameRange& range);

/// What an error about a frame that is out of range says more, where the file `path` counts the
/// frames of a whole recording: "; if the sequence is ..., as in PATH@60:111".
std::string range_hint(const std::filesystem::path& path);

/// Names for results: the folder's (list's, video's) own name, with parents added ("a/ref",
/// "b/ref"), extensions or ranges where two are equal, or one is equal to a name that is taken.
/// Bytes that are not UTF-8 become %XX. Throws Error(usage) when that does not tell them apart: the
/// same frames were given twice.
std::vector<std::string> sequence_names(const std::vector<SequenceArgument>& arguments,
                                        const std::vector<std::string>& taken = {});

}  // namespace vpr
