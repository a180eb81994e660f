#include <random>

#include <catch2/catch.hpp>

#include "truth/ground_truth.h"

using namespace vpr;

namespace {

Selection kept_of(size_t recorded, std::vector<uint32_t> sources) {
  Selection kept;
  kept.recorded_frames = recorded;
  kept.sources = std::move(sources);
  kept.selected_fps = 5;
  return kept;
}

std::string letters(const GroundTruth& truth, size_t sequence, size_t frames) {
  std::string text;
  for (size_t r = 0; r < frames; ++r)
    text += ".si"[static_cast<size_t>(truth.label(0, sequence, r))];
  return text;
}

// Converts labels of a recording's frames, as letters, to labels of selected frames.
std::string plainly_kept(const std::string& recorded, const std::vector<uint32_t>& sources) {
  std::string text;
  for (const uint32_t source : sources) text += recorded[source];
  for (size_t first = 0; first < recorded.size(); ++first) {
    if (recorded[first] != 's' || (first > 0 && recorded[first - 1] == 's')) continue;
    size_t last = first;
    while (last + 1 < recorded.size() && recorded[last + 1] == 's') ++last;
    size_t best = 0;
    size_t away = recorded.size();
    for (size_t k = 0; k < sources.size(); ++k) {
      const size_t distance = sources[k] < first  ? first - sources[k]
                              : sources[k] > last ? sources[k] - last
                                                  : 0;
      if (distance < away) away = distance, best = k;
    }
    if (away > 0) text[best] = 's';
  }
  return text;
}

}  // namespace

TEST_CASE("selected frames keep their labels, and a place without any moves to the nearest one") {
  GroundTruth truth;
  // The same place: frames 1 to 3 with the tolerance, and 7; ignored: 5, 8 and 9.
  truth.pairs = {
      {{0, 2, PlaceLabel::same, 0}, {0, 5, PlaceLabel::ignore, 0}, {0, 8, PlaceLabel::ignore, 1}}};
  truth.tolerance_frames = 1;
  GroundTruthScope scope{{"", 1}, {{"a", 4}}};
  SECTION("inside") {
    scope.sequences[0].sequence.selection = kept_of(10, {0, 3, 5, 9});
    select_train_frames(truth, scope);
    CHECK(letters(truth, 0, 4) == ".sii");
  }
  SECTION("adjacent, and the earlier one on a tie") {
    scope.sequences[0].sequence.selection = kept_of(10, {0, 4, 6, 7});
    select_train_frames(truth, scope);
    CHECK(letters(truth, 0, 4) == "s...");
  }
  SECTION("after the last one") {
    scope.sequences[0].sequence.selection = kept_of(10, {5, 6, 7, 8});
    select_train_frames(truth, scope);
    CHECK(letters(truth, 0, 4) == "s..i");
  }
  CHECK(truth.tolerance_frames == 0);
}

TEST_CASE("labels of selected frames equal those of the reference implementation") {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    const size_t recorded = 1 + random() % 30;
    std::vector<uint32_t> sources;
    for (uint32_t r = 0; r < recorded; ++r)
      if (random() % 4 == 0) sources.push_back(r);
    if (sources.empty()) sources = {static_cast<uint32_t>(random() % recorded)};
    GroundTruth truth;
    truth.pairs.emplace_back();
    truth.tolerance_frames = static_cast<int64_t>(random() % 3);
    for (uint32_t sequence = 0; sequence < 2; ++sequence)
      for (uint32_t r = 0; r < recorded; ++r)
        if (const auto drawn = random() % 6; drawn < 2)
          truth.pairs[0].push_back(
              {sequence, r, drawn == 0 ? PlaceLabel::same : PlaceLabel::ignore, 0});
    const std::string first = letters(truth, 0, recorded);
    const std::string second = letters(truth, 1, recorded);
    GroundTruthScope scope{{"", 1}, {{"a", sources.size()}, {"b", recorded}}};
    scope.sequences[0].sequence.selection = kept_of(recorded, sources);
    select_train_frames(truth, scope);
    CHECK(letters(truth, 0, sources.size()) == plainly_kept(first, sources));
    CHECK(letters(truth, 1, recorded) == second);  // selects all
  }
}
