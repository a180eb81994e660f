#include "fabmap/local_features.h"

#include <algorithm>

#include <dlib/array2d.h>
#include <dlib/image_keypoint/surf.h>
#include <dlib/opencv/cv_image.h>
#include <opencv2/features2d.hpp>

#include "base/error.h"

namespace vpr {
namespace {

constexpr int kSmallestSide = 16;  // OpenCV's pyramids fail for smaller images

cv::Mat find_surf(const cv::Mat& gray, const FeatureSettings& settings) {
  const dlib::cv_image<unsigned char> image(gray);
  const auto points = dlib::get_surf_points(image, settings.surf_points, settings.surf_threshold);
  cv::Mat found(static_cast<int>(points.size()), 64, CV_32F);
  for (size_t i = 0; i < points.size(); ++i)
    for (int d = 0; d < 64; ++d)
      found.at<float>(static_cast<int>(i), d) = static_cast<float>(points[i].des(d));
  return found;
}

cv::Mat find_with(cv::Feature2D& detector, const cv::Mat& gray) {
  std::vector<cv::KeyPoint> points;
  cv::Mat found;
  detector.detectAndCompute(gray, cv::noArray(), points, found);
  return found;
}

/// Row i is FeatureKind i.
struct KindRow {
  bool binary;
  int length;
  cv::Mat (*find)(const cv::Mat&, const FeatureSettings&);
};

constexpr std::array<KindRow, 6> kKinds = {{
    {false, 64, find_surf},
    {false, 128,
     [](const cv::Mat& gray, const FeatureSettings& s) {
       return find_with(*cv::SIFT::create(static_cast<int>(s.sift_features), 3, s.sift_contrast),
                        gray);
     }},
    {false, 64,
     [](const cv::Mat& gray, const FeatureSettings& s) {
       return find_with(*cv::KAZE::create(false, false, static_cast<float>(s.kaze_threshold)),
                        gray);
     }},
    {true, 61,
     [](const cv::Mat& gray, const FeatureSettings& s) {
       return find_with(*cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3,
                                           static_cast<float>(s.akaze_threshold)),
                        gray);
     }},
    {true, 32,
     [](const cv::Mat& gray, const FeatureSettings& s) {
       return find_with(*cv::ORB::create(static_cast<int>(s.orb_features)), gray);
     }},
    {true, 64,
     [](const cv::Mat& gray, const FeatureSettings& s) {
       return find_with(*cv::BRISK::create(static_cast<int>(s.brisk_threshold)), gray);
     }},
}};

const KindRow& row_of(FeatureKind kind) { return kKinds[static_cast<size_t>(kind)]; }

}  // namespace

void check_feature_settings(const FeatureSettings& settings) {
  require_range("surf_points", static_cast<double>(settings.surf_points), 1, 1e6);
  require_range("surf_threshold", settings.surf_threshold, 0, 1e9);
  require_range("sift_features", static_cast<double>(settings.sift_features), 1, 1e6);
  require_range("sift_contrast", settings.sift_contrast, 0, 10);
  require_range("kaze_threshold", settings.kaze_threshold, 0, 1);
  require_range("akaze_threshold", settings.akaze_threshold, 0, 1);
  require_range("orb_features", static_cast<double>(settings.orb_features), 1, 1e6);
  require_range("brisk_threshold", static_cast<double>(settings.brisk_threshold), 1, 255);
}

bool is_binary(FeatureKind kind) { return row_of(kind).binary; }

int descriptor_length(FeatureKind kind) { return row_of(kind).length; }

cv::Mat find_features(const cv::Mat& gray, const FeatureSettings& settings) {
  cv::Mat found;
  if (std::min(gray.rows, gray.cols) >= kSmallestSide)
    found = row_of(settings.kind).find(gray, settings);
  if (found.empty())
    found.create(0, descriptor_length(settings.kind), is_binary(settings.kind) ? CV_8U : CV_32F);
  return found;
}

}  // namespace vpr
