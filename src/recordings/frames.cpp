#include "recordings/frames.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <map>
#include <numeric>
#include <set>

#include <fmt/ranges.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"

extern "C" {
#include <libavutil/log.h>
}

namespace vpr {
namespace {

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

// Warns of a folder that has several images of each frame, such as 1.color.png and 1.depth.png.
void warn_of_kinds(const SequenceSource& source, const Monitor& monitor) {
  std::map<std::string, size_t> frames;
  std::set<std::string> kinds;
  for (const auto& file : source.files) {
    const std::string name = file.filename().string();
    const size_t point = std::min(name.find('.'), name.size());
    ++frames[name.substr(0, point)];
    kinds.insert(name.substr(point));
  }
  const auto is_word = [](const std::string& kind) {
    return kind.size() > 1 && std::isalpha(static_cast<unsigned char>(kind[1])) != 0;
  };
  const auto is_complete = [&](const auto& frame) { return frame.second == kinds.size(); };
  if (frames.size() > 1 && kinds.size() > 1 && std::ranges::all_of(kinds, is_word) &&
      std::ranges::all_of(frames, is_complete))
    warn(monitor, "{}: has {} images of each frame: {}. To use one of them, pass a list of images",
         source.argument.path.string(), kinds.size(), fmt::join(kinds, ", "));
}

// The number of images in subfolders that can be read and are not hidden; 0 for a list.
size_t images_in_subfolders(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  size_t images = 0;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (!entry.is_directory(ignored) || entry.path().filename().string().starts_with('.')) continue;
    for (const fs::directory_entry& file : fs::directory_iterator(entry.path(), ignored))
      images += is_frame_name(file.path()) ? 1 : 0;
  }
  return images;
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
  return std::accumulate(ranges.begin(), ranges.end(), ranges[0], united);
}

Sequence for_each_image(const SequenceSource& source, PixelFormat format, Unreadable unreadable,
                        const Monitor& monitor, const FrameVisitor& visit) {
  const size_t count = source.files.size();
  std::atomic<size_t> lowest_failed{count};
  std::vector<std::optional<Error>> problems(count);
  std::vector<cv::Size> sizes(count);
  const std::optional<PixelRange> range = find_pixel_range(source, monitor);
  StepCounter counter(monitor, "describe", count);
  std::atomic<size_t> taken{0};
  parallel_for(count, monitor, [&](size_t) {
    const size_t i = taken++;
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
    visit(i, image);
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
  if (const size_t others = images_in_subfolders(source.argument.path))
    warn(monitor, "{}: {} in its subfolders, which are not searched", source.argument.path.string(),
         counted(others, "image"));
  warn_of_sizes(source, sizes, first, monitor);
  warn_of_kinds(source, monitor);
  return sequence;
}

Sequence for_each_video_frame(const SequenceSource& source, PixelFormat format,
                              Unreadable unreadable, const Monitor& monitor,
                              const FrameVisitor& visit) {
  namespace tbb = oneapi::tbb;
  using FramePointer = std::shared_ptr<IndexedFrame>;
  VideoReader reader(source.argument, format, unreadable);
  reader.find_range(monitor);
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
    visit(frame->index, frame->image);
    counter.add();
  };
  {
    const ThreadOrder order;
    tbb::parallel_pipeline(
        2 * thread_count(),
        tbb::make_filter<void, FramePointer>(tbb::filter_mode::serial_in_order, read) &
            tbb::make_filter<FramePointer, void>(tbb::filter_mode::parallel, describe));
  }
  return reader.finish(monitor);
}

}  // namespace

Sequence for_each_frame(const SequenceSource& source, PixelFormat format, Unreadable unreadable,
                        const Monitor& monitor, const FrameVisitor& body,
                        const std::function<void(size_t index)>& skipped) {
  if (source.picture != nullptr) {
    body(0, in_format(*source.picture, format));
    return {"", 1, {source.argument.path.filename().string()}};
  }
  const std::string path = source.argument.path.string();
  if (source.kind == SequenceKind::descriptors)
    throw Error(ErrorKind::data, "{}: contains descriptors, but images are needed", path);
  const FrameVisitor visit = [&](size_t index, const cv::Mat& image) {
    if (!image.empty())
      body(index, image);
    else if (skipped)
      skipped(index);
  };
  Sequence sequence = source.kind == SequenceKind::video
                          ? for_each_video_frame(source, format, unreadable, monitor, visit)
                          : for_each_image(source, format, unreadable, monitor, visit);
  if (sequence.unreadable.size() == sequence.frames)
    throw Error(ErrorKind::input, "{}: none of its {} can be decoded", path,
                counted(sequence.frames, "frame"));
  return sequence;
}

namespace {

size_t checked_threads(uint64_t threads) {
  constexpr uint64_t kMostThreads = 1024;
  if (threads > kMostThreads)
    throw Error(ErrorKind::usage, "--threads must be at most {}, found {}", kMostThreads, threads);
  return threads;
}

}  // namespace

ProcessScope::ProcessScope(const ProcessSettings& settings)
    : threads(checked_threads(settings.threads)),
      megapixels_before(set_megapixel_limit(settings.max_megapixels)),
      order_before(set_frame_order(settings.order)),
      cv_threads(cv::getNumThreads()),
      is_cv_optimized(cv::useOptimized()),
      cv_log_level(cv::utils::logging::getLogLevel()),
      ffmpeg_log_level(av_log_get_level()) {
  cv::setNumThreads(1);        // one frame per thread, instead of one frame in parallel
  cv::setUseOptimized(false);  // otherwise features depend on AVX2
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  av_log_set_level(AV_LOG_QUIET);
}

ProcessScope::~ProcessScope() {
  av_log_set_level(ffmpeg_log_level);
  cv::utils::logging::setLogLevel(static_cast<cv::utils::logging::LogLevel>(cv_log_level));
  cv::setUseOptimized(is_cv_optimized);
  cv::setNumThreads(cv_threads);
  set_frame_order(order_before);
  set_megapixel_limit(megapixels_before);
}

}  // namespace vpr
