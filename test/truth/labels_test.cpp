// Labels: of people, as runs, and of selected frames.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "truth/truth_files.h"

using namespace vpr;
using test::draw;
using test::read_labels;
using test::write_matrix;
using test::write_text;
using test::write_truth;

namespace {

const std::string kHeader = "query,reference,label,tolerance\n";

/// The labels of a file, for 3 query frames and 10 training frames.
GroundTruth read_labels_of(const std::string& text, int tolerance = 0) {
  write_text("labels.csv", text);
  return read_ground_truth({"", "labels.csv", tolerance}, {{"q", 3}, {{{"t", 10}}}});
}

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

TEST_CASE("pairs without a label are unknown") {
  const GroundTruth truth = read_labels_of(kHeader + "0,4,same,1\n2,3,different,0\n2,9,same,2\n");
  CHECK(draw(truth, 3, 10) == "iiiSSSiiii iiiiiiiiii iii.iiiSSS");
  CHECK(truth.has_match(0));
  CHECK_FALSE(truth.has_match(1));
  REQUIRE(truth.asked.size() == 3);
  CHECK(truth.asked[2].size() == 2);
  const GroundTruth other = read_labels_of(kHeader + "1,5,different,0\n");
  CHECK(draw(other, 2, 10) == "iiiiiiiiii iiiii.iiii");
  CHECK(other.has_match(1));
}

TEST_CASE("labels near the decision are not in the sample") {
  write_text("labels.csv",
             "query,reference,label,tolerance,asked\n0,4,same,1,spread\n1,3,different,0,decision\n"
             "2,9,different,0,spread\n");
  const GroundTruth truth = read_ground_truth({"", "labels.csv"}, {{"q", 3}, {{{"t", 10}}}});
  CHECK(draw(truth, 3, 10) == "iiiSSSiiii iiiiiiiiii iiiiiiiii.");
  CHECK(truth.is_sample);
  CHECK_FALSE(truth.has_match(1));
  CHECK(truth.person_labels.size() == 3);
  CHECK(truth.protocol ==
        "labels of 2 pairs in 2 of 3 query frames, a sample spread along the query (1 further one "
        "near the decision only set the threshold); all other pairs are unknown");
  CHECK_FALSE(read_labels_of(kHeader + "0,4,same,1\n").is_sample);
}

TEST_CASE("a frame of the sample that had no best match counts") {
  write_text("labels.csv",
             "query,reference,label,tolerance,asked\n1,,,0,spread\n0,4,same,1,spread\n");
  const GroundTruth truth = read_ground_truth({"", "labels.csv"}, {{"q", 3}, {{{"t", 10}}}});
  CHECK(draw(truth, 3, 10) == "iiiSSSiiii iiiiiiiiii iiiiiiiiii");
  CHECK(truth.has_match(1));
  CHECK_FALSE(truth.has_match(2));
  CHECK(test::has(truth.protocol, "labels of 1 pair in 2 of 3 query frames"));
}

TEST_CASE("labels without rows, out of range or in contradiction are refused") {
  const auto refused = [](const std::string& rows, const std::string& words, int tolerance = 0) {
    CHECK_THROWS_WITH(read_labels_of(kHeader + rows, tolerance), Catch::Contains(words));
  };
  refused("", "has no labels");
  refused("3,0,same,1\n", "query 3 is out of range");
  refused("0,10,same,1\n", "reference 10 is out of range");
  refused("0,1,maybe,1\n", "neither same nor different");
  refused("0,,,0\n", "reference \"\" is not a frame number");
  refused("0,1,same,-1\n", "tolerance \"-1\"");
  refused("0,4,same,1\n0,5,different,0\n", "both same and different");
  refused("0,4,same,1\n", "has its own tolerance", 2);
}

TEST_CASE("runs of references are labeled with the tolerance, within the sequence") {
  GroundTruth truth;
  truth.pairs = {{{0, 1, PlaceLabel::ignore, 2}, {0, 6, PlaceLabel::same, 1}},
                 {{0, 0, PlaceLabel::same}, {0, 1, PlaceLabel::ignore}, {0, 9, PlaceLabel::same}}};
  CHECK(draw(truth, 2, 10) == ".iii..SS.. Si.......S");
  truth.tolerance_frames = 2;
  CHECK(draw(truth, 2, 10) == ".iiiSSSSSS SSS....SSS");
  truth.tolerance_frames = 100;
  CHECK(draw(truth, 2, 10) == "SSSSSSSSSS SSSSSSSSSS");
}

TEST_CASE("every written format can be read back, with the tolerance applied") {
  write_text("g.csv", "query,reference,label\n0,0,\n0,1,\n1,3,\n1,1,ignore\n3,5,ignore\n3,0,\n");
  const InspectedGroundTruth truth =
      inspect_ground_truth({"pairs", "g.csv", 1}, {{"", 4}, {{"ref", 6}}});
  const std::string all = "SSS... .iSSS. ...... SS...i";
  REQUIRE(draw(truth.truth, 4, 6) == all);
  std::string without_ignored = all;
  for (char& c : without_ignored) c = c == 'i' ? '.' : c;
  for (const GroundTruthFormat& format : ground_truth_formats()) {
    if (format.write == nullptr) continue;
    for (const std::string name : {"o.npz", "o.npy"}) {
      INFO(format.name << " " << name);
      write_truth(format, truth, name);
      const bool is_whole = format.ignores_in.empty() || name == "o.npz";
      CHECK(read_labels(name, 4, 6) == (is_whole ? all : without_ignored));
    }
  }
  // Writing is deterministic, with fixed dates.
  write_truth(find_format("matrix"), truth, "a.npz");
  write_truth(find_format("matrix"), truth, "b.npz");
  CHECK(test::read_text("a.npz") == test::read_text("b.npz"));
}

TEST_CASE("a check counts the pairs that reading refuses") {
  write_text("g.csv", "query,reference,label\n0,0,\n0,0,\n5,0,\n0,9,\n-1,0,\n1,1,ignore\n1,1,\n");
  const InspectedGroundTruth found = inspect_ground_truth({"", "g.csv"}, {{"", 2}, {{"ref", 3}}});
  CHECK(found.findings[size_t(FindingKind::out_of_range)].count == 3);
  CHECK(found.findings[size_t(FindingKind::out_of_range)].examples[0] ==
        "line 4: query 5 is out of range; there are 2 frames (0 to 1)");
  CHECK(found.findings[size_t(FindingKind::contradiction)].count == 1);
  CHECK(found.findings[size_t(FindingKind::duplicate)].count == 1);
  CHECK(draw(found.truth, 2, 3) == "S.. .S.");
}

TEST_CASE("overlapping labels are counted for the runs that they overlap") {
  // 0 to 9 is the same place, 2 to 12 is ignored, and then 5 to 8 and 5 to 11 are the same place
  // again.
  const GroundTruthArgument argument{"pairs", "made up"};
  GroundTruthBuilder builder(argument, "pairs", {{"", 1}, {{"ref", 20}}}, InconsistentPairs::count,
                             {});
  builder.add(0, 0, 0, 9, PlaceLabel::same);
  builder.add(0, 0, 2, 12, PlaceLabel::ignore);
  builder.add(0, 0, 5, 8, PlaceLabel::same);
  builder.add(0, 0, 5, 11, PlaceLabel::same);
  const InspectedGroundTruth found = builder.finish("");
  CHECK(found.findings[size_t(FindingKind::contradiction)].count == 8 + 2);
  CHECK(found.findings[size_t(FindingKind::duplicate)].count == 4 + 5);
  CHECK(test::has(found.findings[size_t(FindingKind::duplicate)].examples[0],
                  "reference 5 is listed"));
  CHECK(draw(found.truth, 1, 14) == "SSSSSSSSSSiii.");
}

TEST_CASE("labels of random runs, and their runs, equal the reference implementation") {
  RandomEngine random = named_engine(7, "runs");
  for (int round = 0; round < 300; ++round) {
    GroundTruth truth;
    truth.pairs.resize(1);
    truth.tolerance_frames = static_cast<int64_t>(uniform_below(random, 6));
    std::string exact(60, '.');
    for (auto at = static_cast<uint32_t>(uniform_below(random, 4)); at < 44;) {
      const auto label = uniform_below(random, 2) == 0 ? PlaceLabel::same : PlaceLabel::ignore;
      const auto further = static_cast<uint32_t>(uniform_below(random, 5));
      truth.pairs[0].push_back({0, at, label, further});
      exact.replace(at, further + 1, further + 1, label == PlaceLabel::same ? 'S' : 'i');
      at += further + 1 + static_cast<uint32_t>(uniform_below(random, 3));
    }
    std::string expected = exact.substr(0, 40);
    for (int64_t r = 0; r < 40; ++r)
      for (int64_t k = 0; k < 60; ++k)
        if (exact[static_cast<size_t>(k)] == 'S' && std::abs(k - r) <= truth.tolerance_frames)
          expected[static_cast<size_t>(r)] = 'S';
    REQUIRE(draw(truth, 1, 40) == expected);
    std::string drawn(40, '.');
    size_t end = 0;
    for (const LabelStretch& run : label_runs(truth, 0, 0, 40)) {
      CHECK(run.first >= end);
      end = run.last + 1;
      REQUIRE(end <= 40);
      drawn.replace(run.first, end - run.first, end - run.first,
                    ".Si"[static_cast<size_t>(run.label)]);
    }
    REQUIRE(drawn == expected);
  }
}

TEST_CASE("a fingerprint depends on the label of every pair, not on its origin") {
  const auto fingerprint = [](const GroundTruthArgument& argument, const GroundTruthScope& scope) {
    return ground_truth_fingerprint(read_ground_truth(argument, scope), scope);
  };
  const GroundTruthScope one{{"", 3}, {{"ref", 4}}};
  const std::string aligned = fingerprint({"aligned", {}, 1}, one);
  write_text("a.csv", "query,reference\n0,0\n1,1\n2,2\n");
  write_text("b.csv", "query,reference\n2,3\n2,1\n2,2\n1,2\n1,1\n1,0\n0,1\n0,0\n");
  write_matrix<uint8_t>("m.npy", {1, 1, 0, 0, 1, 1, 1, 0, 0, 1, 1, 1}, 3, 4, "|b1");
  CHECK(fingerprint({"", "a.csv", 1}, one) == aligned);
  CHECK(fingerprint({"", "b.csv"}, one) == aligned);
  CHECK(fingerprint({"", "m.npy"}, one) == aligned);
  CHECK(fingerprint({"", "a.csv"}, one) != aligned);
  CHECK(fingerprint({"aligned", {}, 2}, one) != aligned);
  // Names have no effect, and neither have sequences that were not searched or have no pair.
  CHECK(fingerprint({"aligned", {}, 1}, {{"", 3}, {{{"other", 9}, false}, {"references", 4}}}) ==
        aligned);
  write_text("s.csv", "query,sequence,reference\n0,ref,0\n1,ref,1\n2,ref,2\n");
  CHECK(fingerprint({"", "s.csv", 1}, {{"", 3}, {{"ref", 4}, {"more", 7}}}) == aligned);
  CHECK(fingerprint({"", "s.csv", 1}, {{"", 3}, {{"more", 7}, {"ref", 4}}}) != aligned);
  write_text("i.csv", "query,reference,label\n0,0,\n1,1,\n2,2,\n0,3,ignore\n");
  CHECK(fingerprint({"", "i.csv", 1}, one) != aligned);
}

TEST_CASE("one large index does not make a file large") {
  write_text("g.csv", "query,reference\n4000000000,0\n");
  CHECK(test::error_kind([&] {
          inspect_ground_truth({"", "g.csv"}, {{"", kUnknownFrames}, {{"", kUnknownFrames}}});
        }) == ErrorKind::data);
}

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
  CHECK(truth.applied_tolerance_frames == 1);
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
