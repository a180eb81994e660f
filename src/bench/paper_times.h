// Times of the paper (Nowicki, Wietrzykowski, Skrzypczynski 2017), as data: facts to compare with.
#pragma once

#include <array>
#include <cstdint>

namespace vpr {

/// Table 6: FastABLE over OpenABLE, query of 1000 frames.
struct PaperSpeedUp {
  const char* device;
  uint64_t frames;
  uint64_t window_length;
  double ratio;
};

/// The phones that the paper measured on.
inline constexpr const char* kGalaxy = "Samsung Galaxy Note 3";
inline constexpr const char* kLenovo = "Lenovo S8-50";

/// The whole of table 6: each phone, number of frames and c_l.
inline constexpr std::array<PaperSpeedUp, 40> kPaperSpeedUps = {{
    {kGalaxy, 500, 20, 11.4},  {kGalaxy, 1000, 20, 9.8},  {kGalaxy, 2000, 20, 9.3},
    {kGalaxy, 4000, 20, 9.2},  {kGalaxy, 8000, 20, 9.2},  {kGalaxy, 500, 40, 22.3},
    {kGalaxy, 1000, 40, 19.5}, {kGalaxy, 2000, 40, 18.6}, {kGalaxy, 4000, 40, 18.2},
    {kGalaxy, 8000, 40, 18.2}, {kGalaxy, 500, 60, 32.5},  {kGalaxy, 1000, 60, 28.0},
    {kGalaxy, 2000, 60, 27.5}, {kGalaxy, 4000, 60, 27.1}, {kGalaxy, 8000, 60, 26.9},
    {kGalaxy, 500, 80, 40.5},  {kGalaxy, 1000, 80, 36.5}, {kGalaxy, 2000, 80, 36.2},
    {kGalaxy, 4000, 80, 35.6}, {kGalaxy, 8000, 80, 35.6}, {kLenovo, 500, 20, 15.3},
    {kLenovo, 1000, 20, 11.0}, {kLenovo, 2000, 20, 9.7},  {kLenovo, 4000, 20, 9.7},
    {kLenovo, 8000, 20, 9.5},  {kLenovo, 500, 40, 29.6},  {kLenovo, 1000, 40, 21.7},
    {kLenovo, 2000, 40, 19.2}, {kLenovo, 4000, 40, 19.2}, {kLenovo, 8000, 40, 18.7},
    {kLenovo, 500, 60, 42.3},  {kLenovo, 1000, 60, 31.2}, {kLenovo, 2000, 60, 28.1},
    {kLenovo, 4000, 60, 28.1}, {kLenovo, 8000, 60, 27.6}, {kLenovo, 500, 80, 52.2},
    {kLenovo, 1000, 80, 40.2}, {kLenovo, 2000, 80, 36.6}, {kLenovo, 4000, 80, 37.1},
    {kLenovo, 8000, 80, 36.5},
}};

/// Tables 5 and 7: milliseconds per query frame on Nordland, c_l 300.
struct PaperNordlandTime {
  const char* table;
  const char* what;
  const char* our_work;  ///< the timer that does the same
  std::array<double, 3> ms;
};

/// Frames of the databases to which the times of a row belong.
inline constexpr std::array<uint64_t, 3> kPaperNordlandFrames = {1000, 10'000, 100'000};

/// Milliseconds per query frame on the Nordland data, c_l 300, by database size.
inline constexpr std::array<PaperNordlandTime, 8> kPaperNordlandTimes = {{
    {"tab5", "OpenABLE, PC (laptop i5)", "openable", {169, 2273, 24476}},
    {"tab5", "OpenABLE, Samsung Galaxy Note 3", "openable", {627, 8593, 85480}},
    {"tab5", "OpenABLE, Lenovo S8-50", "openable", {366, 5069, 52103}},
    {"tab5", "exact, ABLE-M authors, i7 2.4 GHz", "openable", {23, 250, 2530}},
    {"tab5", "multi-probe LSH, ABLE-M authors", "lsh-level-2", {9.3, 170, 420}},
    {"tab7", "FastABLE, PC", "fastable-online", {1.6, 19, 205}},
    {"tab7", "FastABLE, Samsung Galaxy Note 3", "fastable-online", {5.6, 75, 751}},
    {"tab7", "FastABLE, Lenovo S8-50", "fastable-online", {3.6, 43, 442}},
}};

/// Milliseconds per 640x480 frame.
struct PaperFrameTime {
  const char* what;
  const char* our_work;
  double ms;
};

/// What one frame of 640x480 pixels took the paper.
inline constexpr std::array<PaperFrameTime, 4> kPaperFrameTimes = {{
    {"SURF, Samsung Galaxy Note 3", "surf", 156 + 89},
    {"SURF, Lenovo S8-50", "surf", 92 + 89},
    {"resize to 64x64, device not stated", "resize", 0.48},
    {"resize and LDB, device not stated", "ldb", 0.48 + 0.44},
}};

}  // namespace vpr
