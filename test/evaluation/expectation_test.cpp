#include "evaluation/expectation.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"
#include "support.h"

using namespace vpr;

namespace {

const Json kReport = Json::parse(R"({"schema": "vpr.report/1", "method": "fastable",
  "counts": {"hits": {"correct": 52, "incorrect": 16}, "distinct": 3},
  "best_match": {"correct": 48, "rate": 0.25}})");

std::vector<std::string> unmet(const std::string& expected) {
  return unmet_expectations(kReport, Json::parse(expected), "e.json");
}

}  // namespace

TEST_CASE("counts are met exactly, or within a stated tolerance") {
  CHECK(unmet(R"({"schema": "vpr.expected/1", "counts": {"hits": {"correct": 52}}})").empty());
  CHECK(unmet(R"({"schema": "vpr.expected/1",
                  "counts": {"hits": {"correct": {"value": 50, "tolerance": 2}}}})")
            .empty());
  CHECK(unmet(R"({"schema": "vpr.expected/1",
                  "counts": {"hits": {"correct": {"value": 49, "tolerance": 2}}}})") ==
        std::vector<std::string>{"counts.hits.correct: expected 49 +- 2, found 52 (+3)"});
  CHECK(unmet(R"({"schema": "vpr.expected/1", "counts": {"distinct": 4},
                  "best_match": {"correct": 47}})") ==
        std::vector<std::string>{"counts.distinct: expected 4, found 3 (-1)",
                                 "best_match.correct: expected 47, found 48 (+1)"});
}

TEST_CASE("an earlier report is an expectation") {
  CHECK(unmet(kReport.dump()).empty());
  Json other = kReport;
  other["method"] = "openable";
  other["counts"]["hits"]["incorrect"] = 15;
  CHECK(unmet(other.dump()).size() == 1);
}

TEST_CASE("expectations that can't fail, or can't be met, are usage errors") {
  const std::string text = GENERATE(
      "{}", "3", R"({"schema": "vpr.expected/1"})", R"({"schema": "vpr.expected/1", "counts": {}})",
      R"({"schema": "vpr.expected/1", "count": {"distinct": 3}})",
      R"({"schema": "vpr.expected/1", "counts": {"hist": {"correct": 3}}})",
      R"({"schema": "vpr.expected/1", "counts": {"distinct": "3"}})",
      R"({"schema": "vpr.expected/1", "counts": {"hits": 3}})",
      R"({"schema": "vpr.expected/1", "counts": {"distinct": {"value": 3, "tolerance": -1}}})",
      R"({"schema": "vpr.expected/1", "counts": {"distinct": {"value": 3, "tol": 1}}})",
      R"({"schema": "vpr.result/1", "counts": {"distinct": 3}})", R"({"schema": 3})");
  CHECK(test::error_kind([&] { unmet(text); }) == ErrorKind::usage);
}

TEST_CASE("a rate that is none is met by none alone") {
  const Json none = Json::parse(R"({"counts": {"distinct": 0}, "best_match": {"rate": null}})");
  const auto unmet_of = [&](const Json& report, const char* expected) {
    return unmet_expectations(report, Json::parse(expected), "e.json").size();
  };
  CHECK(unmet_of(none, R"({"schema": "vpr.expected/1", "counts": {"distinct": 0},
                           "best_match": {"rate": null}})") == 0);
  CHECK(unmet_of(none, R"({"schema": "vpr.expected/1", "best_match": {"rate": 0.5}})") == 1);
  CHECK(unmet_of(kReport, R"({"schema": "vpr.expected/1", "best_match": {"rate": null}})") == 1);
}
