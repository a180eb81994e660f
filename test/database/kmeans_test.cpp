#include "database/kmeans.h"

#include <algorithm>
#include <set>

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/simd.h"
#include "database/radius_clustering.h"
#include "descriptors/vocabulary.h"
#include "reference/plain_words.h"
#include "support.h"

using namespace vpr;

namespace {

cv::Mat random_floats(int rows, int cols, uint64_t seed) {
  RandomEngine engine(seed);
  cv::Mat mat(rows, cols, CV_32F);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < cols; ++c)
      mat.at<float>(r, c) = static_cast<float>(uniform_unit(engine) + (r % 7));
  return mat;
}

cv::Mat random_bits(int rows, int bytes, uint64_t seed) {
  RandomEngine engine(seed);
  cv::Mat mat(rows, bytes, CV_8U);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < bytes; ++c) mat.at<uint8_t>(r, c) = static_cast<uint8_t>(engine());
  return mat;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::equal(a.data, a.data + a.total() * a.elemSize(), b.data);
}

}  // namespace

TEST_CASE("the nearest word is that of a search over all, on every SIMD target") {
  for (const auto& [words, dims, points] : std::vector<std::tuple<int, int, int>>{
           {1, 1, 1}, {31, 3, 6}, {32, 64, 9}, {33, 61, 4}, {100, 128, 17}}) {
    const cv::Mat centres = random_floats(words, dims, 1);
    const cv::Mat rows = random_floats(points, dims, 2);
    const Vocabulary vocabulary = make_vocabulary(centres);
    use_simd_target("");
    const auto found = nearest_words(vocabulary, rows);
    for (int p = 0; p < points; ++p) {
      const auto distance = [&](int w) { return cv::norm(centres.row(w), rows.row(p)); };
      for (int w = 0; w < words; ++w)
        REQUIRE(distance(static_cast<int>(found[static_cast<size_t>(p)])) <= distance(w) + 1e-4);
    }
    for (const std::string& target : simd_targets()) {
      use_simd_target(target);
      REQUIRE(nearest_words(vocabulary, rows) == found);
    }
  }
  use_simd_target("");
}

TEST_CASE("equal words: the lower one is nearest; no descriptors: no words") {
  const Vocabulary floats = make_vocabulary(cv::Mat(70, 5, CV_32F, cv::Scalar(2)));
  CHECK(quantise(floats, cv::Mat(3, 5, CV_32F, cv::Scalar(1))) == WordSet{0});
  CHECK(quantise(floats, cv::Mat(0, 5, CV_32F)).empty());
  const Vocabulary bits = make_vocabulary(cv::Mat(70, 61, CV_8U, cv::Scalar(2)));
  CHECK(quantise(bits, cv::Mat(3, 61, CV_8U, cv::Scalar(1))) == WordSet{0});
}

TEST_CASE("two clear clusters give their means, for floats and for bits") {
  const cv::Mat floats = (cv::Mat_<float>(4, 1) << 0, 1, 10, 12);
  cv::Mat words = kmeans_words(floats, {2, 20, 1}, {});
  CHECK(std::set<float>{words.at<float>(0), words.at<float>(1)} == std::set<float>{0.5F, 11.0F});
  const cv::Mat bits =
      (cv::Mat_<uint8_t>(6, 1) << 0b0001, 0b0011, 0b0111, 0b11110000, 0b11110001, 0b11110011);
  words = kmeans_words(bits, {2, 20, 1}, {});
  CHECK(std::set<int>{words.at<uint8_t>(0), words.at<uint8_t>(1)} ==
        std::set<int>{0b0011, 0b11110001});
}

TEST_CASE("the same seed gives the same words for any threads and SIMD target") {
  for (const cv::Mat& points : {random_floats(900, 20, 1), random_bits(900, 32, 2)}) {
    const cv::Mat words = kmeans_words(points, {50, 8, 3}, {});
    CHECK_FALSE(same(words, kmeans_words(points, {50, 8, 4}, {})));
    for (const std::string& target : simd_targets()) {
      use_simd_target(target);
      for (const size_t threads : {1, 3}) {
        const ThreadLimit limit(threads);
        REQUIRE(same(kmeans_words(points, {50, 8, 3}, {}), words));
      }
    }
    use_simd_target("");
  }
}

TEST_CASE("as many words as descriptors, and copies among them") {
  const cv::Mat points = random_floats(10, 3, 1);
  CHECK(kmeans_words(points, {10, 5, 1}, {}).rows == 10);
  CHECK(kmeans_words(cv::Mat(10, 3, CV_32F, cv::Scalar(1)), {4, 5, 1}, {}).rows == 4);
}

TEST_CASE("more words than descriptors are an error that says what to do") {
  const std::string text = test::error_text([] {
    kmeans_words(random_floats(5, 2, 1), {6, 5, 1}, {});
  });
  CHECK(text.find("--words") != std::string::npos);
}

TEST_CASE("radius clustering makes the words of the plain way") {
  for (const double radius : {0.5, 1.0, 2.0}) {
    const cv::Mat points = random_floats(3000, 5, 4);
    CHECK(same(radius_words(points, radius, 10'000, {}), plain_radius_words(points, radius)));
  }
  const cv::Mat bits = random_bits(2500, 4, 5);
  CHECK(same(radius_words(bits, 9, 10'000, {}), plain_radius_words(bits, 9)));
}

TEST_CASE("radius clustering, worked out by hand") {
  const cv::Mat points = (cv::Mat_<float>(4, 1) << 0, 1, 1.5, 0.25);
  // 0 and 1.5 become centres (1 is not farther than 1 from 0); 1 is nearer to 1.5.
  const cv::Mat words = radius_words(points, 1, 10, {});
  REQUIRE(words.rows == 2);
  CHECK(words.at<float>(0) == 0.125F);
  CHECK(words.at<float>(1) == 1.25F);
}

TEST_CASE("a radius larger than everything makes one word") {
  const cv::Mat points = random_floats(50, 3, 6);
  CHECK(radius_words(points, 1e200, 10, {}).rows == 1);
  CHECK(plain_radius_words(points, 1e200).rows == 1);
}

TEST_CASE("radius clustering refuses what makes no words, or too many") {
  const cv::Mat points = random_floats(100, 3, 6);
  CHECK(test::error_kind([&] { radius_words(points, 0, 10, {}); }) == ErrorKind::usage);
  CHECK(test::error_kind([&] { radius_words(points, 1e-9, 10, {}); }) == ErrorKind::usage);
  CHECK(test::error_kind([&] { radius_words(cv::Mat(0, 3, CV_32F), 1, 10, {}); }) ==
        ErrorKind::usage);
}
