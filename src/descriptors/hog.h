// Histograms of oriented gradients of the whole frame (Dalal & Triggs), as place recognition
// describes frames by them (Zaffar et al., CoHOG).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cv {
class Mat;
}

namespace vpr {

/// Numbers of a descriptor: 31 x 31 blocks that overlap by half, of 2 x 2 cells with 8 directions.
inline constexpr size_t kHogLength = size_t{31} * 31 * 4 * 8;

/// `grey`: 8 bits, one channel, at least 1x1. Resized to 512x512 (bilinear, bit-exact) and
/// described by OpenCV's HOGDescriptor with cells of 16x16 pixels, then in whole numbers of 8 bits
/// (quantise_numbers); all zero where nothing has a gradient. OpenCV computes in float32: another
/// version, or another kind of processor, may round differently.
std::vector<int8_t> describe_hog(const cv::Mat& grey);

}  // namespace vpr
