// Thumbnails as SeqSLAM compares them (Milford & Wyeth, ICRA 2012).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cv {
class Mat;
}

namespace vpr {

inline constexpr int kThumbnailWidth = 64;
inline constexpr int kThumbnailHeight = 32;
inline constexpr int kThumbnailPatch = 8;  ///< side of the squares that are normalised

/// Grey levels, row by row from the top.
using Thumbnail64 = std::array<uint8_t, size_t{kThumbnailWidth} * kThumbnailHeight>;

/// `grey`: 8 bits, one channel, at least 1x1. Shrunk to 64x32 by means of areas, then each of its
/// 32 squares of 8x8 pixels normalised by itself: 128 + 32 (p - mean) / deviation, rounded to the
/// nearest, a half to the even one, and cut off to [0, 255]; 128 where all pixels are the same.
/// Sums are whole numbers and the few operations behind them IEEE's: the same on every machine.
Thumbnail64 describe_thumbnail(const cv::Mat& grey);

}  // namespace vpr
