#include "present/ground_truth_report.h"

#include "base/json.h"

namespace vpr {
namespace {

Json finding_json(const GroundTruthFinding& finding) {
  return {{"count", finding.count}, {"examples", finding.examples}};
}

}  // namespace

Json ground_truth_report_json(const InspectedGroundTruth& ground_truth,
                              const GroundTruthSummary& summary, const RunInfo& run) {
  const auto finding = [&](FindingKind kind) {
    return finding_json(ground_truth.findings[static_cast<size_t>(kind)]);
  };
  Json json = {{"schema", "vpr.ground-truth-check/3"},
               {"format", ground_truth.format},
               {"protocol", ground_truth.truth.protocol}};
  json["frames"] = {{"query", summary.query_frames}, {"train", summary.train_frames}};
  json["pairs"] = {
      {"same", summary.same}, {"ignored", summary.ignored}, {"most_matches", summary.most_matches}};
  json["findings"] = {{"out_of_range", finding(FindingKind::out_of_range)},
                      {"contradiction", finding(FindingKind::contradiction)},
                      {"duplicate", finding(FindingKind::duplicate)},
                      {"queries_without_match", summary.queries_without_match},
                      {"train_frames_without_match", summary.train_frames_without_match},
                      {"one_sided", nullptr}};
  if (summary.one_sided)
    json["findings"]["one_sided"] = finding_json({*summary.one_sided, summary.one_sided_examples});
  json["provenance"] = provenance_json(run);
  json["machine"] = machine_json(run);
  return json;
}

Table ground_truth_table(const InspectedGroundTruth& ground_truth,
                         const GroundTruthSummary& summary) {
  const auto finding = [&](FindingKind kind) {
    return ground_truth.findings[static_cast<size_t>(kind)].count;
  };
  Table table{ground_truth.truth.protocol, {"what", "count"}, {}};
  add_row(table, "query frames", summary.query_frames);
  add_row(table, "training frames", summary.train_frames);
  add_row(table, "pairs of the same place, tolerance applied", summary.same);
  add_row(table, "pairs to ignore", summary.ignored);
  add_row(table, "most matches of one query", summary.most_matches);
  add_row(table, "pairs out of range: damage", finding(FindingKind::out_of_range));
  add_row(table, "pairs labeled both same and ignore: damage", finding(FindingKind::contradiction));
  add_row(table, "pairs given more than once; they count once", finding(FindingKind::duplicate));
  add_row(table, "queries without a match; counted apart", summary.queries_without_match);
  add_row(table, "training frames that no query matches", summary.train_frames_without_match);
  add_row(table, "pairs (i, j) without (j, i); usual between two sequences",
          summary.one_sided ? std::to_string(*summary.one_sided) : "-");
  return table;
}

std::string ground_truth_examples(const InspectedGroundTruth& ground_truth,
                                  const GroundTruthSummary& summary) {
  std::string text;
  for (const FindingKind kind :
       {FindingKind::out_of_range, FindingKind::contradiction, FindingKind::duplicate})
    for (const std::string& example : ground_truth.findings[static_cast<size_t>(kind)].examples)
      text += example + "\n";
  if (summary.one_sided)
    for (const std::string& example : summary.one_sided_examples) text += example + "\n";
  return text;
}

Json conversion_json(const InspectedGroundTruth& ground_truth, const GroundTruthSummary& summary,
                     std::string_view target) {
  return {{"schema", "vpr.conversion/3"},
          {"from", ground_truth.format},
          {"to", target},
          {"query_frames", summary.query_frames},
          {"same", summary.same},
          {"ignored", summary.ignored}};
}

}  // namespace vpr
