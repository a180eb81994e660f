// docs/schemas/*.schema.json are made from the fields of structs; those of files that scripts
// write, and of --expect, are written by hand.
#include <cstdlib>
#include <fstream>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json_schema.h"
#include "bench/benches.h"
#include "eval/eval.h"
#include "evaluate/metrics.h"
#include "fabmap/place_query.h"
#include "loops/loops_report.h"
#include "present/comparison_report.h"
#include "present/database_report.h"
#include "query/live_lines.h"
#include "query/setting_rows.h"
#include "query/train_sequences.h"
#include "support.h"
#include "synth/recording.h"
#include "truth/dataset.h"
#include "tune/sweep_report.h"
#include "tune/trials.h"

using namespace vpr;
using namespace vpr::test;

namespace {

/// The settings of a command together with the common options.
template <class... S>
Json config_of(S... settings) {
  SchemaVisitor visit{SchemaForm::partial};
  visit("schema", Derived{schema_name("config")});
  (visit_fields(settings, visit), ...);
  ProcessSettings process;
  visit_fields(process, visit);
  return visit.object;
}

// A configuration file may lack "schema".
Json config_schema() {
  const std::vector<Json> commands = {config_of(SequenceKeys(), FabmapQuerySettings()),
                                      config_of(SequenceTrainSettings()),
                                      config_of(FabmapTrainSettings()),
                                      merged(config_of(), eval_config_schema()),
                                      config_of(MatchingBenchSettings()),
                                      config_of(DescribeBenchSettings()),
                                      config_of(FabmapBenchSettings()),
                                      config_of(RealtimeBenchSettings()),
                                      config_of(TrainingBenchSettings())};
  Json schema = file_schema(
      "Settings for --config: any keys that a program accepts. A result is a configuration as "
      "well: its settings and its seed.",
      commands);
  for (Json& command : schema["anyOf"]) command.erase("required");
  return schema;
}

std::vector<std::pair<std::string, Json>> schemas() {
  std::vector<std::pair<std::string, Json>> files = {{"config", config_schema()}};
  const auto add = [&](const char* kind, const char* title, const std::vector<Json>& all) {
    files.emplace_back(kind, file_schema(title, all));
  };
  add("bench", "What vpr-bench measured", {bench_schema()});
  add("bench-comparison", "Two runs of vpr-bench compared", {bench_comparison_schema()});
  add("comparison", "What vpr-eval compare finds", {comparison_schema()});
  add("comparisons", "What vpr-eval compare finds in reports on several data sets",
      {comparisons_schema()});
  add("conversion", "What vpr-eval convert --json prints", {conversion_schema()});
  add("database", "manifest.json of a database",
      {sequence_manifest_schema(), fabmap_manifest_schema()});
  add("database-info", "What vpr-train --json prints of a database",
      {sequence_info_schema(), fabmap_info_schema()});
  add("dataset", "Data set description: sequences that belong together, and their ground truth",
      {dataset_schema()});
  add("ground-truth-check", "What vpr-eval check finds", {check_schema()});
  add("live", "One line of vpr-query live: what is said of a query frame as soon as it has come",
      {live_schema()});
  add("loops", "Loop closures of a SLAM system against a trajectory", {loops_schema()});
  add("report", "Evaluation report of vpr-eval: of a result, or of a score matrix of any program",
      {report_schema()});
  add("reports", "Several results in one table: vpr-eval RESULT RESULT...", {reports_schema()});
  add("result", "Result of vpr-query, by any method", {result_schema()});
  add("sweep", "Counts over a grid of settings", {sweep_schema()});
  add("thresholds", "Automatic thresholds and where they come from", {thresholds_schema()});
  add("tuning", "Frames that different settings recognize, and the choice", {trials_schema()});
  add("world", "World of vpr-synth", {world_schema()});
  add("world-info", "What vpr-synth --json prints of a rendered world", {world_info_schema()});
  return files;
}

// The help of a flag describes a setting without its own description.
void add_help(Json& node) {
  if (node.is_object() && node.contains("properties"))
    for (const auto& [key, property] : node["properties"].items()) {
      if (property.contains("description") || property.contains("const")) continue;
      for (const auto rows : {sequence_setting_rows(), fabmap_setting_rows()})
        for (const SettingRow& row : rows)
          if (row.key == key && !property.contains("description")) {
            Json described = {{"description", sentence(row.help)}};
            described.update(property);
            property = described;
          }
      INFO(key);
      CHECK(property.contains("description"));
    }
  if (node.is_structured())
    for (Json& child : node) add_help(child);
}

size_t depth(const Json& node) {
  size_t most = 0;
  for (const Json& child : node)
    if (child.is_structured()) most = std::max(most, depth(child));
  return most + 1;
}

// Two spaces of indentation; objects of up to two levels are on one line.
std::string formatted(const Json& node, const std::string& indent = "") {
  const bool is_line = !node.is_structured() || depth(node) <= 2;
  if (!node.is_structured()) return node.dump();
  std::string text;
  const std::string inner = is_line ? "" : indent + "  ";
  for (const auto& item : node.items()) {
    text += text.empty() ? (is_line ? "" : "\n") : (is_line ? ", " : ",\n");
    text += inner + (node.is_object() ? Json(item.key()).dump() + ": " : "") +
            formatted(item.value(), inner);
  }
  if (!is_line) text += "\n" + indent;
  return node.is_object() ? "{" + text + "}" : "[" + text + "]";
}

}  // namespace

TEST_CASE("docs/schemas has the schemas of all fields") {
  const bool writes = std::getenv("VPR_SCHEMAS") != nullptr;
  for (auto& [kind, schema] : schemas()) {
    INFO(kind << ": run scripts/generate.sh");
    add_help(schema);
    const auto path = source_path(fmt::format("docs/schemas/{}.schema.json", kind));
    if (writes) std::ofstream(path) << formatted(schema) + "\n";
    CHECK(read_text(path) == formatted(schema) + "\n");
  }
}

TEST_CASE("every measure has its key in the reference") {
  const std::string reference = read_text(source_path("docs/reference/metrics.md"));
  for (const Metric& metric : metrics()) {
    const std::string key(metric.key.substr(metric.key.find('.') + 1));
    INFO(key);
    CHECK(has(reference, "`" + key));
  }
}
