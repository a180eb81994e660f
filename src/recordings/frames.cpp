#include "recordings/frames.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/parallel.h"
#include "base/text.h"

namespace vpr {
namespace {

// Of FFmpeg's formats, those of videos that need no other file. OpenCV reads the variable when it
// opens a video.
[[maybe_unused]] const bool kFormatsAreLimited =
    ::setenv("OPENCV_FFMPEG_CAPTURE_OPTIONS",
             "format_whitelist;mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpeg,mpegts,mpegvideo,"
             "flv,live_flv,asf,ogg,yuv4mpegpipe,h264,hevc,m4v,mjpeg,mxf,ivf,gif,dv,nut,wtv,rm",
             0) == 0;

cv::Mat in_format(const cv::Mat& image, PixelFormat format) {
  if (format != PixelFormat::gray || image.channels() != 3) return image.clone();
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

void lower_to(std::atomic<size_t>& lowest, size_t value) {
  size_t seen = lowest.load();
  while (value < seen && !lowest.compare_exchange_weak(seen, value)) {
  }
}

// Features depend on the size of an image: different sizes usually indicate mixed sources. `first`:
// the first size that is not empty.
void warn_of_sizes(const SequenceSource& sequence, const std::vector<cv::Size>& sizes,
                   std::vector<cv::Size>::const_iterator first, const Monitor& monitor) {
  const auto differs = [&](const cv::Size& size) { return !size.empty() && size != *first; };
  const auto other = std::find_if(first, sizes.end(), differs);
  if (other == sizes.end()) return;
  const auto name = [&](auto at) { return sequence.files[at - sizes.begin()].filename().string(); };
  warn(monitor, "{}: {} of {} are not {} x {} like {}; the first is {}, {} x {}",
       sequence.argument.path.string(), std::count_if(first, sizes.end(), differs),
       counted(sizes.size(), "image"), first->width, first->height, name(first), name(other),
       other->width, other->height);
}

// The range of all 16-bit images; nullopt if the first image is of another kind. Images that
// cannot be decoded are reported later.
std::optional<PixelRange> find_pixel_range(const SequenceSource& source, const Monitor& monitor) {
  const auto range_at = [&](size_t i) -> std::optional<PixelRange> {
    try {
      return pixel_range(source.files[i]);
    } catch (const Error&) {
      return std::nullopt;
    }
  };
  if (source.files.size() < 2 || !range_at(0)) return std::nullopt;
  std::vector<std::optional<PixelRange>> ranges(source.files.size());
  parallel_for(ranges.size(), monitor, [&](size_t i) { ranges[i] = range_at(i); });
  PixelRange all = *ranges[0];
  for (const auto& range : ranges) {
    if (!range) continue;
    all.low = std::min(all.low, range->low);
    all.high = std::max(all.high, range->high);
  }
  return all;
}

Sequence for_each_image(const SequenceSource& source, PixelFormat format, Unreadable unreadable,
                        const Monitor& monitor, const FrameVisitor& body) {
  const size_t count = source.files.size();
  std::atomic<size_t> lowest_failed{count};
  std::vector<std::optional<Error>> problems(count);
  std::vector<cv::Size> sizes(count);
  const std::optional<PixelRange> range = find_pixel_range(source, monitor);
  StepCounter counter(monitor, "describe", count);
  parallel_for(count, monitor, [&](size_t i) {
    if (i > lowest_failed.load()) return;
    cv::Mat image;
    try {
      image = decode_image(source.files[i], format, range);
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
  const auto first =
      std::ranges::find_if(sizes, [](const cv::Size& size) { return !size.empty(); });
  if (first == sizes.end())
    throw Error(ErrorKind::input, "{}: none of its {} can be decoded. The first: {}",
                source.argument.path.string(), counted(count, "frame"), problems[0]->what());
  sequence.size = {static_cast<uint32_t>(first->width), static_cast<uint32_t>(first->height)};
  warn_of_sizes(source, sizes, first, monitor);
  return sequence;
}

Sequence for_each_video_frame(const SequenceSource& source, PixelFormat format,
                              Unreadable unreadable, const Monitor& monitor,
                              const FrameVisitor& body) {
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
                        const Monitor& monitor, const FrameVisitor& body) {
  if (source.picture != nullptr) {
    body(0, in_format(*source.picture, format));
    return {"", 1, {source.argument.path.filename().string()}};
  }
  const std::string path = source.argument.path.string();
  if (source.kind == SequenceKind::descriptors)
    throw Error(ErrorKind::data, "{}: contains descriptors, but images are needed", path);
  Sequence sequence = source.kind == SequenceKind::video
                          ? for_each_video_frame(source, format, unreadable, monitor, body)
                          : for_each_image(source, format, unreadable, monitor, body);
  if (sequence.unreadable.size() == sequence.frames)
    throw Error(ErrorKind::input, "{}: none of its {} can be decoded", path,
                counted(sequence.frames, "frame"));
  return sequence;
}

bool open_capture(cv::VideoCapture& capture, const std::filesystem::path& path, int backend) {
  try {
    const CodecScope scope(path);
    if (!capture.open(path.string(), backend)) return false;
  } catch (const cv::Exception&) {
    return false;
  }
  const auto size = [&](int property) {
    return static_cast<uint64_t>(std::max(0.0, capture.get(property)));
  };
  check_frame_size(path, size(cv::CAP_PROP_FRAME_WIDTH), size(cv::CAP_PROP_FRAME_HEIGHT));
  return true;
}

namespace {

// A playlist makes FFmpeg open other files, of which some never end.
void refuse_text(const std::filesystem::path& path, std::string_view start) {
  const auto is_text = [](char c) {
    return static_cast<uint8_t>(c) >= ' ' || (c >= '\t' && c <= '\r');
  };
  start = without_byte_order_mark(start);
  if (start.starts_with("YUV4MPEG2") || !std::ranges::all_of(start, is_text)) return;
  throw Error(ErrorKind::input,
              "{}: is a text file, not a video; playlists are not read. Pass the video that it "
              "names or, for a list of images, a file that ends in .txt",
              path.string());
}

// Turns off OpenCV's own rotation, whose direction depends on its version, and returns the EXIF
// orientation that the display matrix of a video stands for.
int orientation_of(cv::VideoCapture& capture, const std::filesystem::path& path) {
  capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
  const int angle = static_cast<int>(capture.get(cv::CAP_PROP_ORIENTATION_META));
  const bool is_reversed = cv::getVersionMajor() == 4 && cv::getVersionMinor() == 6;
  const int clockwise = ((is_reversed ? -angle : angle) % 360 + 360) % 360;
  if (clockwise % 90 != 0) return 1;
  constexpr int kOrientations[2][4] = {{1, 6, 3, 8}, {4, 5, 2, 7}};  // by quarter turns
  return kOrientations[is_mirrored_video(path) ? 1 : 0][clockwise / 90];
}

size_t checked_threads(uint64_t threads) {
  constexpr uint64_t kMostThreads = 1024;
  if (threads > kMostThreads)
    throw Error(ErrorKind::usage, "--threads must be at most {}, found {}", kMostThreads, threads);
  return threads;
}

}  // namespace

VideoReader::VideoReader(const SequenceArgument& argument, PixelFormat format)
    : argument_(argument),
      format_(format),
      capture_(std::make_unique<cv::VideoCapture>()),
      sequence_(argument.sequence) {
  const std::string path = argument.path.string();
  constexpr size_t kSignature = 64;
  refuse_text(argument.path, read_file_start(argument.path, kSignature));
  if (!open_capture(*capture_, argument.path, cv::CAP_FFMPEG))
    throw Error(ErrorKind::input,
                "{}: is neither a folder of images, a list (.txt) nor a video that can be decoded",
                path);
  orientation_ = orientation_of(*capture_, argument.path);
}

VideoReader::~VideoReader() = default;

bool VideoReader::next(IndexedFrame& frame, const Monitor& monitor) {
  const FrameRange& range = argument_.range;
  const std::vector<uint32_t>& sources = sequence_.selection.sources;
  const size_t index = sequence_.frames;
  const bool is_over = !sources.empty() && index >= sources.size();
  const uint64_t source = sources.empty() || is_over ? index : sources[index];
  const uint64_t wanted = range.first + source * range.step;
  if (is_over || (range.last && wanted >= *range.last)) {
    // Checks that the video has as many frames as the range or the video states.
    grab_below(range.last.value_or(std::numeric_limits<uint64_t>::max()), monitor);
    return false;
  }
  if (!grab_below(wanted + 1, monitor)) return false;
  frame.index = sequence_.frames++;
  frame.recorded = wanted;
  sequence_.frame_names.push_back(fmt::format("#{}", wanted));
  const CodecScope scope(argument_.path);  // the frame may be larger than the first one
  cv::Mat image;
  if (capture_->retrieve(image) && !image.empty()) {
    frame.image = in_format(image, format_);
    turn_upright(frame.image, orientation_);
    if (!sequence_.size)
      sequence_.size = {static_cast<uint32_t>(frame.image.cols),
                        static_cast<uint32_t>(frame.image.rows)};
  } else {
    sequence_.unreadable.push_back(frame.index);
    frame.image = cv::Mat();
  }
  return true;
}

Sequence VideoReader::finish(Unreadable unreadable, const Monitor& monitor) {
  const FrameRange& range = argument_.range;
  const std::string path = argument_.path.string();
  if (ended_ && (sequence_.frames == 0 || range.last))
    throw Error(range.is_all() ? ErrorKind::input : ErrorKind::usage,
                fmt::format("{}: has only {} to decode{}", path, counted(position_, "frame"),
                            range.is_all() ? "" : " for " + range_text(range)));
  const double stated = capture_->get(cv::CAP_PROP_FRAME_COUNT);
  constexpr double kOtherRate = 0.05;  // smaller differences are jitter
  // Repeated frames may be counted, but not stored.
  const double fps = frames_per_second();
  const double seconds = (last_ms_ - first_ms_) / 1000;
  const double rate = seconds > 0 ? static_cast<double>(position_ - 1) / seconds : fps;
  if (sequence_.fps && std::abs(*sequence_.fps * static_cast<double>(range.step) - fps) < 1e-9 &&
      std::abs(rate - fps) > kOtherRate * fps)
    sequence_.fps = rate / static_cast<double>(range.step);
  const bool is_short = ended_ && stated > static_cast<double>(position_) * 1.02 + 2;
  const std::string short_text = fmt::format("{}: ends after {}, but states {:.0f}", path,
                                             counted(position_, "frame"), stated);
  if (unreadable == Unreadable::fail && is_short)
    throw Error(ErrorKind::input,
                "{}. It is damaged, or repeats frames. To use the existing frames, pass "
                "--skip-unreadable, or a folder of them: ffmpeg -i VIDEO -fps_mode passthrough "
                "FOLDER/%06d.png",
                short_text);
  if (unreadable == Unreadable::fail && !sequence_.unreadable.empty())
    throw Error(ErrorKind::input,
                "{}: frame {} can't be decoded. To omit it, use --skip-unreadable", path,
                sequence_.frame_names[sequence_.unreadable.front()]);
  if (is_short) warn(monitor, short_text);
  return std::move(sequence_);
}

size_t VideoReader::expected_frames() const {
  if (!sequence_.selection.is_all()) return sequence_.selection.frames();
  const double stated = capture_->get(cv::CAP_PROP_FRAME_COUNT);
  const FrameRange& range = argument_.range;
  if (!(stated > 0 && stated <= 1e12)) return 0;
  const uint64_t last = std::min(range.last.value_or(std::numeric_limits<uint64_t>::max()),
                                 static_cast<uint64_t>(stated));
  return frame_count({range.first, last, range.step}).value();
}

// Grabs frames until `position` is reached; false if there are fewer.
bool VideoReader::grab_below(uint64_t position, const Monitor& monitor) {
  for (; position_ < position; ++position_) {
    check_stop(monitor);
    if (ended_ || !capture_->grab()) {
      ended_ = true;
      return false;
    }
    last_ms_ = shown_at_ms();
    if (position_ == 0) first_ms_ = last_ms_;
  }
  return true;
}

double VideoReader::shown_at_ms() const { return capture_->get(cv::CAP_PROP_POS_MSEC); }

double VideoReader::frames_per_second() const { return capture_->get(cv::CAP_PROP_FPS); }

std::vector<int64_t> read_video_times(const SequenceArgument& argument, const Monitor& monitor) {
  VideoReader reader(argument, PixelFormat::gray);
  std::vector<int64_t> times;
  std::vector<int64_t> by_rate;
  constexpr double kMaxMs = 1e12;  // 31 years; damaged videos state any time
  bool do_rise = true;
  const double fps = reader.frames_per_second();
  for (IndexedFrame frame; reader.next(frame, monitor);) {
    const double ms = reader.shown_at_ms();
    do_rise = do_rise && ms >= 0 && ms <= kMaxMs;
    times.push_back(do_rise ? std::llround(ms * 1e6) : 0);
    by_rate.push_back(fps > 1e-3 ? std::llround(static_cast<double>(frame.recorded) * 1e9 / fps)
                                 : 0);
    do_rise = do_rise && (times.size() < 2 || times.back() > times[times.size() - 2]);
  }
  if (do_rise) return times;
  if (fps > 1e-3 && fps < 1e6) return by_rate;
  throw Error(ErrorKind::input, "{}: has neither times of its frames nor a frame rate",
              argument.path.string());
}

ProcessScope::ProcessScope(const ProcessSettings& settings)
    : threads(checked_threads(settings.threads)),
      megapixels_before(set_megapixel_limit(settings.max_megapixels)),
      order_before(set_frame_order(settings.order)),
      cv_threads(cv::getNumThreads()),
      is_cv_optimized(cv::useOptimized()),
      cv_log_level(cv::utils::logging::getLogLevel()) {
  cv::setNumThreads(1);        // one frame per thread, instead of one frame in parallel
  cv::setUseOptimized(false);  // otherwise features depend on AVX2
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

ProcessScope::~ProcessScope() {
  cv::utils::logging::setLogLevel(static_cast<cv::utils::logging::LogLevel>(cv_log_level));
  cv::setUseOptimized(is_cv_optimized);
  cv::setNumThreads(cv_threads);
  set_frame_order(order_before);
  set_megapixel_limit(megapixels_before);
}

}  // namespace vpr
