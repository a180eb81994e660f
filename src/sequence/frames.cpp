#include "sequence/frames.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "sequence/selection.h"
#include "sequence/video_reader.h"

namespace vpr {
namespace {

using FrameBody = std::function<void(size_t, const cv::Mat&)>;

void lower_to(std::atomic<size_t>& lowest, size_t value) {
  size_t seen = lowest.load();
  while (value < seen && !lowest.compare_exchange_weak(seen, value)) {
  }
}

// Features differ with the size of an image: usually a folder of mixed sources.
void warn_of_sizes(const Sequence& sequence, const std::vector<cv::Size>& sizes,
                   const Monitor& monitor) {
  const auto is_decoded = [](const cv::Size& size) { return !size.empty(); };
  const auto first = std::ranges::find_if(sizes, is_decoded);
  if (first == sizes.end()) return;
  const auto differs = [&](const cv::Size& size) { return is_decoded(size) && size != *first; };
  const auto other = std::find_if(first, sizes.end(), differs);
  if (other == sizes.end()) return;
  const auto name = [&](auto at) { return sequence.files[at - sizes.begin()].filename().string(); };
  warn(monitor,
       fmt::format("{}: {} of {} are not {} x {} like {}; the first is {}, {} x {}",
                   sequence.argument.path.string(), std::count_if(first, sizes.end(), differs),
                   counted(sizes.size(), "image"), first->width, first->height, name(first),
                   name(other), other->width, other->height));
}

FrameList for_each_image(const Sequence& sequence, PixelFormat format, Unreadable unreadable,
                         const Monitor& monitor, const FrameBody& body) {
  const size_t count = sequence.files.size();
  std::atomic<size_t> lowest_failed{count};
  std::vector<std::optional<Error>> problems(count);
  std::vector<cv::Size> sizes(count);
  StepCounter counter(monitor, "describe", count);
  parallel_for(count, monitor, [&](size_t i) {
    if (i > lowest_failed.load()) return;
    cv::Mat image;
    try {
      image = decode_image(sequence.files[i], format);
    } catch (const Error& error) {
      problems[i] = error;
      const bool is_skipped = unreadable == Unreadable::skip && error.kind() == ErrorKind::input;
      if (!is_skipped) lower_to(lowest_failed, i);
    }
    sizes[i] = image.size();
    if (!image.empty()) body(i, image);
    counter.add();
  });
  if (lowest_failed < count) throw Error(*problems[lowest_failed]);
  FrameList frames;
  for (size_t i = 0; i < count; ++i) {
    frames.names.push_back(sequence.files[i].filename().string());
    if (problems[i]) frames.unreadable.push_back(i);
  }
  warn_of_sizes(sequence, sizes, monitor);
  return frames;
}

FrameList for_one_picture(const Sequence& sequence, PixelFormat format, const FrameBody& body) {
  body(0, in_format(*sequence.picture, format));
  return {{sequence.argument.path.filename().string()}, {}};
}

FrameList for_each_video_frame(const Sequence& sequence, PixelFormat format, Unreadable unreadable,
                               const Monitor& monitor, const FrameBody& body) {
  namespace tbb = oneapi::tbb;
  using FramePointer = std::shared_ptr<IndexedFrame>;
  VideoReader reader(sequence.argument, format);
  StepCounter counter(monitor, "describe", reader.expected_frames());
  const auto read = [&](tbb::flow_control& control) {
    const ThreadOrder::Part part;
    take_over(&reader);
    auto frame = std::make_shared<IndexedFrame>();
    if (!reader.next(*frame, monitor)) control.stop();
    hand_over(&reader);
    hand_over(frame.get());
    return frame;
  };
  const auto describe = [&](const FramePointer& frame) {
    const ThreadOrder::Part part;
    take_over(frame.get());
    if (!frame->image.empty()) body(frame->index, frame->image);
    counter.add();
  };
  {
    const ThreadOrder order;
    tbb::parallel_pipeline(
        2 * thread_count(),
        tbb::make_filter<void, FramePointer>(tbb::filter_mode::serial_in_order, read) &
            tbb::make_filter<FramePointer, void>(tbb::filter_mode::parallel, describe));
  }
  return reader.finish(unreadable, monitor);
}

}  // namespace

FrameList replayed(const FrameList& recorded, Replay replay) {
  FrameList frames;
  frames.names = replayed(recorded.names, replay);
  frames.unreadable = replayed_frames(replay, recorded.unreadable);
  frames.replay =
      recorded.replay ? replay_of_kept(*recorded.replay, std::move(replay)) : std::move(replay);
  frames.fps = recorded.fps;
  return frames;
}

void note_kept(FrameList& frames, const SequenceArgument& argument) {
  if (argument.kept) frames.replay = *argument.kept;
  frames.fps = argument.fps;
}

FrameList for_each_frame(const Sequence& sequence, PixelFormat format, Unreadable unreadable,
                         const Monitor& monitor, const FrameBody& body) {
  if (sequence.picture != nullptr) return for_one_picture(sequence, format, body);
  if (sequence.kind == SequenceKind::descriptors)
    throw Error(ErrorKind::data, fmt::format("{}: holds descriptors, and images are needed here",
                                             sequence.argument.path.string()));
  FrameList frames = sequence.kind == SequenceKind::video
                         ? for_each_video_frame(sequence, format, unreadable, monitor, body)
                         : for_each_image(sequence, format, unreadable, monitor, body);
  note_kept(frames, sequence.argument);
  if (frames.unreadable.size() == frames.count())
    throw Error(ErrorKind::input,
                fmt::format("{}: none of its {} can be decoded", sequence.argument.path.string(),
                            counted(frames.count(), "frame")));
  return frames;
}

}  // namespace vpr
