// Decodes the frames of a sequence, one by one or in parallel, without keeping them.
#pragma once

#include <functional>

#include "base/monitor.h"
#include "sequence/decode.h"
#include "sequence/sequence_source.h"

namespace cv {
class Mat;
}

namespace vpr {

/// The treatment of an undecodable frame: it ends the work, or it keeps its index and is skipped.
enum class Unreadable { fail, skip };

/// Calls body(index, image) for each readable frame, in any order, from several threads. Files are
/// decoded in parallel; a video is read frame by frame in one thread, without seeking, while others
/// process its frames. BGR frames of a video are converted to gray by BGR2GRAY. With
/// Unreadable::fail, the first (lowest) undecodable frame throws Error(input); with skip, only a
/// sequence without any readable frame does. A frame above the MegapixelLimit throws Error(usage)
/// in both cases, for a video before any frame is decoded. A sequence of descriptors throws
/// Error(data). Returns the sequence of the argument with its frames.
Sequence for_each_frame(const SequenceSource& source, PixelFormat format, Unreadable unreadable,
                        const Monitor& monitor,
                        const std::function<void(size_t index, const cv::Mat& image)>& body);

}  // namespace vpr
