// Runs FabMap2 of arrenglover/openfabmap, with the new place over all pretraining frames.
//
//   DRIVER check WORDS TREE PRETRAIN PLACES QUERIES OUT   posteriors, new place first (float64)
//   DRIVER time WORDS PLACES PER_FRAME PRETRAIN SECONDS   median milliseconds: likelihoods, whole
//   query
//
// TREE: 4 x WORDS float64; other files: one row of WORDS float32 per frame.
#include <algorithm>
#include <cfloat>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "fabmap.hpp"
#include "timing.h"

namespace {

class Program : public of2::FabMap2 {
 public:
  explicit Program(const cv::Mat& tree) : FabMap2(tree, 0.39, 0, SAMPLED | CHOW_LIU) {}
  void only_likelihoods(const cv::Mat& query) {
    std::vector<of2::IMatch> matches;
    getLikelihoods(query, testImgDescriptors, matches);
  }
};

cv::Mat read(const std::string& path, int columns, int type) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  const int rows = static_cast<int>(bytes.size() / (columns * CV_ELEM_SIZE(type)));
  return cv::Mat(rows, columns, type, const_cast<char*>(bytes.data())).clone();
}

cv::Mat random_frames(int frames, int words, int per_frame, std::mt19937& engine) {
  cv::Mat bow = cv::Mat::zeros(frames, words, CV_32F);
  for (int f = 0; f < frames; ++f)
    for (int w = 0; w < per_frame; ++w) bow.at<float>(f, static_cast<int>(engine() % words)) = 1;
  return bow;
}

// Every word hangs on a random earlier one and hardly depends on it, as in random frames.
cv::Mat random_tree(int words, int per_frame, std::mt19937& engine) {
  cv::Mat tree(4, words, CV_64F);
  for (int q = 0; q < words; ++q) {
    const double p = static_cast<double>(per_frame) / words;
    tree.at<double>(0, q) = q == 0 ? 0 : static_cast<double>(engine() % q);
    tree.at<double>(1, q) = p;
    tree.at<double>(2, q) = 1.2 * p;
    tree.at<double>(3, q) = 0.99 * p;
  }
  return tree;
}

}  // namespace

int main(int, char** argv) {
  const int words = std::stoi(argv[2]);
  if (std::string(argv[1]) == "check") {
    Program program(read(argv[3], words, CV_64F));
    program.addTraining(read(argv[4], words, CV_32F));
    program.add(read(argv[5], words, CV_32F));
    std::vector<of2::IMatch> matches;
    program.localize(read(argv[6], words, CV_32F), matches);
    std::ofstream out(argv[7], std::ios::binary);
    for (const of2::IMatch& match : matches)
      out.write(reinterpret_cast<const char*>(&match.match), 8);
    return 0;
  }
  const int per_frame = std::stoi(argv[4]);
  std::mt19937 engine(1);
  Program program(random_tree(words, per_frame, engine));
  program.addTraining(random_frames(std::stoi(argv[5]), words, per_frame, engine));
  program.add(random_frames(std::stoi(argv[3]), words, per_frame, engine));
  const cv::Mat queries = random_frames(20, words, per_frame, engine);
  const double seconds = std::stod(argv[6]);
  std::cout << median_ms(seconds, [&](int i) { program.only_likelihoods(queries.row(i % 20)); })
            << " ";
  std::cout << median_ms(seconds, [&](int i) {
    std::vector<of2::IMatch> matches;
    program.localize(queries.row(i % 20), matches);
  }) << "\n";
}
