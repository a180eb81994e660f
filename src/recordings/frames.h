// Decodes the frames of a sequence, one by one or in parallel, without keeping them, and sets up
// the process for it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "base/parallel.h"
#include "recordings/decode.h"
#include "recordings/frame_order.h"
#include "recordings/sequence_source.h"
#include "recordings/video.h"

namespace vpr {

using FrameVisitor = std::function<void(size_t index, const cv::Mat& image)>;

/// Calls body(index, image) for each readable frame and skipped(index) for each other one, in any
/// order, from several threads, which take the frames in order. Files are decoded in parallel; a
/// video is read frame by frame in one thread, without seeking, while others process its frames.
/// With Unreadable::fail, the first (lowest) undecodable frame throws Error(input); with skip, only
/// a sequence without any readable frame does. A frame above the limit of megapixels throws
/// Error(usage) in both cases, for a video before any frame is decoded. A sequence of descriptors
/// throws Error(data). Returns the sequence of the argument with its frames.
Sequence for_each_frame(const SequenceSource& source, PixelFormat format, Unreadable unreadable,
                        const Monitor& monitor, const FrameVisitor& body,
                        const std::function<void(size_t index)>& skipped = {});

/// Settings that belong to the whole process: of every program and of every call from Python.
struct ProcessSettings {
  uint64_t threads = 0;  ///< 0: all cores
  uint64_t seed = 1;
  uint64_t max_megapixels = kDefaultMegapixels;
  FrameOrder order = FrameOrder::automatic;
};
VPR_FIELDS(ProcessSettings, (threads, "0: all cores."), (seed, "Seed of random choices."),
           (max_megapixels, "Largest accepted frame, in million pixels.", within(1, 1073)),
           (order, "Order of the images in folders."))

/// Applies settings to the process during its lifetime, and has OpenCV work on one thread per
/// frame, silently, as FFmpeg, and without code that depends on the processor. Throws Error(usage)
/// for settings out of range.
struct ProcessScope {
  explicit ProcessScope(const ProcessSettings& settings);
  ~ProcessScope();
  ProcessScope(const ProcessScope&) = delete;
  ProcessScope& operator=(const ProcessScope&) = delete;

  ThreadLimit threads;
  uint64_t megapixels_before;
  FrameOrder order_before;
  int cv_threads;
  bool is_cv_optimized;
  int cv_log_level;
  int ffmpeg_log_level;
};

}  // namespace vpr
