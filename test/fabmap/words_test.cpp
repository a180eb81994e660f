// Training of FAB-MAP: words, the Chow-Liu tree and the index of views.
#include <algorithm>
#include <cmath>
#include <set>

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "fabmap/chow_liu.h"
#include "fabmap/vocabulary.h"
#include "fabmap/word_clustering.h"
#include "reference/reference_words.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

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

std::vector<WordSet> random_frames(size_t frames, size_t words, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<WordSet> sets(frames);
  for (WordSet& set : sets)
    for (uint32_t q = 0; q < words; ++q)
      if (uniform_below(engine, 5 + q % 7) == 0) set.push_back(q);
  if (frames > 2) sets[1].clear();  // a frame without features
  return sets;
}

bool same_tree(const ChowLiuTree& a, const ChowLiuTree& b) {
  return a.parent == b.parent && a.p == b.p && a.p_given == b.p_given &&
         a.p_given_not == b.p_given_not;
}

}  // namespace

TEST_CASE("the nearest word equals the result of an exhaustive search, on every SIMD target") {
  for (const auto& [words, dims, points] : std::vector<std::tuple<int, int, int>>{
           {1, 1, 1}, {31, 3, 6}, {32, 64, 9}, {33, 61, 4}, {100, 128, 17}}) {
    const cv::Mat centers = random_floats(words, dims, 1);
    const cv::Mat rows = random_floats(points, dims, 2);
    const Vocabulary vocabulary = make_vocabulary(centers);
    const auto found = nearest_words(vocabulary, rows);
    for (int p = 0; p < points; ++p) {
      const auto distance = [&](int w) { return cv::norm(centers.row(w), rows.row(p)); };
      for (int w = 0; w < words; ++w)
        REQUIRE(distance(static_cast<int>(found[static_cast<size_t>(p)])) <= distance(w) + 1e-4);
    }
    for (const std::string& target : simd_targets()) {
      const ChosenTarget chosen(target);
      REQUIRE(nearest_words(vocabulary, rows) == found);
    }
  }
}

TEST_CASE("equal words: the lower one is nearest; no descriptors: no words") {
  const Vocabulary floats = make_vocabulary(cv::Mat(70, 5, CV_32F, cv::Scalar(2)));
  CHECK(quantize(floats, cv::Mat(3, 5, CV_32F, cv::Scalar(1))) == WordSet{0});
  CHECK(quantize(floats, cv::Mat(0, 5, CV_32F)).empty());
  const Vocabulary bits = make_vocabulary(cv::Mat(70, 61, CV_8U, cv::Scalar(2)));
  CHECK(quantize(bits, cv::Mat(3, 61, CV_8U, cv::Scalar(1))) == WordSet{0});
}

TEST_CASE("two clear clusters yield their means, for floats and for bits") {
  const cv::Mat floats = (cv::Mat_<float>(4, 1) << 0, 1, 10, 12);
  cv::Mat words = kmeans_words(floats, {2, 20, 1}, {});
  CHECK(std::set<float>{words.at<float>(0), words.at<float>(1)} == std::set<float>{0.5F, 11.0F});
  const cv::Mat bits =
      (cv::Mat_<uint8_t>(6, 1) << 0b0001, 0b0011, 0b0111, 0b11110000, 0b11110001, 0b11110011);
  words = kmeans_words(bits, {2, 20, 1}, {});
  CHECK(std::set<int>{words.at<uint8_t>(0), words.at<uint8_t>(1)} ==
        std::set<int>{0b0011, 0b11110001});
}

TEST_CASE("the same seed yields the same words for any threads and SIMD target") {
  for (const cv::Mat& points : {random_floats(900, 20, 1), random_bits(900, 32, 2)}) {
    const cv::Mat words = kmeans_words(points, {50, 8, 3}, {});
    CHECK_FALSE(same(words, kmeans_words(points, {50, 8, 4}, {})));
    for (const std::string& target : simd_targets()) {
      const ChosenTarget chosen(target);
      for (const size_t threads : {1, 3}) {
        const ThreadLimit limit(threads);
        REQUIRE(same(kmeans_words(points, {50, 8, 3}, {}), words));
      }
    }
  }
}

TEST_CASE("k-means with as many words as descriptors returns the descriptors, with duplicates") {
  const cv::Mat points = random_floats(10, 3, 1);
  CHECK(kmeans_words(points, {10, 5, 1}, {}).rows == 10);
  CHECK(kmeans_words(cv::Mat(10, 3, CV_32F, cv::Scalar(1)), {4, 5, 1}, {}).rows == 4);
}

TEST_CASE("more words than descriptors are an error with advice") {
  const std::string text = error_text([] { kmeans_words(random_floats(5, 2, 1), {6, 5, 1}, {}); });
  CHECK(has(text, "--words"));
}

TEST_CASE("radius clustering equals the reference implementation") {
  for (const double radius : {0.5, 1.0, 2.0}) {
    const cv::Mat points = random_floats(3000, 5, 4);
    CHECK(same(radius_words(points, radius, 10'000, {}), reference_radius_words(points, radius)));
  }
  const cv::Mat bits = random_bits(2500, 4, 5);
  CHECK(same(radius_words(bits, 9, 10'000, {}), reference_radius_words(bits, 9)));
}

TEST_CASE("radius clustering of a few points equals the result computed by hand") {
  const cv::Mat points = (cv::Mat_<float>(4, 1) << 0, 1, 1.5, 0.25);
  // 0 and 1.5 become centers (the distance of 1 to 0 is not above 1); 1 is nearer to 1.5.
  const cv::Mat words = radius_words(points, 1, 10, {});
  REQUIRE(words.rows == 2);
  CHECK(words.at<float>(0) == 0.125F);
  CHECK(words.at<float>(1) == 1.25F);
}

TEST_CASE("a radius larger than all distances yields one word") {
  const cv::Mat points = random_floats(50, 3, 6);
  CHECK(radius_words(points, 1e200, 10, {}).rows == 1);
  CHECK(reference_radius_words(points, 1e200).rows == 1);
}

TEST_CASE("radius clustering refuses input that yields no words, or too many") {
  const cv::Mat points = random_floats(100, 3, 6);
  CHECK(error_kind([&] { radius_words(points, 0, 10, {}); }) == ErrorKind::usage);
  CHECK(error_kind([&] { radius_words(points, 1e-9, 10, {}); }) == ErrorKind::usage);
  CHECK(error_kind([&] { radius_words(cv::Mat(0, 3, CV_32F), 1, 10, {}); }) == ErrorKind::usage);
}

TEST_CASE("mutual information equals values computed by hand") {
  // Two words that always occur together, in half of four frames.
  const double p = 0.98 * 0.5 + 0.01;
  const double expected = 0.5 * std::log(0.5 / (p * p)) * 2;
  CHECK(MutualInformation(4)(2, 2, 2) == Approx(expected));
  // Independent words: each of the four cells has a quarter of the frames.
  CHECK(MutualInformation(4)(2, 2, 1) == Approx(4 * 0.25 * std::log(0.25 / (p * p))).margin(1e-15));
}

TEST_CASE("a tree of three words equals the tree computed by hand") {
  // Words 1 and 2 occur together; word 0 occurs alone in one frame.
  const std::vector<WordSet> frames = {{1, 2}, {1, 2}, {0}, {}};
  const ChowLiuTree tree = train_chow_liu(frames, 3, {});
  CHECK(tree.parent[1] == 1);  // the smaller word of the best edge is the root
  CHECK(tree.parent[2] == 1);
  CHECK(tree.p[1] == Approx(0.98 * 0.5 + 0.01));
  CHECK(tree.p_given[1] == tree.p[1]);
  CHECK(tree.p_given[2] == Approx(0.99));
  CHECK(tree.p_given_not[2] == Approx(0.01));
}

TEST_CASE("a conditional whose condition never occurs has frequency 0") {
  const ChowLiuTree tree = train_chow_liu(std::vector<WordSet>{{0}, {0}}, 2, {});
  const size_t child = tree.parent[0] == 0 ? 1 : 0;
  CHECK((child == 1 ? tree.p_given_not[1] : tree.p_given[0]) == Approx(0.01));
}

TEST_CASE("a single word is its own root") {
  const ChowLiuTree tree = train_chow_liu(std::vector<WordSet>{{0}, {}}, 1, {});
  CHECK(tree.parent == std::vector<uint32_t>{0});
}

TEST_CASE(
    "the fast tree equals the reference implementation, with its ties, on every SIMD target") {
  for (const std::string& target : simd_targets()) {
    const ChosenTarget chosen(target);
    for (const auto& [frames, words] : std::vector<std::pair<size_t, size_t>>{
             {1, 2}, {5, 3}, {63, 17}, {64, 16}, {65, 40}, {200, 90}})
      for (uint64_t seed = 0; seed < 3; ++seed) {
        const auto sets = random_frames(frames, words, seed);
        REQUIRE(same_tree(train_chow_liu(sets, words, {}), reference_chow_liu(sets, words)));
      }
  }
}

TEST_CASE("an index lists the views of each word, computed by hand") {
  ViewWords views;
  views.add(std::vector<uint32_t>{0, 2});
  views.add(std::vector<uint32_t>{});
  views.add(std::vector<uint32_t>{2});
  const WordIndex index = make_word_index(views, 3);
  CHECK(index.offsets == std::vector<uint64_t>{0, 1, 1, 3});
  CHECK(index.lists == std::vector<uint16_t>{0, 0, 2});
  CHECK(is_valid_index(index));
}

TEST_CASE("views after the first block are listed by their index in their block") {
  RandomEngine engine(1);
  ViewWords views;
  for (size_t v = 0; v < 2 * kIndexBlock + 3; ++v)
    views.add(std::vector<uint32_t>{static_cast<uint32_t>(uniform_below(engine, 5))});
  const WordIndex index = make_word_index(views, 5);
  REQUIRE(is_valid_index(index));
  size_t listed = 0;
  for (size_t block = 0; block < 3; ++block) {
    for (uint32_t word = 0; word < 5; ++word) {
      for (const uint16_t v : index.list(block, word)) {
        REQUIRE(views.view(block * kIndexBlock + v)[0] == word);
        ++listed;
      }
    }
  }
  CHECK(listed == views.views());
}

TEST_CASE("an index with views out of range is not sound") {
  ViewWords views;
  views.add(std::vector<uint32_t>{0, 1});
  views.add(std::vector<uint32_t>{1});
  const WordIndex good = make_word_index(views, 2);
  REQUIRE(is_valid_index(good));
  WordIndex bad = good;
  bad.lists[0] = 2;
  CHECK(!is_valid_index(bad));
  bad = good;
  std::swap(bad.lists[1], bad.lists[2]);
  CHECK(!is_valid_index(bad));
  bad = good;
  bad.offsets[1] = 1'000'000;
  CHECK(!is_valid_index(bad));
  bad = good;
  bad.offsets.pop_back();
  CHECK(!is_valid_index(bad));
  bad = good;
  bad.offsets.back() += 1;
  CHECK(!is_valid_index(bad));
}
