// Automatic thresholds, and warnings about overlapping training sequences.
#include "query/thresholds.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "reference/reference.h"
#include "support.h"

using namespace vpr;

namespace {

using Sequences = std::vector<std::vector<LdbCode>>;

std::vector<DescribedFrames> spans_of(const Sequences& sequences) {
  std::vector<DescribedFrames> spans;
  for (const auto& codes : sequences) spans.push_back({codes, {}});
  return spans;
}

std::vector<std::optional<ClosestWindows>> slow_closest(const Sequences& sequences, size_t length) {
  std::vector<std::optional<ClosestWindows>> closest(sequences.size());
  for (size_t a = 0; a < sequences.size(); ++a)
    for (size_t i = 0; i + length <= sequences[a].size(); ++i)
      for (size_t b = 0; b < sequences.size(); ++b)
        for (size_t j = 0; a != b && j + length <= sequences[b].size(); ++j) {
          const uint32_t d = reference_window_distance(sequences[a], i, sequences[b], j, length);
          if (!closest[a] || d < closest[a]->score) closest[a] = ClosestWindows{d, i, b, j};
        }
  return closest;
}

bool same(const std::optional<ClosestWindows>& a, const std::optional<ClosestWindows>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->score == b->score && a->window == b->window && a->other_sequence == b->other_sequence &&
         a->other_window == b->other_window;
}

}  // namespace

TEST_CASE("the closest windows equal those of comparing all sequences") {
  Sequences sequences = {test::walk_codes(30, 1), test::walk_codes(5, 2), test::walk_codes(25, 3),
                         test::walk_codes(40, 4)};
  std::copy_n(sequences[0].begin() + 4, 8, sequences[3].begin() + 20);  // ties at distance 0
  for (const size_t threads : {1, 3}) {
    const ThreadLimit limit(threads);
    for (const std::string& target : simd_targets()) {
      const test::ChosenTarget chosen(target);
      for (const size_t length : {1, 4, 8, 26, 41}) {
        const auto found = find_closest_windows(spans_of(sequences), {length, size_t{1} << 30}, {});
        const auto expected = slow_closest(sequences, length);
        for (size_t s = 0; s < sequences.size(); ++s) {
          INFO("sequence " << s << ", c_l " << length);
          CHECK(same(found[s], expected[s]));
        }
      }
    }
  }
}

TEST_CASE("the automatic threshold is the closest distance per frame, times the safety factor") {
  const ThresholdTable table{4, 0.8, {ClosestWindows{500, 0, 1, 0}, std::nullopt}};
  CHECK(automatic_threshold(table, 0) == 100);
  CHECK_FALSE(automatic_threshold(table, 1));
  const ThresholdTable far{4, 1, {ClosestWindows{4 * 1386, 0, 1, 0}}};
  CHECK(automatic_threshold(far, 0) == 1386);  // however different the sequences are
}

TEST_CASE("a single sequence has no closest windows in another one") {
  const Sequences one = {test::walk_codes(30, 1)};
  const auto found = find_closest_windows(spans_of(one), {4, size_t{1} << 30}, {});
  REQUIRE(found.size() == 1);
  CHECK_FALSE(found[0]);
}

TEST_CASE(
    "the typical distance is the mean between frames of one sequence that are not neighbors") {
  const std::vector<LdbCode> walk = test::walk_codes(40, 8, 100);
  double mean = 0;
  for (size_t i = 0; i < walk.size(); ++i) {
    double sum = 0;
    size_t count = 0;
    for (size_t j = 0; j < walk.size(); ++j)
      if (std::max(i, j) - std::min(i, j) > 5) {
        sum += reference_hamming(walk[i], walk[j]);
        ++count;
      }
    mean += sum / static_cast<double>(count) / static_cast<double>(walk.size());
  }
  CHECK(typical_distance({}, {walk, {}}, {}) == Approx(mean));
}

namespace {

TrainSequence named(const std::string& name, size_t frames) {
  TrainSequence sequence;
  sequence.sequence.name = name;
  for (size_t i = 0; i < frames; ++i)
    sequence.sequence.frame_names.push_back(std::to_string(i) + ".png");
  return sequence;
}

std::string warning_of(const std::vector<std::vector<LdbCode>>& walks, size_t length) {
  std::vector<DescribedFrames> spans;
  std::vector<TrainSequence> sequences;
  for (const auto& walk : walks) {
    spans.push_back({walk, {}});
    sequences.push_back(
        named(std::string(1, static_cast<char>('a' + sequences.size())), walk.size()));
  }
  const ThresholdTable table{length, 1, find_closest_windows(spans, {length, size_t{1} << 30}, {})};
  return overlap_warning(table, sequences, spans).value_or("");
}

}  // namespace

TEST_CASE("mean distances of sets of codes are computed from counted bits") {
  std::vector<LdbCode> codes(3, LdbCode{});
  codes[0][0] = 3;
  codes[1][0] = 1;
  const DescribedFrames all{codes, {}};
  const DescribedFrames first{all.rows.first(1), {}};
  const DescribedFrames rest{all.rows.subspan(1, 2), {}};
  CHECK(mean_distance_between(frame_distances({&first, 1}, rest)) == 1.5);
  CHECK(mean_distance_between(frame_distances({&first, 1}, {})) == 0);
  const FrameDistances within = frame_distances({&all, 1}, all);
  CHECK(mean_distance_within(within) == Approx(4 / 3.0));
  CHECK(mean_distance_within(frame_distances({&first, 1}, first)) == 0);
}

TEST_CASE("a longer diagonal is significant at a larger distance") {
  CHECK(is_same_place(218, 400, 7));
  CHECK_FALSE(is_same_place(218, 400, 6));
  CHECK_FALSE(is_same_place(0, 400, 1));
}

TEST_CASE("two sequences of one place are reported with their frames") {
  std::vector<std::vector<LdbCode>> walks = {test::walk_codes(60, 1, 150),
                                             test::walk_codes(60, 2, 150)};
  CHECK(warning_of(walks, 10).empty());
  std::copy_n(walks[0].begin() + 20, 15, walks[1].begin() + 40);
  const std::string warning = warning_of(walks, 10);
  CHECK(warning.find("a and b seem to show the same place, or places that look alike") == 0);
  CHECK(test::has(warning, "a frames 20 to 29 (20.png to 29.png)"));
  CHECK(test::has(warning, "b frames 40 to 49"));
  CHECK(test::has(warning, "Train only one of them, or use --method filter"));
  CHECK_FALSE(test::has(warning, "so do"));  // the pair once, not once per sequence
}

TEST_CASE("all overlapping pairs are one warning, which names the first three") {
  std::vector<std::vector<LdbCode>> walks;
  for (uint64_t w = 0; w < 10; ++w) walks.push_back(test::walk_codes(60, w + 1, 150));
  for (size_t w = 0; w < 10; w += 2) std::copy_n(walks[w].begin(), 30, walks[w + 1].begin() + 30);
  const std::string warning = warning_of(walks, 10);
  CHECK(warning.find("a and b seem to show the same place") == 0);
  CHECK(test::has(warning, "; so do c and d: c frames"));
  CHECK(test::has(warning, "; so do e and f: e frames"));
  CHECK_FALSE(test::has(warning, "g and h"));
  CHECK(test::has(warning, "; and so do 2 other pairs. If it is one place"));
}
