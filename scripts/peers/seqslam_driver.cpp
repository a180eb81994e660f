// Runs the CPU part of TimQuelch/seqslam with the settings of its config.json, except the
// velocities.
//
//   DRIVER REFERENCES QUERIES V_MIN V_MAX TRAJECTORIES OUT
//
// REFERENCES, QUERIES: lists of images. OUT: one line per query frame with the best reference frame
// (-1: none) and its score, smaller is better. Prints the seconds of preparing images and of
// matching.
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "seqslam.h"

namespace {

std::vector<seqslam::Mx> prepared(const char* list) {
  std::ifstream in(list);
  std::vector<cv::Mat> images;
  for (std::string path; std::getline(in, path);)
    images.push_back(cv::imread(path, cv::IMREAD_GRAYSCALE));
  return seqslam::convertToEigen(
      seqslam::contrastEnhancement(seqslam::resizeImages(images, {32, 64}), 20));
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

int main(int, char** argv) {
  const double start = seconds();
  const auto references = prepared(argv[1]), queries = prepared(argv[2]);
  const double ready = seconds();
  const seqslam::Mx enhanced =
      seqslam::cpu::enhanceDiffMx(seqslam::cpu::generateDiffMx(references, queries), 10);
  const seqslam::Mx scores = seqslam::cpu::sequenceSearch(enhanced, 30, std::stof(argv[3]),
                                                          std::stof(argv[4]), std::stoi(argv[5]));
  std::cout << ready - start << " " << seconds() - ready << "\n";
  std::ofstream out(argv[6]);
  for (long q = 0; q < scores.cols(); ++q) {
    long best = -1;  // cells without a whole trajectory stay 0
    for (long r = 0; r < scores.rows(); ++r)
      if (scores(r, q) != 0 && (best < 0 || scores(r, q) < scores(best, q))) best = r;
    out << best << " " << (best < 0 ? 0 : scores(best, q)) << "\n";
  }
}
