#include "fabmap/local_features.h"

#include <algorithm>

#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

#include "base/random.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

cv::Mat textured(int width, int height) {
  RandomEngine engine(4);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < width * height / 400; ++i)
    cv::rectangle(image,
                  cv::Rect(static_cast<int>(uniform_below(engine, uint64_t(width))),
                           static_cast<int>(uniform_below(engine, uint64_t(height))), 9, 7),
                  static_cast<double>(uniform_below(engine, 256)), cv::FILLED);
  return image;
}

FeatureSettings settings_of(size_t kind) {
  FeatureSettings settings;
  settings.kind = static_cast<FeatureKind>(kind);
  return settings;
}

}  // namespace

TEST_CASE("every kind finds features of its length and type, the same each time") {
  const cv::Mat image = textured(320, 240);
  for (size_t kind = 0; kind < kEnumNames<FeatureKind>.size(); ++kind) {
    const FeatureSettings settings = settings_of(kind);
    INFO(enum_name(settings.kind));
    const cv::Mat found = find_features(image, settings);
    CHECK(found.rows > 20);
    CHECK(found.cols == descriptor_length(settings.kind));
    CHECK(found.type() == (is_binary(settings.kind) ? CV_8U : CV_32F));
    const cv::Mat again = find_features(image, settings);
    CHECK(std::equal(found.datastart, found.dataend, again.datastart));
  }
}

TEST_CASE("images without features, and tiny ones, yield none, with the correct type") {
  for (size_t kind = 0; kind < kEnumNames<FeatureKind>.size(); ++kind) {
    for (const cv::Size size :
         {cv::Size(1, 1), cv::Size(2, 50), cv::Size(17, 16), cv::Size(64, 48)}) {
      const FeatureSettings settings = settings_of(kind);
      INFO(enum_name(settings.kind) << " " << size.width);
      const cv::Mat found = find_features(cv::Mat(size, CV_8UC1, cv::Scalar(90)), settings);
      CHECK(found.rows == 0);
      CHECK(found.cols == descriptor_length(settings.kind));
    }
  }
}

TEST_CASE("settings out of range are usage errors") {
  FeatureSettings settings;
  settings.sift_features = 0;
  CHECK(error_kind([&] { check_feature_settings(settings); }) == ErrorKind::usage);
}
