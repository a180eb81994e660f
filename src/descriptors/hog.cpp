#include "descriptors/hog.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include "descriptors/imported.h"

namespace vpr {

std::vector<int8_t> describe_hog(const cv::Mat& grey) {
  constexpr int kSide = 512;
  constexpr int kCell = 16;
  constexpr int kDirections = 8;
  const cv::HOGDescriptor hog({kSide, kSide}, {2 * kCell, 2 * kCell}, {kCell, kCell},
                              {kCell, kCell}, kDirections);
  cv::Mat square;
  cv::resize(grey, square, {kSide, kSide}, 0, 0, cv::INTER_LINEAR_EXACT);
  std::vector<float> values;
  hog.compute(square, values);
  std::vector<int8_t> numbers(kHogLength, 0);
  const std::vector<double> vector(values.begin(), values.end());
  if (std::any_of(vector.begin(), vector.end(), [](double value) { return value != 0; }))
    quantise_numbers(vector, std::span(numbers));
  return numbers;
}

}  // namespace vpr
