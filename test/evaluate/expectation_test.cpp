#include "evaluate/expectation.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"
#include "evaluate/exports.h"
#include "support.h"

using namespace vpr;

namespace {

const Json kReport = Json::parse(R"({"schema": "vpr.report/5", "method": "fastable",
  "counts": {"pairs": {"correct": 52, "incorrect": 16}, "distinct": 3},
  "best_match": {"correct": 48, "rate": 0.25}})");

std::vector<std::string> unmet(const std::string& expected) {
  return unmet_expectations(check_expectations(kReport, Json::parse(expected), "e.json"));
}

}  // namespace

TEST_CASE("counts must be equal, or within a stated tolerance") {
  CHECK(unmet(R"({"schema": "vpr.expected/5", "counts": {"pairs": {"correct": 52}}})").empty());
  CHECK(unmet(R"({"schema": "vpr.expected/5",
                  "counts": {"pairs": {"correct": {"value": 50, "tolerance": 2}}}})")
            .empty());
  CHECK(unmet(R"({"schema": "vpr.expected/5",
                  "counts": {"pairs": {"correct": {"value": 49, "tolerance": 2}}}})") ==
        std::vector<std::string>{"counts.pairs.correct: expected 49 +- 2, found 52 (+3)"});
  CHECK(unmet(R"({"schema": "vpr.expected/5",
                  "counts": {"pairs": {"correct": {"value": 51.9, "tolerance": 0.1}}}})")
            .empty());
  CHECK(unmet(R"({"schema": "vpr.expected/5", "counts": {"distinct": 4},
                  "best_match": {"correct": 47}})") ==
        std::vector<std::string>{"counts.distinct: expected 4, found 3 (-1)",
                                 "best_match.correct: expected 47, found 48 (+1)"});
}

TEST_CASE("an earlier report can be an expectation") {
  CHECK(unmet(kReport.dump()).empty());
  Json other = kReport;
  other["method"] = "openable";
  other["counts"]["pairs"]["incorrect"] = 15;
  CHECK(unmet(other.dump()).size() == 1);
}

TEST_CASE("settings and ground truth of an earlier report are expected as well") {
  Json report = kReport;
  report["settings"] = {{"c_l", 10}, {"t_r", "auto"}, {"clustering", {{"eps", 2}}}};
  report["protocol"] = {{"ground_truth", "aligned"}, {"tolerance_frames", 3}, {"anchor", "last"}};
  report["provenance"] = {{"ground_truth", "xxh3:a"}, {"commit", "1"}};
  const auto unmet_of = [&](const Json& expected) {
    return unmet_expectations(check_expectations(report, expected, "e.json"));
  };
  Json baseline = report;
  baseline["provenance"]["commit"] = "2";
  baseline["protocol"]["anchor"] = "in other words";
  CHECK(unmet_of(baseline).empty());
  baseline["protocol"]["ground_truth"] = "the same in another format";
  CHECK(unmet_of(baseline).empty());
  baseline["settings"]["c_l"] = 99;
  baseline["settings"]["clustering"]["eps"] = 3;
  baseline["protocol"]["tolerance_frames"] = 7;
  baseline["provenance"]["ground_truth"] = "xxh3:b";
  CHECK(unmet_of(baseline) ==
        std::vector<std::string>{"settings.c_l: expected 99, found 10",
                                 "settings.clustering.eps: expected 3, found 2",
                                 "protocol.tolerance_frames: expected 7, found 3",
                                 "provenance.ground_truth: expected \"xxh3:b\", found \"xxh3:a\""});
  baseline = report;
  baseline.erase("provenance");
  CHECK(unmet_of(baseline).empty());
  baseline["protocol"]["ground_truth"] = "pairs";
  CHECK(unmet_of(baseline).size() == 1);
  CHECK(unmet_of(Json::parse(R"({"schema": "vpr.expected/5", "counts": {"distinct": 3},
                                 "settings": {"c_l": 11}})"))
            .size() == 1);
}

TEST_CASE("the name of a score matrix is not expected") {
  const Json report = Json::parse(R"({"schema": "vpr.report/5", "best_match": {"correct": 3},
      "settings": {"method": "new", "window": 1}})");
  Json baseline = report;
  baseline["settings"]["method"] = "old";
  CHECK(unmet_expectations(check_expectations(report, baseline, "e.json")).empty());
}

TEST_CASE("expectations that cannot fail, or cannot be met, are usage errors") {
  const std::string text = GENERATE(
      "{}", "3", R"({"schema": "vpr.expected/5"})", R"({"schema": "vpr.expected/5", "counts": {}})",
      R"({"schema": "vpr.expected/5", "count": {"distinct": 3}})",
      R"({"schema": "vpr.expected/5", "counts": {"hist": {"correct": 3}}})",
      R"({"schema": "vpr.expected/5", "counts": {"distinct": "3"}})",
      R"({"schema": "vpr.expected/5", "counts": {"pairs": 3}})",
      R"({"schema": "vpr.expected/5", "counts": {"distinct": {"value": 3, "tolerance": -1}}})",
      R"({"schema": "vpr.expected/5", "counts": {"distinct": {"value": 3, "tol": 1}}})",
      R"({"schema": "vpr.expected/5", "counts": {"distinct": {"min": "3"}}})",
      R"({"schema": "vpr.expected/5", "counts": {"distinct": {"min": 3, "max": 2}}})",
      R"({"schema": "vpr.expected/5", "counts": {"distinct": {"min": 3, "value": 3}}})",
      R"({"schema": "vpr.expected/5", "counts": {"distinct": {"min": 3, "tolerance": 1}}})",
      R"({"schema": "vpr.result/5", "counts": {"distinct": 3}})", R"({"schema": 3})");
  CHECK(test::error_kind([&] { unmet(text); }) == ErrorKind::usage);
}

TEST_CASE("a missing rate is met only by a missing rate") {
  const Json none = Json::parse(R"({"counts": {"distinct": 0}, "best_match": {"rate": null}})");
  const auto unmet_of = [&](const Json& report, const char* expected) {
    return unmet_expectations(check_expectations(report, Json::parse(expected), "e.json")).size();
  };
  CHECK(unmet_of(none, R"({"schema": "vpr.expected/5", "counts": {"distinct": 0},
                           "best_match": {"rate": null}})") == 0);
  CHECK(unmet_of(none, R"({"schema": "vpr.expected/5", "best_match": {"rate": 0.5}})") == 1);
  CHECK(unmet_of(kReport, R"({"schema": "vpr.expected/5", "best_match": {"rate": null}})") == 1);
}

TEST_CASE("bounds are one-sided or two-sided, and inclusive") {
  const auto unmet_of = [](const std::string& bounds) {
    return unmet(R"({"schema": "vpr.expected/5", "counts": {"pairs": {"correct": )" + bounds +
                 "}}}");
  };
  CHECK(unmet_of(R"({"min": 52})").empty());
  CHECK(unmet_of(R"({"max": 52})").empty());
  CHECK(unmet_of(R"({"min": 50, "max": 60})").empty());
  CHECK(unmet_of(R"({"min": 53})") ==
        std::vector<std::string>{"counts.pairs.correct: expected at least 53, found 52"});
  CHECK(unmet_of(R"({"max": 51})") ==
        std::vector<std::string>{"counts.pairs.correct: expected at most 51, found 52"});
  CHECK(unmet_of(R"({"min": 53, "max": 60})") ==
        std::vector<std::string>{"counts.pairs.correct: expected 53 to 60, found 52"});
}

TEST_CASE("updated values are met, and keep their tolerances and satisfied bounds") {
  Json report = kReport;
  report["settings"] = {{"c_l", 10}};
  const Json expected = Json::parse(R"({"schema": "vpr.expected/5",
      "counts": {"pairs": {"correct": {"value": 40, "tolerance": 2}, "incorrect": {"max": 20}},
                 "distinct": {"min": 4}},
      "best_match": {"correct": 1, "rate": {"min": 0.5, "max": 0.6}}, "settings": {"c_l": 20}})");
  const Json updated = updated_expectations(report, expected, "e.json");
  CHECK(updated == Json::parse(R"({"schema": "vpr.expected/5",
      "counts": {"pairs": {"correct": {"value": 52, "tolerance": 2}, "incorrect": {"max": 20}},
                 "distinct": {"min": 3}},
      "best_match": {"correct": 48, "rate": {"min": 0.25, "max": 0.6}}, "settings": {"c_l": 10}})"));
  CHECK(unmet_expectations(check_expectations(report, updated, "e.json")).empty());
  CHECK(updated_expectations(report, kReport, "e.json") == report);
}

TEST_CASE("a value that is met is a test case, another one a failure, with any content") {
  const std::vector<CheckedValue> values = {{"counts.pairs", "3", "3", true},
                                            {"a<b&\"c\"\x01", "at least 5", "4", false}};
  CHECK(junit_xml("x > y on 'z'", "e.json", values) ==
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<testsuites tests=\"2\" failures=\"1\">\n"
        "  <testsuite name=\"x &gt; y on &#39;z&#39;\" tests=\"2\" failures=\"1\" errors=\"0\" "
        "skipped=\"0\" file=\"e.json\">\n"
        "    <testcase classname=\"x &gt; y on &#39;z&#39;\" name=\"counts.pairs\"/>\n"
        "    <testcase classname=\"x &gt; y on &#39;z&#39;\" "
        "name=\"a&lt;b&amp;&quot;c&quot;\xef\xbf\xbd\">\n"
        "      <failure message=\"expected at least 5, found 4\"/>\n"
        "    </testcase>\n"
        "  </testsuite>\n"
        "</testsuites>\n");
}
