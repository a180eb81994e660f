#include "report/matrix_picture.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <set>

#include <opencv2/imgproc.hpp>

#include "evaluation/score_layout.h"
#include "report/framed_picture.h"
#include "report/palette.h"
#include "report/png_file.h"

namespace vpr {
namespace {

constexpr size_t kMostPixels = 2000;   // a side of a scaled-down picture
constexpr size_t kFewestPixels = 600;  // a side of an enlarged one
constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

const cv::Vec3b kNoDistanceColour(235, 225, 215);

cv::Vec3b blend(const cv::Vec3b& a, const cv::Vec3b& b) {
  cv::Vec3b mixed;
  for (int c = 0; c < 3; ++c) mixed[c] = static_cast<uint8_t>((a[c] + b[c]) / 2);
  return mixed;
}

Meaning meaning_of(const SequenceResult& result, const Cell& hit, const GroundTruth* truth) {
  const PlaceLabel label = truth == nullptr
                               ? PlaceLabel::ignore
                               : truth->label(result.anchor(hit.query_window), hit.sequence,
                                              result.anchor(hit.train_window));
  return meaning_of(label);
}

}  // namespace

struct MatrixPicture::Pixels {
  size_t rows;
  size_t cols;
  std::vector<std::atomic<uint32_t>> closest;

  Pixels(size_t r, size_t c) : rows(r), cols(c), closest(r * c) {
    for (auto& value : closest) value = kNone;
  }
};

MatrixPicture::MatrixPicture(const MatrixLayout& layout) : layout_(layout) {
  const size_t side = std::max({layout.rows, layout.cols, size_t{1}});
  scale_ = (side + kMostPixels - 1) / kMostPixels;
  pixels_ = std::make_unique<Pixels>(std::max<size_t>(1, (layout.rows + scale_ - 1) / scale_),
                                     std::max<size_t>(1, (layout.cols + scale_ - 1) / scale_));
}

MatrixPicture::~MatrixPicture() = default;

void MatrixPicture::operator()(const DistanceRow& row) {
  const size_t y = row.query_window / scale_;
  const size_t first = layout_.first_column[row.sequence] + row.train_window;
  for (size_t i = 0; i < row.distances.size();) {
    const size_t x = (first + i) / scale_;
    uint32_t closest = kNone;
    for (; i < row.distances.size() && (first + i) / scale_ == x; ++i)
      closest = std::min(closest, row.distances[i]);
    std::atomic<uint32_t>& pixel = pixels_->closest[y * pixels_->cols + x];
    uint32_t seen = pixel.load(std::memory_order_relaxed);
    while (closest < seen && !pixel.compare_exchange_weak(seen, closest)) {
    }
  }
}

std::optional<std::pair<uint32_t, uint32_t>> MatrixPicture::range() const {
  uint32_t least = kNone;
  uint32_t most = 0;
  for (const auto& value : pixels_->closest) {
    if (value == kNone) continue;
    least = std::min<uint32_t>(least, value);
    most = std::max<uint32_t>(most, value);
  }
  if (least == kNone) return std::nullopt;
  return std::pair(least, most);
}

cv::Mat MatrixPicture::grey_image() const {
  const auto [least, most] = range().value_or(std::pair(0u, 0u));
  cv::Mat image(static_cast<int>(pixels_->rows), static_cast<int>(pixels_->cols), CV_8UC3,
                kNoDistanceColour);
  for (size_t p = 0; p < pixels_->closest.size(); ++p) {
    const uint32_t value = pixels_->closest[p];
    if (value == kNone) continue;
    const auto grey =
        static_cast<uint8_t>(most == least ? 0 : 255.0 * (value - least) / (most - least));
    image.at<cv::Vec3b>(static_cast<int>(p / pixels_->cols), static_cast<int>(p % pixels_->cols)) =
        cv::Vec3b(grey, grey, grey);
  }
  return image;
}

cv::Vec3b& MatrixPicture::pixel(cv::Mat& image, size_t window, size_t sequence,
                                size_t train_window) const {
  return image.at<cv::Vec3b>(
      static_cast<int>(window / scale_),
      static_cast<int>((layout_.first_column[sequence] + train_window) / scale_));
}

void MatrixPicture::draw_truth(cv::Mat& image, const SequenceResult& result,
                               const GroundTruth& truth, const Monitor& monitor) const {
  const auto back = static_cast<int64_t>(result.settings.window_length) - 1;  // anchor to window
  const cv::Vec3b colour = bgr_of(Meaning::truth);
  for (size_t window = 0; window < layout_.rows; ++window) {
    for (const GroundTruth::Pair& pair : truth.pairs[result.anchor(window)]) {
      if (pair.label != PlaceLabel::same) continue;
      check_stop(monitor);
      const auto frames = static_cast<int64_t>(result.sequences[pair.sequence].frames);
      const int64_t first = std::max(back, pair.first - truth.tolerance_frames);
      const int64_t last = std::min(frames - 1, pair.last() + truth.tolerance_frames);
      for (int64_t reference = first; reference <= last; ++reference) {
        cv::Vec3b& at = pixel(image, window, pair.sequence, static_cast<size_t>(reference - back));
        const bool is_pair = pair.first <= reference && reference <= pair.last();
        if (at != colour) at = is_pair ? colour : blend(at, colour);
      }
    }
  }
}

void MatrixPicture::write(OutputFile& file, const SequenceResult& result, const GroundTruth* truth,
                          const Monitor& monitor) const {
  cv::Mat image = grey_image();
  std::set<Meaning> shown;
  if (truth != nullptr) {
    draw_truth(image, result, *truth, monitor);
    shown.insert(Meaning::truth);
  }
  for (const Cell& hit : result.hits) {
    check_stop(monitor);
    const Meaning meaning = meaning_of(result, hit, truth);
    pixel(image, hit.query_window, hit.sequence, hit.train_window) = bgr_of(meaning);
    shown.insert(meaning);
  }
  for (const size_t column : layout_.first_column)
    if (column > 0 && column < layout_.cols)
      image.col(static_cast<int>(column / scale_)).setTo(bgr_of(Meaning::divider));
  const size_t side = std::max(pixels_->rows, pixels_->cols);
  const auto enlarge = static_cast<double>((kFewestPixels + side - 1) / side);
  cv::resize(image, image, {}, enlarge, enlarge, cv::INTER_NEAREST);
  const ScoreLayout layout = layout_of(result);
  PictureFrame frame{column_bands(layout), row_bands(layout),
                     enlarge / static_cast<double>(scale_)};
  frame.shown.assign(shown.begin(), shown.end());
  if (const auto found = range()) {
    const auto value = [&](uint32_t biased) {
      return static_cast<double>(int64_t{biased} - layout_.score_offset);
    };
    frame.greys = std::pair(value(found->first), value(found->second));
  }
  frame.grey_words = score_kind(result.settings.score).title;
  write_png(file, framed(image, frame));
}

}  // namespace vpr
