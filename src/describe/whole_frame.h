// Descriptors of whole frames that are built in, beside LDB: thumbnail, HOG, and BRIEF and ORB of
// the centre; and what pictures go through before.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cv {
class Mat;
}

namespace vpr {

/// `grey`: 8 bits, one channel, at least 1x1. Every pixel of the picture that is returned is the
/// mean of the area that it covers, parts of pixels by their share, rounded to the nearest, a half
/// up: whole numbers only, the same on every machine. A smaller picture is enlarged by the same
/// rule.
cv::Mat shrink(const cv::Mat& grey, int width, int height);

inline constexpr int kThumbnailWidth = 64;
inline constexpr int kThumbnailHeight = 32;
inline constexpr int kThumbnailPatch = 8;  ///< side of the squares that are normalised

/// Grey levels, row by row from the top.
using Thumbnail64 = std::array<uint8_t, size_t{kThumbnailWidth} * kThumbnailHeight>;

/// A thumbnail as SeqSLAM compares them (Milford & Wyeth, ICRA 2012). `grey`: 8 bits, one channel,
/// at least 1x1. Shrunk to 64x32 by means of areas, then each of its
/// 32 squares of 8x8 pixels normalised by itself: 128 + 32 (p - mean) / deviation, rounded to the
/// nearest, a half to the even one, and cut off to [0, 255]; 128 where all pixels are the same.
/// Sums are whole numbers and the few operations behind them IEEE's: the same on every machine.
Thumbnail64 describe_thumbnail(const cv::Mat& grey);

/// Numbers of a descriptor: 31 x 31 blocks that overlap by half, of 2 x 2 cells with 8 directions.
inline constexpr size_t kHogLength = size_t{31} * 31 * 4 * 8;

/// Histograms of oriented gradients of the whole frame (Dalal & Triggs), as place recognition
/// describes frames by them (Zaffar et al., CoHOG). `grey`: 8 bits, one channel, at least 1x1.
/// Resized to 512x512 (bilinear, bit-exact) and
/// described by OpenCV's HOGDescriptor with cells of 16x16 pixels, then in whole numbers of 8 bits
/// (quantise_numbers); all zero where nothing has a gradient. OpenCV computes in float32: another
/// version, or another kind of processor, may round differently.
std::vector<int8_t> describe_hog(const cv::Mat& grey);

/// Illumination invariance for color frames (McManus et al., as ABLE-M uses it). `bgr`: 8 bits,
/// three channels. Returns grey of the same size:
/// I = 0.5 + ln G - a ln B - (1 - a) ln R on channels in [0, 1], a = 0.47, ln 0 taken as 0; I below
/// 0 becomes 1; times 255, rounded half to even, saturated to 8 bits.
cv::Mat illumination_invariant(const cv::Mat& bgr);

/// Binary codes of the frame's center, as local features have them: one keypoint in the middle of
/// the frame, made small enough that its patch is nearly all of it (OpenABLE, Arroyo et al. 2016).
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
