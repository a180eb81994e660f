// Warnings about training sequences of the same place.
#include <algorithm>

#include <catch2/catch.hpp>

#include "decide/automatic_margin.h"
#include "decide/automatic_threshold.h"
#include "support.h"

using namespace vpr;

namespace {

TrainSequence named(const std::string& name, size_t frames) {
  TrainSequence sequence;
  sequence.sequence.name = name;
  for (size_t i = 0; i < frames; ++i)
    sequence.sequence.frame_names.push_back(std::to_string(i) + ".png");
  return sequence;
}

std::string warning_of(const std::vector<std::vector<LdbCode>>& walks, size_t length) {
  std::vector<DescriptorSpan> spans;
  std::vector<TrainSequence> sequences;
  for (const auto& walk : walks) {
    spans.push_back({walk, {}});
    sequences.push_back(
        named(std::string(1, static_cast<char>('a' + sequences.size())), walk.size()));
  }
  const ThresholdTable table{
      length, 1, find_closest_windows(spans, {length, size_t{1} << 30, select_kernels()}, {})};
  return overlap_warning(table, sequences, spans).value_or("");
}

}  // namespace

TEST_CASE("mean distances of sets of codes are computed from counted bits") {
  std::vector<LdbCode> codes(3, LdbCode{});
  codes[0][0] = 3;
  codes[1][0] = 1;
  const DescriptorSpan all{codes, {}};
  const DescriptorSpan first{all.rows.first(1), {}};
  const DescriptorSpan rest{all.rows.subspan(1, 2), {}};
  CHECK(mean_distance_between(frame_distances({&first, 1}, rest)) == 1.5);
  CHECK(mean_distance_between(frame_distances({&first, 1}, {})) == 0);
  const FrameDistances within = frame_distances({&all, 1}, all);
  CHECK(mean_distance_within(within) == Approx(4 / 3.0));
  CHECK(mean_distance_within(frame_distances({&first, 1}, first)) == 0);
}

TEST_CASE("a longer diagonal is significant at a larger distance") {
  CHECK(is_same_place(218, 400, 7, kPairDepth));
  CHECK_FALSE(is_same_place(218, 400, 6, kPairDepth));
  CHECK(is_same_place(199, 400, 4, kOwnDepth));
  CHECK_FALSE(is_same_place(200, 400, 4, kOwnDepth));
  CHECK_FALSE(is_same_place(0, 400, 1, kOwnDepth));
}

TEST_CASE("two sequences of one place are reported with their frames") {
  std::vector<std::vector<LdbCode>> walks = {test::walk_codes(60, 1, 150),
                                             test::walk_codes(60, 2, 150)};
  CHECK(warning_of(walks, 10).empty());
  std::copy_n(walks[0].begin() + 20, 15, walks[1].begin() + 40);
  const std::string warning = warning_of(walks, 10);
  CHECK(warning.find("a and b seem to show the same place, or places that look alike") == 0);
  CHECK(warning.find("a frames 20 to 29 (20.png to 29.png)") != std::string::npos);
  CHECK(warning.find("b frames 40 to 49") != std::string::npos);
  CHECK(warning.find("Train only one of them, or use --method filter") != std::string::npos);
  CHECK(warning.find("so do") == std::string::npos);  // the pair once, not once per sequence
}

TEST_CASE("among many sequences, only the overlapping pairs are reported") {
  std::vector<std::vector<LdbCode>> walks;
  for (uint64_t w = 0; w < 5; ++w) walks.push_back(test::walk_codes(60, w + 1, 150));
  std::copy_n(walks[2].begin(), 30, walks[4].begin() + 30);
  const std::string warning = warning_of(walks, 10);
  CHECK(warning.find("c and e") == 0);
  CHECK(warning.find("so do") == std::string::npos);
}

TEST_CASE("all overlapping pairs are one warning, which names the first three") {
  std::vector<std::vector<LdbCode>> walks;
  for (uint64_t w = 0; w < 10; ++w) walks.push_back(test::walk_codes(60, w + 1, 150));
  for (size_t w = 0; w < 10; w += 2) std::copy_n(walks[w].begin(), 30, walks[w + 1].begin() + 30);
  const std::string warning = warning_of(walks, 10);
  CHECK(warning.find("a and b seem to show the same place") == 0);
  CHECK(warning.find("; so do c and d: c frames") != std::string::npos);
  CHECK(warning.find("; so do e and f: e frames") != std::string::npos);
  CHECK(warning.find("g and h") == std::string::npos);
  CHECK(warning.find("; and so do 2 other pairs. If it is one place") != std::string::npos);
}
