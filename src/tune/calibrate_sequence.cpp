#include "tune/calibrate_sequence.h"

#include <algorithm>
#include <cassert>
#include <functional>

#include "base/error.h"
#include "base/monitor.h"
#include "evaluate/outcomes.h"
#include "tune/calibration.h"

namespace vpr {
namespace {

// The contribution of one query window. `unknown_place`: its margin if its place were not trained.
CalibrationWindow evidence_at(const Result& result, const std::optional<uint32_t>& unknown_place,
                              const GroundTruth& truth, size_t window) {
  CalibrationWindow evidence;
  if (unknown_place) evidence.unknown_place = *unknown_place;
  if (!result.best[window] || !result.margins[window]) return evidence;
  const auto margin = static_cast<int64_t>(*result.margins[window]);
  // A short path has a margin of 0.
  if (result.path && margin == 0) return evidence;
  const PlaceLabel label = label_of(truth, *result.best[window], result.window_length());
  if (label == PlaceLabel::same) evidence.correct = margin;
  if (label == PlaceLabel::different) evidence.incorrect = margin;
  return evidence;
}

// `plan` accepts all best matches.
CalibratedLength calibrate_length(QueryPlan plan, const ResolvedSettings& settings,
                                  const GroundTruth& truth, double precision,
                                  const QueryResources& resources, const Monitor& monitor) {
  constexpr size_t kPathBlock = 40;  // query frames with dependent positions on a path
  const bool has_path = std::holds_alternative<ByPath>(plan.decision);
  const size_t window_length = plan.match.window_length;
  CalibratedLength length;
  length.settings = *settings;
  length.windows = plan.query_windows;
  length.block =
      std::min(has_path ? kPathBlock : window_length, std::max<size_t>(length.windows, 1));
  UnknownPlaceScan scan(truth, *plan.exclusion_zones, window_length, length.windows,
                        resources.kernels);
  Sinks observers;
  if (!has_path) observers.rows.push_back(std::ref(scan));
  const Result result = run_query(std::move(plan), settings, resources, observers, monitor).result;
  const std::vector<std::optional<uint32_t>> unknown_place = scan.result();
  std::vector<CalibrationWindow> evidence;
  for (size_t window = 0; window < length.windows; ++window) {
    length.queries += truth.has_match(anchor_of(window, window_length)) ? 1 : 0;
    evidence.push_back(evidence_at(result, unknown_place[window], truth, window));
  }
  const ScoreKind& score = score_kind(length.settings.score);
  const int64_t least =
      has_path ? static_cast<int64_t>(kFilterMargin / score.frame_value(1, 1)) : 1;
  length.calibration = calibrate(evidence, {precision, least, length.block, resources.seed});
  if (const auto strength = length.calibration.strength)
    length.settings.margin = score.frame_value(static_cast<double>(*strength), window_length);
  return length;
}

// The shortest sufficient length: a shorter window reports earlier.
std::optional<size_t> choose_length(const std::vector<CalibratedLength>& lengths) {
  constexpr double kEnough = 0.7;  // chosen on rendered buildings (docs/reference/methods.md)
  const auto right = [](const CalibratedLength& length) {
    return length.calibration.strength ? static_cast<double>(length.calibration.correct) : 0;
  };
  double most = 0;
  for (const CalibratedLength& length : lengths) most = std::max(most, right(length));
  for (size_t l = 0; most > 0 && l < lengths.size(); ++l)
    if (right(lengths[l]) >= kEnough * most) return l;
  return std::nullopt;
}

}  // namespace

CalibratedSequence calibrate_sequence(const SequenceDatabase& database, const DescriptorSet& query,
                                      const std::string& query_name, const ResolvedSettings& base,
                                      std::vector<uint64_t> lengths, double precision,
                                      const TruthReader& read_truth,
                                      const QueryResources& resources, const Monitor& monitor) {
  assert(base->decision == Decision::margin);
  if (!(precision > 0 && precision <= 1))
    throw Error(ErrorKind::usage, "precision must be above 0 and at most 1, found {}", precision);
  if (has_paths(*base)) lengths = {1};
  std::sort(lengths.begin(), lengths.end());
  CalibratedSequence calibrated;
  calibrated.query = query.sequence;
  calibrated.query.name = query_name;
  std::optional<GroundTruth> truth;
  for (const uint64_t length : lengths) {
    const Monitor part = part_of(monitor, "c_l", calibrated.lengths.size(), lengths.size());
    SequenceQuerySettings changed = *base;
    changed.window_length = length;
    changed.margin = 0;
    const ResolvedSettings settings(changed);
    QueryPlan plan = plan_query(database, query, query_name, settings, resources, part);
    if (!truth) truth = read_truth(scope_of(make_result(plan, settings)));
    calibrated.lengths.push_back(
        calibrate_length(std::move(plan), settings, *truth, precision, resources, part));
  }
  if (std::ranges::none_of(calibrated.lengths, [](const auto& one) { return one.queries > 0; }))
    throw Error(ErrorKind::usage,
                "{}: shows no trained place according to the ground truth. Use a sequence that "
                "passes trained places.",
                query_name);
  calibrated.protocol = truth->protocol;
  calibrated.chosen = choose_length(calibrated.lengths);
  return calibrated;
}

}  // namespace vpr
