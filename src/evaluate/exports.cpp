#include "evaluate/exports.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.h"
#include "evaluate/evaluation.h"
#include "evaluate/report.h"

namespace vpr {

std::string outcomes_csv(const Judgment& judgment, const std::string& name,
                         const std::string& query_name) {
  const std::string start = csv_field(name) + "," + csv_field(query_name) + ",";
  const Outcomes& outcomes = judgment.outcomes;
  std::string text;
  for (const QueryOutcome& query : outcomes.queries) {
    const std::string best =
        query.best
            ? fmt::format(
                  "{},{},{}",
                  csv_field(judgment.layout.scope.sequences[query.best->sequence].sequence.name),
                  query.best->reference, score_of_key(query.key, outcomes.kind))
            : ",,";
    const char* has_match = judgment.by != JudgedBy::ground_truth ? ""
                            : query.has_match                     ? "yes"
                                                                  : "no";
    text += fmt::format("{}{},{},{},{},{},{},{},{}\n", start,
                        query.frame + 1 < outcomes.window_length
                            ? ""
                            : std::to_string(query.frame + 1 - outcomes.window_length),
                        query.frame, best, enum_name(query.verdict), has_match,
                        enum_name(judgment.verdicts[query.frame]),
                        query.rank ? std::to_string(*query.rank) : "",
                        query.margin ? fmt::format("{}", *query.margin) : "");
  }
  return text;
}

std::string recognitions_csv(const EvaluatedResult& judged, const std::string& name) {
  const Result& result = *judged.result;
  const std::string start = csv_field(name) + "," + csv_field(result.query.name) + ",";
  const size_t length = result.window_length();
  const Clusters clusters = clusters_of(result);
  std::string text;
  for (size_t c = 0; c < judged.clusters.size(); ++c) {
    const Cluster& cluster = clusters.all[c];
    const JudgedCluster& one = judged.clusters[c];
    const std::string& target = result.places ? result.places->names[cluster.train_window]
                                              : result.sequences[cluster.sequence].sequence.name;
    text += fmt::format(
        "{}{},{},{},{},{},{},{},{},{},{},{},{}\n", start, csv_field(target), cluster.query_first,
        anchor_of(cluster.query_window, length), anchor_of(cluster.query_last, length),
        cluster.train_first, anchor_of(cluster.train_window, length),
        anchor_of(cluster.train_last, length), cluster.recognitions, one.recognitions.correct,
        one.recognitions.incorrect, cluster.best_score, verdict_text(one));
  }
  return text;
}

std::string recognized_trajectory(const Evaluation& evaluation, const TrainPositions& positions,
                                  const FrameTimes& times) {
  std::string text = fmt::format("# time{} x y z qx qy qz qw\n", times.are_seconds ? " (s)" : "");
  for (const auto& [frame, match] : recognized_frames(evaluation)) {
    const Poses& train = positions[match.sequence];
    if (match.reference >= train.size() || !train[match.reference]) continue;
    const auto& [x, y, z] = train[match.reference]->position;
    const std::string height = z == 0 ? "0" : fmt::format("{:.6f}", z);
    text += fmt::format("{} {:.6f} {:.6f} {} 0 0 0 1\n", times.texts[frame], x, y, height);
  }
  return text;
}

std::string junit_xml(const std::string& suite, const std::string& file,
                      std::span<const CheckedValue> values) {
  const auto failures = std::ranges::count(values, false, &CheckedValue::is_met);
  const std::string counts = fmt::format("tests=\"{}\" failures=\"{}\"", values.size(), failures);
  const std::string name = html_escaped(suite);
  std::string xml = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {0}>\n  <testsuite name=\"{1}\" "
      "{0} errors=\"0\" skipped=\"0\" file=\"{2}\">\n",
      counts, name, html_escaped(file));
  for (const CheckedValue& value : values) {
    xml += fmt::format("    <testcase classname=\"{}\" name=\"{}\"", name, html_escaped(value.key));
    if (value.is_met) {
      xml += "/>\n";
      continue;
    }
    xml += fmt::format(
        ">\n      <failure message=\"{}\"/>\n    </testcase>\n",
        html_escaped(fmt::format("expected {}, found {}", value.expected, value.found)));
  }
  return xml + "  </testsuite>\n</testsuites>\n";
}

}  // namespace vpr
