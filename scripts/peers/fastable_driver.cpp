// Replaces the main file of a copy of LRMPUT/FastABLE, whose CMake file builds it. Members are
// public there, and LDB is an empty class: codes come from files or are random.
//
//   DRIVER CONFIG check TRAIN QUERY BYTES C_L OPENABLE.f32 FASTABLE.f32   distances of all windows
//   DRIVER CONFIG time FRAMES BYTES C_L SECONDS                   median milliseconds per query
//   frame
//
// With -DOPENABLE it is the main file of a copy of roberto-arroyo/OpenABLE and only times: that
// program has no function for one query frame, so its distance is called for c_l frames per window.
#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "src/OpenABLE.h"
#include "timing.h"

namespace {

std::vector<cv::Mat> rows_of(const std::vector<uint8_t>& bytes, int width) {
  const cv::Mat all(static_cast<int>(bytes.size()) / width, width, CV_8U,
                    const_cast<uint8_t*>(bytes.data()));
  std::vector<cv::Mat> rows;
  for (int r = 0; r < all.rows; ++r) rows.push_back(all.row(r).clone());
  return rows;
}

std::vector<cv::Mat> random_rows(size_t count, int width, unsigned seed) {
  std::mt19937 engine(seed);
  std::vector<uint8_t> bytes(count * width);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(engine());
  return rows_of(bytes, width);
}

#ifndef OPENABLE
std::vector<cv::Mat> read_rows(const std::string& path, int width) {
  std::ifstream in(path, std::ios::binary);
  return rows_of({std::istreambuf_iterator<char>(in), {}}, width);
}

void check(OpenABLE& program, const std::vector<std::string>& words) {
  const int width = std::stoi(words[2]);
  program.compareLength = std::stoi(words[3]);
  std::vector<cv::Mat> open, fast;
  program.computeVisualPlaceRecognition({read_rows(words[0], width)}, read_rows(words[1], width),
                                        open, fast);
  const auto save = [](const cv::Mat& matrix, const std::string& path) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(matrix.data), static_cast<long>(matrix.total()) * 4);
  };
  save(open[0], words[4]);
  save(fast[0], words[5]);
}
#endif

}  // namespace

int main(int, char** argv) {
  OpenABLE program(argv[1]);
  const std::vector<std::string> words(argv + 3, argv + (std::string(argv[2]) == "time" ? 7 : 9));
#ifndef OPENABLE
  if (std::string(argv[2]) == "check") return check(program, words), 0;
#endif
  const int frames = std::stoi(words[0]), width = std::stoi(words[1]), length = std::stoi(words[2]);
  const double seconds = std::stod(words[3]);
  const std::vector<cv::Mat> train = random_rows(frames, width, 1),
                             query = random_rows(length + 200, width, 2);
#ifdef OPENABLE
  volatile int sum = 0;
  std::cout << median_ms(seconds, [&](int) {
    for (int i = length - 1; i < frames; ++i)
      for (int k = 0; k < length; ++k)
        sum = sum + program.hamming_matching(query[length - k], train[i - k]);
  }) << "\n";
#else
  program.compareLength = length;
  std::vector<int> sums(frames - length +
                        2);  // the first row is not timed: its values do not matter
  std::cout << median_ms(seconds, [&](int i) {
    program.fastABLE_matching(length + i % 200, query, train, sums, cv::Mat());
  }) << "\n";
#endif
}
