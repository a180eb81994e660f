// A camera that is followed: frames as they are taken, without an end.
#pragma once

#include <memory>

#include <opencv2/videoio.hpp>

#include "images/live_source.h"

namespace vpr {

/// Whether the path is a device that bytes come from, as /dev/video0 is. Whether it is a camera is
/// only known once it is opened.
bool is_device(const std::filesystem::path& path);

/// The camera of a device, by Video4Linux. Frames are counted as they come: a range leaves out the
/// first ones, takes every STEP-th, and ends before LAST. Throws Error(input) for what is no
/// camera, or is busy, and Error(usage) for frames that are too large.
std::unique_ptr<LiveSource> open_camera(const SequenceArgument& argument);

/// The same of a capture that is open, whatever it reads. next() waits for as long as a frame
/// takes; a signal ends a wait for Video4Linux. It throws Error(input) where no frame comes any
/// more: the camera was unplugged, or says nothing for the ten seconds that OpenCV waits.
std::unique_ptr<LiveSource> follow_camera(std::unique_ptr<cv::VideoCapture> capture,
                                          const SequenceArgument& argument);

}  // namespace vpr
