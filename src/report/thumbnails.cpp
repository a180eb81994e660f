#include "report/thumbnails.h"

#include <algorithm>
#include <cstring>
#include <mutex>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "images/frames.h"

namespace vpr {
namespace {

constexpr int kQuality = 70;

std::vector<std::byte> small_jpeg(const cv::Mat& image, int side) {
  const double scale = std::min(1.0, double(side) / std::max({image.cols, image.rows, 1}));
  const cv::Size size(std::max(1, cvRound(image.cols * scale)),
                      std::max(1, cvRound(image.rows * scale)));
  cv::Mat resized;
  cv::resize(image, resized, size, 0, 0, cv::INTER_AREA);
  std::vector<uint8_t> jpeg;
  cv::imencode(".jpg", resized, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  std::vector<std::byte> bytes(jpeg.size());
  std::memcpy(bytes.data(), jpeg.data(), jpeg.size());
  return bytes;
}

}  // namespace

std::map<size_t, Thumbnail> make_thumbnails(const Sequence& sequence,
                                            const std::set<size_t>& wanted, int side,
                                            const Monitor& monitor) {
  std::map<size_t, Thumbnail> found;
  std::mutex mutex;
  const auto keep = [&](size_t index, std::string name, const cv::Mat& image) {
    std::vector<std::byte> jpeg =
        image.empty() ? std::vector<std::byte>{} : small_jpeg(image, side);
    const std::scoped_lock lock(mutex);
    found[index] = {std::move(name), std::move(jpeg)};
  };
  if (wanted.empty()) return found;
  if (sequence.kind != SequenceKind::images) {
    for_each_frame(sequence, PixelFormat::bgr, Unreadable::skip, monitor,
                   [&](size_t index, const cv::Mat& image) {
                     if (wanted.contains(index)) keep(index, fmt::format("#{}", index), image);
                   });
    return found;
  }
  const std::vector<size_t> order(wanted.begin(), wanted.end());
  parallel_for(order.size(), monitor, [&](size_t i) {
    if (order[i] >= sequence.files.size()) return;
    const auto& file = sequence.files[order[i]];
    cv::Mat image;
    try {
      image = decode_image(file, PixelFormat::bgr);
    } catch (const Error&) {  // shown as a gap
    }
    keep(order[i], file.filename().string(), image);
  });
  return found;
}

std::map<size_t, Thumbnail> make_replay_thumbnails(const Sequence& sequence,
                                                   const std::optional<Replay>& replay,
                                                   const std::set<size_t>& wanted, int side,
                                                   const Monitor& monitor) {
  if (!replay) return make_thumbnails(sequence, wanted, side, monitor);
  std::set<size_t> sources;
  for (const size_t frame : wanted) sources.insert(replay->sources[frame]);
  const std::map<size_t, Thumbnail> recorded = make_thumbnails(sequence, sources, side, monitor);
  std::map<size_t, Thumbnail> found;
  for (const size_t frame : wanted)
    if (const auto source = recorded.find(replay->sources[frame]); source != recorded.end())
      found.insert({frame, source->second});
  return found;
}

}  // namespace vpr
