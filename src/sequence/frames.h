// The frames of a sequence, decoded one after the other or several at once, none kept.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "sequence/decode.h"
#include "sequence/selection.h"
#include "sequence/sequence.h"

namespace cv {
class Mat;
}

namespace vpr {

/// What a frame that can't be decoded does: it ends the work, or keeps its index and is passed
/// over.
enum class Unreadable { fail, skip };

/// What a pass over a sequence found.
struct FrameList {
  std::vector<std::string> names;     ///< per frame: the image's file name, or "#12" of a video
  std::vector<size_t> unreadable;     ///< rising; frames that keep their index but had no image
  std::optional<Replay> replay = {};  ///< where they are those of a recording that is replayed
  std::optional<double> fps = {};     ///< frames a second, where known
  size_t count() const { return names.size(); }
};

/// The list with its frames replayed; of frames that are kept of a recording, the replay becomes
/// one of the recording.
FrameList replayed(const FrameList& recorded, Replay replay);

/// Calls body(index, image) for each readable frame, in any order, from several threads. Files are
/// decoded in parallel; a video is read frame after frame in one thread, without seeking, while
/// others work on its frames. BGR frames of a video become grey by BGR2GRAY.
/// With Unreadable::fail the first (lowest) frame that can't be decoded throws Error(input);
/// with skip, a sequence without any readable frame does. A frame that is larger than the
/// MegapixelLimit throws Error(usage) with either, a video's before one is decoded. A sequence of
/// descriptors throws Error(data).
FrameList for_each_frame(const Sequence& sequence, PixelFormat format, Unreadable unreadable,
                         const Monitor& monitor,
                         const std::function<void(size_t index, const cv::Mat& image)>& body);

/// Notes which frames of a recording the argument keeps, and their rate.
void note_kept(FrameList& frames, const SequenceArgument& argument);

}  // namespace vpr
