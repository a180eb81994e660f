#include "present/ground_truth_report.h"

#include <fmt/format.h>

#include "base/json.h"

namespace vpr {
namespace {

Json finding_json(const GroundTruthFinding& finding) {
  return {{"count", finding.count}, {"examples", finding.examples}};
}

// A row of the table: where the number stands in the report, and what it means.
struct Line {
  const char* group;
  const char* key;
  const char* meaning;
};

constexpr Line kLines[] = {
    {"frames", "query", "query frames"},
    {"frames", "train", "training frames"},
    {"pairs", "same", "pairs of the same place, tolerance applied"},
    {"pairs", "ignored", "pairs to ignore"},
    {"pairs", "most_matches", "most matches of one query"},
    {"findings", "out_of_range", "pairs out of range: damage"},
    {"findings", "contradiction", "pairs labelled both same and ignore: damage"},
    {"findings", "duplicate", "pairs given more than once; they count once"},
    {"findings", "queries_without_match", "queries without a match; counted apart"},
    {"findings", "references_without_match", "training frames that no query matches"},
    {"findings", "one_sided", "pairs (i, j) without (j, i); usual between two walks"},
};

const Json& count_of(const Json& value) { return value.is_object() ? value["count"] : value; }

}  // namespace

Json ground_truth_report_json(const InspectedGroundTruth& ground_truth,
                              const GroundTruthSummary& summary, const RunInfo& run) {
  const auto finding = [&](FindingKind kind) {
    return finding_json(ground_truth.findings[static_cast<size_t>(kind)]);
  };
  Json json = {{"schema", "vpr.ground-truth-check/1"},
               {"format", ground_truth.format},
               {"protocol", ground_truth.truth.protocol}};
  json["frames"] = {{"query", summary.query_frames}, {"train", summary.train_frames}};
  json["pairs"] = {
      {"same", summary.same}, {"ignored", summary.ignored}, {"most_matches", summary.most_matches}};
  json["findings"] = {{"out_of_range", finding(FindingKind::out_of_range)},
                      {"contradiction", finding(FindingKind::contradiction)},
                      {"duplicate", finding(FindingKind::duplicate)},
                      {"queries_without_match", summary.queries_without_match},
                      {"references_without_match", summary.references_without_match},
                      {"one_sided", nullptr}};
  if (summary.one_sided)
    json["findings"]["one_sided"] = finding_json({*summary.one_sided, summary.one_sided_examples});
  json["provenance"] = provenance_json(run);
  json["machine"] = machine_json(run);
  return json;
}

Table ground_truth_table(const Json& report) {
  Table table;
  table.title = report["protocol"].get<std::string>();
  table.columns = {"what", "count"};
  for (const Line& line : kLines) {
    const Json& count = count_of(report[line.group][line.key]);
    table.rows.push_back({line.meaning, count.is_null() ? "-" : count.dump()});
  }
  return table;
}

std::string ground_truth_examples(const Json& report) {
  std::string text;
  for (const auto& item : report["findings"].items()) {
    if (!item.value().is_object()) continue;
    for (const Json& example : item.value()["examples"])
      text += fmt::format("{}\n", example.get<std::string>());
  }
  return text;
}

Json conversion_json(const InspectedGroundTruth& ground_truth, const GroundTruthSummary& summary,
                     std::string_view target) {
  return {{"schema", "vpr.conversion/1"},
          {"from", ground_truth.format},
          {"to", target},
          {"query_frames", summary.query_frames},
          {"same", summary.same},
          {"ignored", summary.ignored}};
}

}  // namespace vpr
