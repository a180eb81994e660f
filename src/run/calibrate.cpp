#include "run/calibrate.h"

#include <algorithm>
#include <cassert>
#include <functional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/monitor.h"
#include "evaluate/counts.h"
#include "evaluate/matrix_scan.h"

namespace vpr {
namespace {

constexpr size_t kPathBlock = 40;  // query frames that a path of the filter holds together

// Of the windows that the best length recognizes. Chosen on rendered buildings (docs/methods.md).
constexpr double kEnough = 0.7;

void check_precision(double precision) {
  if (!(precision > 0 && precision <= 1))
    throw Error(ErrorKind::usage,
                fmt::format("precision must be above 0 and at most 1, found {}", precision));
}

// All best matches are accepted.
SequenceQuerySettings open_settings(const ResolvedSettings& base, uint64_t length) {
  SequenceQuerySettings settings = *base;
  settings.window_length = length;
  settings.margin = 0;
  return settings;
}

/// What a query with open settings found.
struct Labeled {
  Result result;
  std::vector<std::optional<uint32_t>> untrained;
};

Labeled label_walk(QueryPlan plan, const GroundTruth& truth, const QueryResources& resources,
                   const Monitor& monitor) {
  Labeled labeled;
  const size_t windows = plan.query_windows;
  LabeledScan scan(truth, *plan.elsewhere, plan.match.window_length, windows, resources.kernels);
  Sinks observers;
  if (!plan.match.method->has_paths) observers.rows.push_back(std::ref(scan));
  labeled.result = run_query(std::move(plan), resources, observers, monitor).result;
  labeled.untrained = scan.result();
  return labeled;
}

// A margin of the filter is 0 where no path is believed: nothing is recognized there.
CalibrationWindow evidence_at(const Labeled& labeled, const GroundTruth& truth, size_t window) {
  const Result& result = labeled.result;
  CalibrationWindow evidence;
  if (const auto& untrained = labeled.untrained[window]) evidence.untrained = *untrained;
  if (!result.best[window] || !result.margins[window]) return evidence;
  const auto margin = static_cast<int64_t>(*result.margins[window]);
  if (result.path && margin == 0) return evidence;
  const PlaceLabel label = label_of(truth, *result.best[window], result.window_length());
  if (label == PlaceLabel::same) evidence.right = margin;
  if (label == PlaceLabel::different) evidence.wrong = margin;
  return evidence;
}

std::vector<CalibrationWindow> evidence_of(const Labeled& labeled, const GroundTruth& truth) {
  std::vector<CalibrationWindow> evidence;
  for (size_t window = 0; window < labeled.result.query_windows; ++window)
    evidence.push_back(evidence_at(labeled, truth, window));
  return evidence;
}

size_t block_of(const SequenceQuerySettings& settings, size_t windows) {
  const size_t block = has_paths(settings.method) ? kPathBlock : settings.window_length;
  return std::min(block, std::max<size_t>(windows, 1));
}

// The least margin there is; of the filter, its default.
int64_t least_strength(const SequenceQuerySettings& settings) {
  if (!has_paths(settings.method)) return 1;
  return static_cast<int64_t>(kFilterMargin / score_kind(settings.score).frame_value(1, 1));
}

size_t known_windows(const GroundTruth& truth, const Result& result) {
  size_t known = 0;
  for (size_t window = 0; window < result.query_windows; ++window)
    known += truth.has_match(anchor_of(window, result.window_length())) ? 1 : 0;
  return known;
}

/// A query, and by what its windows are judged.
struct LabeledQuery {
  const SequenceDatabase& database;
  const DescriptorSet& query;
  const std::string& name;
  const GroundTruth& truth;
  const QueryResources& resources;
};

CalibratedLength calibrate_length(QueryPlan plan, const LabeledQuery& walk, double precision,
                                  const Monitor& monitor) {
  CalibratedLength length;
  length.settings = plan.settings;
  length.windows = plan.query_windows;
  length.block = block_of(length.settings, length.windows);
  const Labeled labeled = label_walk(std::move(plan), walk.truth, walk.resources, monitor);
  length.queries = known_windows(walk.truth, labeled.result);
  const CalibrationSettings settings = {precision, least_strength(length.settings), length.block,
                                        walk.resources.seed};
  length.calibration = calibrate(evidence_of(labeled, walk.truth), settings);
  if (!length.calibration.strength) return length;
  length.settings.margin = score_kind(length.settings.score)
                               .frame_value(static_cast<double>(*length.calibration.strength),
                                            length.settings.window_length);
  return length;
}

// A shorter window answers earlier.
std::optional<size_t> choose_length(const std::vector<CalibratedLength>& lengths) {
  const auto right = [](const CalibratedLength& length) {
    return length.calibration.strength ? static_cast<double>(length.calibration.right) : 0;
  };
  double most = 0;
  for (const CalibratedLength& length : lengths) most = std::max(most, right(length));
  for (size_t l = 0; most > 0 && l < lengths.size(); ++l)
    if (right(lengths[l]) >= kEnough * most) return l;
  return std::nullopt;
}

}  // namespace

CalibratedWalk calibrate_walk(const SequenceDatabase& database, const DescriptorSet& query,
                              const std::string& query_name, const ResolvedSettings& base,
                              std::vector<uint64_t> lengths, double precision,
                              const TruthReader& read_truth, const QueryResources& resources,
                              const Monitor& monitor) {
  assert(base->decision == Decision::margin);
  check_precision(precision);
  if (has_paths(base->method)) lengths = {1};
  std::sort(lengths.begin(), lengths.end());
  CalibratedWalk walk;
  walk.query = query.sequence;
  walk.query.name = query_name;
  std::optional<GroundTruth> truth;
  bool is_known = false;
  for (const uint64_t length : lengths) {
    const Monitor part = part_of(monitor, "c_l", walk.lengths.size(), lengths.size());
    QueryPlan plan =
        plan_query(database, query, query_name, open_settings(base, length), resources, part);
    if (!truth) truth = read_truth(scope_of(make_result(plan)));
    const LabeledQuery labeled = {database, query, query_name, *truth, resources};
    walk.lengths.push_back(calibrate_length(std::move(plan), labeled, precision, part));
    is_known = is_known || walk.lengths.back().queries > 0;
  }
  if (!is_known)
    throw Error(ErrorKind::usage,
                fmt::format("{}: shows no trained place by the ground truth, so nothing says how "
                            "strong right matches are; give a walk that passes trained places",
                            query_name));
  walk.protocol = truth->protocol;
  walk.chosen = choose_length(walk.lengths);
  return walk;
}

}  // namespace vpr
