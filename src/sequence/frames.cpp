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
#include "sequence/video_reader.h"

namespace vpr {
namespace {

using FrameBody = std::function<void(size_t, const cv::Mat&)>;

void lower_to(std::atomic<size_t>& lowest, size_t value) {
  size_t seen = lowest.load();
  while (value < seen && !lowest.compare_exchange_weak(seen, value)) {
  }
}

// Features depend on the size of an image: different sizes usually indicate mixed sources.
void warn_of_sizes(const SequenceSource& sequence, const std::vector<cv::Size>& sizes,
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

Sequence for_each_image(const SequenceSource& source, PixelFormat format, Unreadable unreadable,
                        const Monitor& monitor, const FrameBody& body) {
  const size_t count = source.files.size();
  std::atomic<size_t> lowest_failed{count};
  std::vector<std::optional<Error>> problems(count);
  std::vector<cv::Size> sizes(count);
  StepCounter counter(monitor, "describe", count);
  parallel_for(count, monitor, [&](size_t i) {
    if (i > lowest_failed.load()) return;
    cv::Mat image;
    try {
      image = decode_image(source.files[i], format);
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
  Sequence sequence = source.argument.sequence;
  sequence.frames = count;
  for (size_t i = 0; i < count; ++i) {
    sequence.frame_names.push_back(source.files[i].filename().string());
    if (problems[i]) sequence.unreadable.push_back(i);
  }
  warn_of_sizes(source, sizes, monitor);
  return sequence;
}

Sequence for_one_picture(const SequenceSource& source, PixelFormat format, const FrameBody& body) {
  body(0, in_format(*source.picture, format));
  return {"", 1, {source.argument.path.filename().string()}};
}

Sequence for_each_video_frame(const SequenceSource& source, PixelFormat format,
                              Unreadable unreadable, const Monitor& monitor,
                              const FrameBody& body) {
  namespace tbb = oneapi::tbb;
  using FramePointer = std::shared_ptr<IndexedFrame>;
  VideoReader reader(source.argument, format);
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

Sequence for_each_frame(const SequenceSource& source, PixelFormat format, Unreadable unreadable,
                        const Monitor& monitor, const FrameBody& body) {
  if (source.picture != nullptr) return for_one_picture(source, format, body);
  const std::string path = source.argument.path.string();
  if (source.kind == SequenceKind::descriptors)
    throw Error(ErrorKind::data,
                fmt::format("{}: holds descriptors, and images are needed here", path));
  Sequence sequence = source.kind == SequenceKind::video
                          ? for_each_video_frame(source, format, unreadable, monitor, body)
                          : for_each_image(source, format, unreadable, monitor, body);
  if (sequence.unreadable.size() == sequence.frames)
    throw Error(ErrorKind::input, fmt::format("{}: none of its {} can be decoded", path,
                                              counted(sequence.frames, "frame")));
  return sequence;
}

}  // namespace vpr
