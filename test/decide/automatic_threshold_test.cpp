#include "decide/automatic_threshold.h"

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "match/plain.h"
#include "support.h"

using namespace vpr;

namespace {

using Sequences = std::vector<std::vector<LdbCode>>;

std::vector<DescriptorSpan> spans_of(const Sequences& sequences) {
  std::vector<DescriptorSpan> spans;
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
      const RowKernels kernels = select_kernels();
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

TEST_CASE("the automatic threshold is in bits per frame, times the safety factor") {
  const AutomaticThreshold found = automatic_threshold(ClosestWindows{500, 0, 1, 0}, 400, 4, 0.8);
  CHECK(found.value == 100);
  CHECK_FALSE(found.is_largest);
}

TEST_CASE("if training sequences look different, a share of the typical distance is the limit") {
  CHECK(largest_threshold(400, 4) == Approx((1 - 0.65 / 2) * 400));
  CHECK(largest_threshold(400, 1) == Approx(0.35 * 400));
  const AutomaticThreshold far = automatic_threshold(ClosestWindows{2000, 0, 1, 0}, 400, 4, 0.5);
  CHECK(far.value == Approx(135));
  CHECK(far.is_largest);
  const AutomaticThreshold alone = automatic_threshold(std::nullopt, 400, 4, 1);
  CHECK(alone.value == Approx(270));
  CHECK(alone.is_largest);
}

TEST_CASE("a single sequence has no closest windows in another one") {
  const Sequences one = {test::walk_codes(30, 1)};
  const auto found =
      find_closest_windows(spans_of(one), {4, size_t{1} << 30, select_kernels()}, {});
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
        sum += plain_hamming(walk[i], walk[j]);
        ++count;
      }
    mean += sum / static_cast<double>(count) / static_cast<double>(walk.size());
  }
  CHECK(typical_distance({walk, {}}, {}) == Approx(mean));
}
