// Binary codes of the frame's centre, as local features have them: one keypoint in the middle of
// the frame, made small enough that its patch is nearly all of it (OpenABLE, Arroyo et al. 2016).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cv {
class Mat;
}

namespace vpr {

inline constexpr size_t kCentreBits = 256;

/// Bit b is in byte b / 8, least significant first.
using CentreCode = std::array<uint8_t, kCentreBits / 8>;

/// Two pixels that a bit of BRIEF compares, from the frame's centre.
struct BriefPair {
  int first_x = 0;
  int first_y = 0;
  int second_x = 0;
  int second_y = 0;
};

/// The pairs, drawn once with a fixed seed: all four numbers from a normal distribution of variance
/// S^2 / 25, with S = 48 the side of the patch, and cut off at its border.
const std::array<BriefPair, kCentreBits>& brief_pairs();

/// `grey`: 8 bits, one channel, at least 1x1. BRIEF (Calonder et al. 2010, test geometry II) of the
/// frame in 64x64 pixels (bilinear, bit-exact), blurred (9x9, sigma 2): a bit is set where the
/// first pixel of its pair is darker. All arithmetic is on integers.
CentreCode describe_brief(const cv::Mat& grey);

/// ORB (Rublee et al. 2011) by OpenCV of the frame in 128x128 pixels (bilinear, bit-exact), with
/// the keypoint at (65, 65), in the first octave and not turned, as OpenABLE places it; two pixels
/// a bit, within 31x31.
CentreCode describe_orb(const cv::Mat& grey);

}  // namespace vpr
