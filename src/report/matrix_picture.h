// A distance matrix as a picture, for people.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/output_file.h"
#include "evaluation/ground_truth.h"
#include "report/matrix_file.h"

namespace vpr {

/// Dark is close. A pixel of a scaled-down picture shows the smallest distance that falls into it.
class MatrixPicture {
 public:
  explicit MatrixPicture(const MatrixLayout& layout);
  ~MatrixPicture();
  /// Takes part of a row, from any thread.
  void operator()(const DistanceRow& row);

  /// Writes a PNG: ground truth (if known) in green; hits orange, or, where the ground truth is
  /// known, blue if correct and red if not (grey-blue if ignored). Sequences are divided by lines.
  /// The caller commits.
  OutputFile write(const std::filesystem::path& path, Existing existing,
                   const SequenceResult& result, const GroundTruth* truth) const;

 private:
  struct Pixels;

  cv::Mat grey_image() const;
  cv::Vec3b& pixel(cv::Mat& image, size_t window, size_t sequence, size_t train_window) const;
  void draw_truth(cv::Mat& image, const SequenceResult& result, const GroundTruth& truth) const;

  MatrixLayout layout_;
  size_t scale_;  // cells a pixel
  std::unique_ptr<Pixels> pixels_;
};

}  // namespace vpr
