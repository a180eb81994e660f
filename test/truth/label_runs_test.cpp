// Labels as runs: reading, checks, writing, and comparison by content.
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "truth/ground_truth.h"
#include "truth/truth_files.h"

using namespace vpr;
using test::draw;
using test::read_labels;
using test::write_matrix;
using test::write_text;
using test::write_truth;

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

TEST_CASE("labels of random runs equal the reference implementation") {
  uint64_t state = 7;
  const auto next = [&](uint64_t below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<uint32_t>((state >> 33) % below);
  };
  for (int round = 0; round < 200; ++round) {
    GroundTruth truth;
    truth.pairs.resize(1);
    truth.tolerance_frames = next(5);
    std::vector<PlaceLabel> exact(40, PlaceLabel::different);
    for (uint32_t at = next(4); at < 36;) {
      const auto label = next(2) == 0 ? PlaceLabel::same : PlaceLabel::ignore;
      const uint32_t further = next(4);
      truth.pairs[0].push_back({0, at, label, further});
      for (uint32_t r = at; r <= at + further; ++r) exact[r] = label;
      at += further + 1 + next(4);
    }
    for (int64_t r = 0; r < 40; ++r) {
      PlaceLabel expected = exact[static_cast<size_t>(r)];
      for (int64_t k = 0; k < 40; ++k)
        if (exact[static_cast<size_t>(k)] == PlaceLabel::same &&
            std::abs(k - r) <= truth.tolerance_frames)
          expected = PlaceLabel::same;
      REQUIRE(truth.label(0, 0, static_cast<size_t>(r)) == expected);
    }
    draw(truth, 1, 40);
  }
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

TEST_CASE("runs of labels equal the reference implementation") {
  uint64_t state = 11;
  const auto next = [&](uint64_t below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<uint32_t>((state >> 33) % below);
  };
  for (int round = 0; round < 300; ++round) {
    GroundTruth truth;
    truth.pairs.resize(1);
    truth.tolerance_frames = next(6);
    for (uint32_t at = next(4); at < 44;) {
      const auto label = next(2) == 0 ? PlaceLabel::same : PlaceLabel::ignore;
      truth.pairs[0].push_back({0, at, label, next(5)});
      at += truth.pairs[0].back().further + 1 + next(3);
    }
    std::string drawn(40, '.');
    size_t end = 0;
    for (const LabelStretch& run : label_runs(truth, 0, 0, 40)) {
      CHECK(run.first >= end);
      end = run.last + 1;
      REQUIRE(end <= 40);
      for (size_t r = run.first; r <= run.last; ++r)
        drawn[r] = ".Si"[static_cast<size_t>(run.label)];
    }
    REQUIRE(drawn == draw(truth, 1, 40));
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
