// Any bytes as a file for vpr-eval --expect, compared with a report.
#include "base/json.h"
#include "evaluate/expectation.h"
#include "fuzz.h"

using namespace vpr;

namespace {

/// A report of a score matrix has keys that reports of results do not have, and vice versa.
const Json& report() {
  static const Json kReport = {
      {"schema", "vpr.report/5"},
      {"method", "fastable"},
      {"settings", {{"method", "fastable"}, {"c_l", 3}, {"t_r", "auto"}}},
      {"counts",
       {{"recognitions", {{"correct", 9}, {"incorrect", 1}, {"ignored", 0}}},
        {"places", {{"correct", 2}, {"incorrect", 0}, {"ignored", 0}}},
        {"distinct", 2}}},
      {"best_match", {{"queries", 20}, {"correct", 15}, {"rate", 0.75}}},
      {"metrics", {{"single_best", {{"average_precision", 0.5}, {"roc_auc", nullptr}}}}},
      {"localization", {{"frames", 22}, {"share", 0.5}}},
      {"protocol", {{"ground_truth", "pairs"}, {"tolerance_frames", 0}}},
      {"provenance", {{"ground_truth", "xxh3:0"}}}};
  return kReport;
}

}  // namespace

void fuzz::run(std::string_view input) {
  const Json expected = read_json(memory_file(input), ErrorKind::usage);
  unmet_expectations(check_expectations(report(), expected, "expected"));
  const Json updated = updated_expectations(report(), expected, "expected");
  if (!unmet_expectations(check_expectations(report(), updated, "updated")).empty()) std::abort();
}
