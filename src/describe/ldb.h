// LDB as in ABLE-M: one binary code for a whole frame (Yang & Cheng, LDB; Arroyo et al., ABLE-M).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cv {
class Mat;
}

namespace vpr {

/// Bits per code: 3 for every pair of cells of the grids 2x2 to 5x5.
inline constexpr size_t kLdbBits = 1386;
inline constexpr size_t kLdbBytes =
    176;  ///< bit b in byte b / 8, least significant first, 0-padded

/// A code of LDB (Yang & Cheng 2012): 176 bytes, the last 22 bits are 0.
using LdbCode = std::array<uint8_t, kLdbBytes>;

/// `gray`: 8 bits, one channel, at least 1x1. Resized to 64x64, blurred, and cropped to 60x60; then
/// all pairs of cells of each grid, 2x2 to 5x5, are compared by mean intensity and by horizontal
/// and vertical gradient. Integer arithmetic only: the same on every machine.
LdbCode describe_ldb(const cv::Mat& gray);

/// Sums over the cells of a g x g grid of `window` (60x60, 8 bits), row-major: intensity, gradient
/// along columns and gradient along rows. `integral` is cv::integral of the window (61x61, 32
/// bits). Returns 3 * g * g values: all intensities, then all of each gradient.
std::array<std::array<int32_t, 25>, 3> ldb_cell_values(const cv::Mat& integral, int g);

}  // namespace vpr
