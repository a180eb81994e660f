#include <catch2/catch.hpp>

#include "present/explanation_report.h"
#include "present/palette.h"

using namespace vpr;

namespace {

bool shows(const cv::Mat& picture, Meaning meaning) {
  const cv::Vec3b color = bgr_of(meaning);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      if (picture.at<cv::Vec3b>(y, x) == color) return true;
  return false;
}

}  // namespace

TEST_CASE("words for and against a place have the palette's colors") {
  const cv::Mat gray(48, 64, CV_8U, cv::Scalar(128));
  const auto drawn = [&](bool speaks_for) {
    const MarkedImage image{gray, {{{32, 24}, 7, speaks_for}}, "frame"};
    return draw_word_pairs({{image, image}});
  };
  CHECK(shows(drawn(true), Meaning::right));
  CHECK_FALSE(shows(drawn(true), Meaning::wrong));
  CHECK(shows(drawn(false), Meaning::wrong));
  CHECK_FALSE(shows(drawn(false), Meaning::right));
}
