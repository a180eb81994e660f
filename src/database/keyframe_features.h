// Local features of keyframes, the evidence of the second witness.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

#include "base/enum_names.h"
#include "database/descriptor_rows.h"

namespace cv {
class Mat;
}

namespace vpr {

/// Kinds of local features of keyframes.
enum class Witness { none, orb };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Witness> = {"none", "orb"};

/// A feature of ORB: its bits, and its position in the image of working size (working_image).
struct LocalFeature {
  std::array<uint8_t, 32> bits = {};
  float x = 0;
  float y = 0;
};
static_assert(sizeof(LocalFeature) == 40 && std::is_trivially_copyable_v<LocalFeature>);

/// The number of features of a frame, at most.
inline constexpr size_t kMostFeatures = 150;

/// A gray image at the size at which features are found: reduced by the integer nearest to the
/// longer side / 320 pixels. May share the pixels of `gray`.
cv::Mat working_image(const cv::Mat& gray);

/// The strongest features of a working image, in an order that depends on the image only. None for
/// images that are too small for ORB.
std::vector<LocalFeature> find_local_features(const cv::Mat& working);

/// The features of some frames of a sequence or database, one frame after the other.
struct KeyframeFeatures {
  std::vector<uint32_t> frames;  ///< increasing
  std::vector<uint32_t> ends;    ///< of each frame's features in `all`
  std::vector<LocalFeature> all;

  void append(uint32_t frame, std::span<const LocalFeature> features);
  std::span<const LocalFeature> of(size_t keyframe) const;
  /// The number of frames up to this one: one past the keyframe that stands for it.
  size_t count_until(size_t frame) const;
};

/// Finds the features of a frame when they are needed.
using FeatureLookup = std::function<std::vector<LocalFeature>(size_t frame)>;

/// Chooses the frames that get features. Called with the descriptors of the readable frames of one
/// sequence, in order.
using FeatureChoice = std::function<bool(DescriptorRow)>;

/// The bits of features as rows of descriptors.
DescriptorRows bits_of(std::span<const LocalFeature> features);

}  // namespace vpr
