// A distance matrix as a picture, for people.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/output_file.h"
#include "ground_truth/ground_truth.h"
#include "report/matrix_file.h"

namespace vpr {

/// Dark is close. A pixel of a scaled-down picture shows the smallest distance that falls into it.
class MatrixPicture {
 public:
  explicit MatrixPicture(const MatrixLayout& layout);
  ~MatrixPicture();
  /// Takes part of a row, from any thread.
  void operator()(const DistanceRow& row);

  /// Writes a PNG: ground truth (if known) and hits (not judged where it is not) in the palette's
  /// colours, sequences divided by lines, axes that count frames, a legend and the scale of the
  /// greys.
  void write(OutputFile& file, const SequenceResult& result, const GroundTruth* truth,
             const Monitor& monitor) const;

 private:
  struct Pixels;

  /// The smallest and the largest distance; nothing where there is none.
  std::optional<std::pair<uint32_t, uint32_t>> range() const;
  cv::Mat grey_image() const;
  cv::Vec3b& pixel(cv::Mat& image, size_t window, size_t sequence, size_t train_window) const;
  void draw_truth(cv::Mat& image, const SequenceResult& result, const GroundTruth& truth,
                  const Monitor& monitor) const;

  MatrixLayout layout_;
  size_t scale_;  // cells a pixel
  std::unique_ptr<Pixels> pixels_;
};

}  // namespace vpr
