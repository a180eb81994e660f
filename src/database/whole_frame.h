// Built-in descriptors of whole frames: LDB, thumbnail and HOG; and image preprocessing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "database/descriptor_rows.h"

namespace cv {
class Mat;
}

namespace vpr {

/// LDB as in ABLE-M: one binary code for the whole frame (Yang & Cheng, LDB; Arroyo et al.,
/// ABLE-M). `gray`: 8 bits, one channel, at least 1x1. Resized to 64x64, blurred, and cropped to
/// 60x60; then all pairs of cells of each grid, 2x2 to 5x5, are compared by mean intensity and by
/// horizontal and vertical gradient. Integer arithmetic only: the same on every machine.
LdbCode describe_ldb(const cv::Mat& gray);

/// Sums over the cells of a g x g grid of `window` (60x60, 8 bits), row-major: intensity, gradient
/// along columns and gradient along rows. `integral` is cv::integral of the window (61x61, 32
/// bits). Returns 3 * g * g values: all intensities, then all of each gradient.
std::array<std::array<int32_t, 25>, 3> ldb_cell_values(const cv::Mat& integral, int g);

/// `gray`: 8 bits, one channel, at least 1x1. Every output pixel is the mean of the area that it
/// covers, with partly covered pixels weighted by their overlap, rounded to nearest, ties up.
/// Integer arithmetic only: the same on every machine. A smaller image is enlarged by the same
/// rule.
cv::Mat shrink(const cv::Mat& gray, int width, int height);

inline constexpr int kThumbnailWidth = 64;
inline constexpr int kThumbnailHeight = 32;
inline constexpr int kThumbnailPatch = 8;  ///< side of the normalized squares

/// Gray levels, row by row from the top.
using Thumbnail64 = std::array<uint8_t, size_t{kThumbnailWidth} * kThumbnailHeight>;

/// The thumbnail that SeqSLAM compares (Milford & Wyeth, ICRA 2012). `gray`: 8 bits, one channel,
/// at least 1x1. Shrunk to 64x32 by area means; then each of its 32 squares of 8x8 pixels is
/// normalized separately: 128 + 32 (p - mean) / deviation, rounded to nearest, ties to even, and
/// clamped to [0, 255]; 128 if all pixels are equal. Sums are integers, and the few operations
/// after them follow IEEE 754: the same on every machine.
Thumbnail64 describe_thumbnail(const cv::Mat& gray);

/// Histograms of oriented gradients of the whole frame (Dalal & Triggs). `gray`: 8 bits, one
/// channel, at least 1x1. Resized to 64x64 (bilinear, bit-exact). Each pixel adds to the cells
/// (16x16 pixels) and directions (8 of 180 degrees) next to it. The 3 x 3 blocks of 2 x 2 cells
/// overlap by half; each is normalized to length 1, clipped at 0.2, and normalized again. Stored as
/// 8-bit integers (quantize_numbers); all zero for an image without gradients. Only sums, products,
/// quotients and roots of doubles in a fixed order: the same on every machine.
HogVector describe_hog(const cv::Mat& gray);

/// LDB and HOG of one frame, for the element type ldb_hog.
LdbHogRow describe_ldb_hog(const cv::Mat& gray);

/// Illumination invariance for color frames (McManus et al., as ABLE-M uses it). `bgr`: 8 bits,
/// three channels. Returns gray of the same size:
/// I = 0.5 + ln G - a ln B - (1 - a) ln R on channels in [0, 1], a = 0.47, ln 0 taken as 0; I below
/// 0 becomes 1; times 255, rounded half to even, saturated to 8 bits.
cv::Mat illumination_invariant(const cv::Mat& bgr);

}  // namespace vpr
