// Local features of a frame, the input of FAB-MAP's visual words.
#pragma once

#include <array>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "base/enum_names.h"
#include "base/json_fwd.h"

namespace vpr {

/// Kinds of local features: a detector with a descriptor.
enum class FeatureKind { surf, sift, kaze, akaze, orb, brisk };
template <>
inline constexpr std::array<std::string_view, 6> kEnumNames<FeatureKind> = {
    "surf", "sift", "kaze", "akaze", "orb", "brisk"};

/// Settings of all kinds; only those of `kind` are used.
struct FeatureSettings {
  FeatureKind kind = FeatureKind::surf;
  int64_t surf_points = 1000;
  double surf_threshold = 30;
  int64_t sift_features = 400;
  double sift_contrast = 0.04;
  double kaze_threshold = 0.001;
  double akaze_threshold = 0.001;
  int64_t orb_features = 500;
  int64_t brisk_threshold = 30;
};

template <class Visitor>
void visit_fields(FeatureSettings& settings, Visitor&& visit) {
  visit("features", settings.kind, "Local features.");
  visit("surf_points", settings.surf_points, "Most per frame.", at_least(0));
  visit("surf_threshold", settings.surf_threshold, "Threshold of dlib's SURF detector.");
  visit("sift_features", settings.sift_features, "Most per frame.", at_least(0));
  visit("sift_contrast", settings.sift_contrast, "Contrast threshold of SIFT.");
  visit("kaze_threshold", settings.kaze_threshold, "Detector threshold of KAZE.");
  visit("akaze_threshold", settings.akaze_threshold, "Detector threshold of AKAZE.");
  visit("orb_features", settings.orb_features, "Most per frame.", at_least(0));
  visit("brisk_threshold", settings.brisk_threshold, "Detector threshold.", at_least(0));
}

/// Checks the settings of every kind. Throws Error(usage) for a value out of range.
void check_feature_settings(const FeatureSettings& settings);

/// Whether descriptors are bit strings, compared by Hamming distance.
bool is_binary(FeatureKind kind);

/// Bytes (binary) or floats per descriptor.
int descriptor_length(FeatureKind kind);

/// The descriptors of one frame, one row per feature: CV_32F (surf 64, sift 128, kaze 64) or CV_8U
/// (akaze 61, orb 32, brisk 64 bytes of bits). No rows if the frame has no features or is too
/// small. `gray`: 8 bits, one channel. The result depends only on the image and the settings.
cv::Mat find_features(const cv::Mat& gray, const FeatureSettings& settings);

}  // namespace vpr
