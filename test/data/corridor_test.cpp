// Results on a real office corridor, walked twice (111 + 111 frames).
#include <algorithm>
#include <cstdlib>
#include <tuple>

#include <catch2/catch.hpp>

#include "database/frame_descriptors.h"
#include "examples.h"
#include "printed.h"
#include "recordings/sequence_source.h"
#include "reference/reference.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

std::vector<LdbCode> describe_folder(const fs::path& folder) {
  return ldb_codes(
      descriptor_kind("ldb").describe(open_sequence({folder, {}}), {}, Unreadable::fail, {}));
}

Json evaluate(const fs::path& corridor, const Words& query_words, const Words& eval_words) {
  if (!fs::exists("c.vprdb"))
    run_ok("vpr-train", {"fastable", "--train", corridor / "ref", "-o", "c.vprdb"});
  run_ok("vpr-query", joined({"c.vprdb", "--query", corridor / "query", "--force", "-o", "r.json"},
                             query_words));
  return printed_json("vpr-eval", joined({"r.json", "--json"}, eval_words));
}

}  // namespace

TEST_CASE("codes of the corridor equal those of two independent programs, bit for bit") {
  const auto corridor = real_data("data/corridor");
  const auto expected = real_data("expected");
  if (!corridor || !expected) return;
  const NpyArray file(*expected / "corridor-query-codes.npy");
  const auto bytes = file.values<uint8_t>(2);
  const std::vector<LdbCode> codes = describe_folder(*corridor / "query");
  REQUIRE(file.shape() == std::vector<size_t>{codes.size(), kLdbBytes});
  for (size_t i = 0; i < codes.size(); ++i)
    REQUIRE(std::equal(codes[i].begin(), codes[i].end(),
                       bytes.begin() + static_cast<ptrdiff_t>(i * kLdbBytes)));
}

TEST_CASE("Hamming distances of the corridor equal those of two independent programs") {
  const auto corridor = real_data("data/corridor");
  const auto expected = real_data("expected");
  if (!corridor || !expected) return;
  const auto matrix = read_array<uint16_t>(*expected / "corridor-hamming.npy");
  const std::vector<LdbCode> query = describe_folder(*corridor / "query");
  const std::vector<LdbCode> train = describe_folder(*corridor / "ref");
  const DescribedFrames span{train, {}};
  std::vector<uint16_t> row(train.size() + kBlockFrames);
  for (const std::string& target : simd_targets()) {
    const ChosenTarget chosen(target);
    const FrameDistances distances = frame_distances({&span, 1}, {query, {}});
    for (uint32_t q = 0; q < query.size(); ++q) {
      distances.tile({&q, 1}, 0, train.size(), row.data(), 0);
      for (size_t t = 0; t < train.size(); ++t) REQUIRE(row[t] == matrix[q * train.size() + t]);
    }
  }
}

TEST_CASE("best matches on the corridor, aligned within 3 frames") {
  const auto corridor = real_data("data/corridor");
  if (!corridor) return;
  const auto [length, correct] =
      GENERATE(table<int, int>({{1, 46}, {5, 52}, {10, 75}, {20, 80}, {40, 72}}));
  for (const std::string method : {"fastable", "openable", "fastable-online"}) {
    const Json report =
        evaluate(*corridor, {"--c-l", std::to_string(length), "--t-r", "0.4", "--method", method},
                 {"--ground-truth", "aligned", "--tolerance", "3"});
    CHECK(report["best_match"]["correct"] == correct);
    CHECK(report["best_match"]["frames"] == 111);
  }
}

TEST_CASE("recognitions and places on the corridor with its labeled pairs") {
  const auto corridor = real_data("data/corridor");
  if (!corridor) return;
  struct Row {
    const char* c_l;
    const char* t_r;
    std::array<int, 4> counts;  // recognitions correct and incorrect, places correct and incorrect
  };
  for (const Row& row : {Row{"5", "0.45", {52, 16, 3, 1}}, Row{"10", "0.55", {59, 21, 2, 1}},
                         Row{"20", "0.65", {63, 0, 2, 0}}}) {
    const Json counts = evaluate(*corridor, {"--c-l", row.c_l, "--t-r", row.t_r},
                                 {"--ground-truth", *corridor / "ground_truth.csv"})["counts"];
    CHECK(counts["pairs"]["correct"] == row.counts[0]);
    CHECK(counts["pairs"]["incorrect"] == row.counts[1]);
    CHECK(counts["clusters"]["correct"] == row.counts[2]);
    CHECK(counts["clusters"]["incorrect"] == row.counts[3]);
    CHECK(counts["distinct"] == row.counts[2]);
  }
}

TEST_CASE("the published recurrence is off by nearly 300 bits on the corridor, ours is exact") {
  const auto corridor = real_data("data/corridor");
  if (!corridor) return;
  const std::vector<LdbCode> query = describe_folder(*corridor / "query");
  const std::vector<LdbCode> train = describe_folder(*corridor / "ref");
  const size_t length = 20;
  const std::vector<uint32_t> right = reference_openable(train, query, length);
  CHECK(reference_fastable(train, query, length) == right);
  const size_t cols = train.size() - length + 1;
  std::vector<int64_t> published(right.begin(), right.end());
  int64_t largest_difference = 0;
  for (size_t j = 1; j * cols < right.size(); ++j)
    for (size_t i = 1; i < cols; ++i) {
      const size_t cell = j * cols + i;
      published[cell] = published[cell - cols - 1] +
                        reference_hamming(train[i + length - 1], query[j + length - 1]) -
                        static_cast<int64_t>(reference_hamming(train[i], query[j]));
      largest_difference =
          std::max(largest_difference, std::abs(published[cell] - int64_t{right[cell]}));
    }
  CHECK(largest_difference > 250);
  CHECK(largest_difference < 300);
}

TEST_CASE("metrics of the corridor equal those of an independent evaluation in NumPy") {
  const auto corridor = real_data("data/corridor");
  const auto expected = real_data("expected");
  if (!corridor || !expected) return;
  const Json metrics = printed_json(
      "vpr-eval", {"matrix", *expected / "corridor-hamming.npy", "--distance", "--ground-truth",
                   *corridor / "ground_truth.csv", "--json"})["metrics"];
  const auto check = [](const Json& found, double wanted) {
    CHECK(found.get<double>() == Approx(wanted).epsilon(1e-12));
  };
  const Json& single = metrics["single_best"];
  check(single["average_precision"], 0.18092763201728745);
  check(single["recall_at_100_precision"], 0.036036036036036036);
  check(single["max_f1"], 0.35135135135135137);
  check(single["extended_precision"], 0.5180180180180181);
  check(single["roc_auc"], 0.5660612535612536);
  const Json& pairs = metrics["all_pairs"];
  check(pairs["average_precision"], 0.18897651395296916);
  check(pairs["recall_at_100_precision"], 0.009107468123861567);
  check(pairs["max_f1"], 0.23832528180354268);
  check(pairs["roc_auc"], 0.7422602767704788);
  CHECK(single["tied_queries"] == 8);
  CHECK(metrics["recall_at"]["1"].get<double>() == Approx(39 / 111.0));
  CHECK(metrics["recall_at"]["5"].get<double>() == Approx(74 / 111.0));
  CHECK(metrics["recall_at"]["10"].get<double>() == Approx(90 / 111.0));
  CHECK(metrics["recall_at"]["20"].get<double>() == Approx(97 / 111.0));
}

TEST_CASE("a path through the corridor is one place, at equal and at double speed") {
  const auto corridor = real_data("data/corridor");
  if (!corridor) return;
  run_ok("vpr-train", {"fastable", "--train", *corridor / "ref", "-o", "c.vprdb"});
  for (const auto& [range, last, train_last, correct] :
       {std::tuple<std::string, size_t, size_t, size_t>{"", 110, 110, 111}, {"@::2", 38, 77, 33}}) {
    INFO(range);
    const Json result =
        printed_json("vpr-query", {"c.vprdb", "--query", (*corridor / "query").string() + range,
                                   "--method", "filter", "--force", "-o", "r.json", "--json"});
    REQUIRE(result["clusters"].size() == 1);
    const Json& place = result["clusters"][0];
    CHECK(place["recognitions"] == result["totals"]["recognitions"]);
    CHECK(place["query"]["first_frame"] == 0);
    CHECK(place["query"]["last_frame"] == last);
    CHECK(place["train"]["last_frame"] == train_last);
    const auto eval =
        run_program("vpr-eval", {"r.json", "--ground-truth", "aligned", "--tolerance", "3",
                                 "--train-step", range.empty() ? "1" : "2", "--json"});
    const Json report = Json::parse(eval.out);
    CHECK(report["counts"]["distinct"] == 1);
    CHECK(report["counts"]["pairs"]["correct"] == correct);
    CHECK(report["clusters"][0]["query_range"] == Json({0, last}));
  }
}
