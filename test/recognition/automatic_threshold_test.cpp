#include "recognition/automatic_threshold.h"

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "matching/plain.h"
#include "support.h"

using namespace vpr;

namespace {

using Sequences = std::vector<std::vector<LdbCode>>;

std::vector<CodeSpan> spans_of(const Sequences& sequences) {
  std::vector<CodeSpan> spans;
  for (const auto& codes : sequences) spans.push_back({codes, {}});
  return spans;
}

std::vector<std::optional<ClosestWindows>> slow_closest(const Sequences& sequences, size_t length) {
  std::vector<std::optional<ClosestWindows>> closest(sequences.size());
  for (size_t a = 0; a < sequences.size(); ++a)
    for (size_t i = 0; i + length <= sequences[a].size(); ++i)
      for (size_t b = 0; b < sequences.size(); ++b)
        for (size_t j = 0; a != b && j + length <= sequences[b].size(); ++j) {
          const uint32_t d = plain_window_distance(sequences[a], i, sequences[b], j, length);
          if (!closest[a] || d < closest[a]->distance) closest[a] = ClosestWindows{d, i, b, j};
        }
  return closest;
}

bool same(const std::optional<ClosestWindows>& a, const std::optional<ClosestWindows>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->distance == b->distance && a->window == b->window &&
         a->other_sequence == b->other_sequence && a->other_window == b->other_window;
}

TrainSequence named(const std::string& name, size_t frames) {
  TrainSequence sequence;
  sequence.name = name;
  for (size_t i = 0; i < frames; ++i) sequence.frame_names.push_back(std::to_string(i) + ".png");
  return sequence;
}

}  // namespace

TEST_CASE("the closest windows are those of all against all others") {
  Sequences sequences = {test::walk_codes(30, 1), test::walk_codes(5, 2), test::walk_codes(25, 3),
                         test::walk_codes(40, 4)};
  std::copy_n(sequences[0].begin() + 4, 8, sequences[3].begin() + 20);  // ties at distance 0
  for (const size_t threads : {1, 3}) {
    const ThreadLimit limit(threads);
    for (const HammingKernels& kernels : test::all_kernels()) {
      for (const size_t length : {1, 4, 8, 26, 41}) {
        const auto found =
            find_closest_windows(spans_of(sequences), {length, size_t{1} << 30, kernels}, {});
        const auto expected = slow_closest(sequences, length);
        for (size_t s = 0; s < sequences.size(); ++s) {
          INFO("sequence " << s << ", c_l " << length);
          CHECK(same(found[s], expected[s]));
        }
      }
    }
  }
}

TEST_CASE("a single sequence has no automatic threshold") {
  const Sequences one = {test::walk_codes(30, 1)};
  CHECK_FALSE(find_closest_windows(spans_of(one), {3, size_t{1} << 30, select_kernels()}, {})
                  .at(0)
                  .has_value());
}

TEST_CASE("the automatic threshold is in bits a frame, times the safety factor") {
  CHECK(automatic_threshold({500, 0, 0, 0}, 4, 0.8) == 100);
}

TEST_CASE("sequences closer than half the median are named, each pair once, with their frames") {
  const std::vector<TrainSequence> sequences = {named("a", 9), named("b", 9), named("c", 9),
                                                named("d", 9), named("e", 9)};
  const ThresholdTable fine{
      2,
      1,
      {ClosestWindows{600, 0, 1, 0}, ClosestWindows{600, 0, 0, 0}, ClosestWindows{300, 0, 0, 0},
       ClosestWindows{630, 0, 0, 0}, ClosestWindows{660, 0, 0, 0}}};
  CHECK(overlap_warnings(fine, sequences).empty());  // exactly half is no warning
  ThresholdTable close = fine;
  close.closest[2] = ClosestWindows{299, 3, 4, 5};
  CHECK(overlap_warnings(close, sequences).size() == 1);
  const std::string text = overlap_warnings(close, sequences).front();
  CHECK(text.find("c and e") != std::string::npos);
  CHECK(text.find("c frames 3 to 4 (3.png to 4.png)") != std::string::npos);
  CHECK(text.find("e frames 5 to 6") != std::string::npos);
}

TEST_CASE("two sequences that overlap are named although the median is their own distance") {
  const std::vector<TrainSequence> sequences = {named("a", 9), named("b", 9)};
  const ThresholdTable same{2, 1, {ClosestWindows{20, 0, 1, 0}, ClosestWindows{20, 0, 0, 0}}};
  CHECK(overlap_warnings(same, sequences).size() == 1);
  const ThresholdTable other{2, 1, {ClosestWindows{600, 0, 1, 0}, ClosestWindows{600, 0, 0, 0}}};
  CHECK(overlap_warnings(other, sequences).empty());
}
