#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "chart/chart.h"
#include "fabmap/explanation_report.h"
#include "support.h"

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

TEST_CASE("an explanation sums the words that it does not list") {
  PlaceExplanation place;
  place.log_odds = 16.75;
  place.for_it = {{7, true, true, 3.5}, {9, true, true, 2}};
  place.against = {{4, true, false, -0.5}};
  const std::string text = explanation_text({5, 0.1, {place}});
  CHECK(test::has(text, "all other words"));
  CHECK(test::has(text, "+11.750"));
}

TEST_CASE("numbers of words do not cover each other") {
  const cv::Mat gray(48, 64, CV_8U, cv::Scalar(0));
  const auto drawn = [&](uint32_t words) {
    MarkedImage image{gray, {}, "frame"};
    for (uint32_t word = 0; word < words; ++word) image.points.push_back({{32, 24}, word, true});
    return draw_word_pairs({{image, {gray, {}, ""}}});
  };
  const double second = cv::norm(drawn(1), drawn(2));  // on the left
  CHECK(second > 500);
  CHECK(cv::norm(drawn(2), drawn(3)) < second / 2);  // a circle on circles
}

TEST_CASE("words for and against a place have the palette's colors") {
  const cv::Mat gray(48, 64, CV_8U, cv::Scalar(128));
  const auto drawn = [&](bool speaks_for) {
    const MarkedImage image{gray, {{{32, 24}, 7, speaks_for}}, "frame"};
    return draw_word_pairs({{image, image}});
  };
  CHECK(shows(drawn(true), Meaning::correct));
  CHECK_FALSE(shows(drawn(true), Meaning::incorrect));
  CHECK(shows(drawn(false), Meaning::incorrect));
  CHECK_FALSE(shows(drawn(false), Meaning::correct));
}
