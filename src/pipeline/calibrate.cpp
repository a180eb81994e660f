#include "pipeline/calibrate.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/step_parts.h"
#include "evaluation/counts.h"
#include "evaluation/labelled_scan.h"

namespace vpr {
namespace {

constexpr size_t kPathBlock = 40;  // query frames that a path of the filter holds together
constexpr double kNothing = -60;   // a mean z that no window has

// Of the windows that the best length recognises. Chosen on rendered buildings (docs/methods.md).
constexpr double kEnough = 0.7;

void check_precision(double precision) {
  if (!(precision > 0 && precision <= 1))
    throw Error(ErrorKind::usage,
                fmt::format("precision must be above 0 and at most 1, found {}", precision));
}

bool is_by_margin(const SequenceQuerySettings& settings) {
  return decision_kind(settings.decision).accepts != nullptr;
}

// Of margins all are accepted, and looked at; of thresholds nothing is.
SequenceQuerySettings open_settings(const SequenceQuerySettings& base, uint64_t length) {
  SequenceQuerySettings settings = with_implied(base);
  if (!has_paths(settings.method)) settings.window_length = length;
  settings.distance_threshold.reset();
  settings.threshold_scale.reset();
  settings.threshold_share.reset();
  settings.margin.reset();
  if (is_by_margin(settings)) {
    settings.margin = 0;
    settings.margin_support = can_ask_last_frames(settings);
    return settings;
  }
  const bool is_raw = !score_kind(settings.score).needs_statistics;
  settings.safety_factor.reset();
  settings.safety_margin = 0;
  settings.distance_threshold = is_raw ? 0 : kNothing;
  settings.threshold_scale = is_raw ? ThresholdScale::bits : ThresholdScale::mean_z;
  return settings;
}

/// What a query with open settings found.
struct Labelled {
  Result result;
  std::vector<LabelledWindow> windows;
  int64_t score_offset = 0;
};

Labelled label_walk(QueryPlan plan, const GroundTruth& truth, const QueryResources& resources,
                    const Monitor& monitor) {
  Labelled labelled;
  labelled.score_offset = plan.score_offset();
  const size_t windows = plan.query_windows;
  LabelledScan scan(truth, *plan.elsewhere, plan.settings.window_length, windows, resources.kernels,
                    plan.settings.margin_support);
  const bool has_rows = !has_paths(plan.settings.method);
  const std::vector<RowConsumer> observers =
      has_rows ? std::vector<RowConsumer>{std::ref(scan)} : std::vector<RowConsumer>{};
  labelled.result = run_query(std::move(plan), resources, observers, monitor).result;
  labelled.windows = scan.result();
  return labelled;
}

// A margin of the filter is 0 where no path is believed: nothing is recognised there.
CalibrationWindow by_margin(const Labelled& labelled, const GroundTruth& truth, size_t window) {
  const Result& result = labelled.result;
  CalibrationWindow evidence;
  if (const auto& untrained = labelled.windows[window].untrained_margin)
    evidence.untrained = *untrained;
  if (!result.best[window] || !result.margins[window]) return evidence;
  const auto margin = static_cast<int64_t>(*result.margins[window]);
  if (result.path && margin == 0) return evidence;
  const PlaceLabel label = label_of(truth, *result.best[window], result.window_length());
  if (label == PlaceLabel::same) evidence.right = margin;
  if (label == PlaceLabel::different) evidence.wrong = margin;
  return evidence;
}

CalibrationWindow by_score(const LabelledWindow& window) {
  CalibrationWindow evidence;
  if (window.right) evidence.right = -static_cast<int64_t>(*window.right);
  if (window.wrong) evidence.wrong = -static_cast<int64_t>(*window.wrong);
  return evidence;
}

std::vector<CalibrationWindow> evidence_of(const Labelled& labelled, const GroundTruth& truth) {
  std::vector<CalibrationWindow> evidence;
  for (size_t window = 0; window < labelled.result.query_windows; ++window)
    evidence.push_back(is_by_margin(std::get<SequenceQuerySettings>(labelled.result.settings))
                           ? by_margin(labelled, truth, window)
                           : by_score(labelled.windows[window]));
  return evidence;
}

// Of the windows that have something elsewhere, the share where it is closer than the limit.
double share_below(const Result& result, double limit) {
  size_t windows = 0;
  size_t below = 0;
  for (size_t window = 0; window < result.best.size(); ++window) {
    if (!result.best[window] || !result.margins[window]) continue;
    ++windows;
    if (result.best[window]->score + *result.margins[window] < limit) ++below;
  }
  return windows == 0 ? 1 : static_cast<double>(below) / static_cast<double>(windows);
}

// The strength as the number that a query takes.
void set_threshold(SequenceQuerySettings& settings, const Labelled& labelled, int64_t strength) {
  const ScoreKind& kind = score_kind(settings.score);
  const size_t length = settings.window_length;
  if (is_by_margin(settings)) {
    settings.threshold_scale.reset();  // a plan names it
    settings.margin = kind.frame_value(static_cast<double>(strength), length);
    return;
  }
  // What is accepted is strictly below the limit.
  const auto limit = static_cast<double>(1 - strength - labelled.score_offset);
  settings.distance_threshold = kind.frame_value(limit, length);
  if (kind.needs_statistics)
    settings.distance_threshold = std::min(0.0, *settings.distance_threshold);
  settings.threshold_share = share_below(labelled.result, limit);
}

size_t block_of(const SequenceQuerySettings& settings, size_t windows) {
  const size_t block = has_paths(settings.method) ? kPathBlock : settings.window_length;
  return std::min(block, std::max<size_t>(windows, 1));
}

// The least margin there is; of the filter, its default.
std::optional<int64_t> least_strength(const SequenceQuerySettings& settings) {
  if (!is_by_margin(settings)) return std::nullopt;
  if (!has_paths(settings.method)) return 1;
  return static_cast<int64_t>(kFilterMargin / score_kind(settings.score).frame_value(1, 1));
}

// Windows recognised with the settings that were found.
void count_windows(Calibration& calibration, const Result& result, const GroundTruth& truth) {
  std::vector<uint8_t> right(result.query_windows, 0);
  std::vector<uint8_t> wrong(result.query_windows, 0);
  for (const Match& hit : result.hits) {
    const PlaceLabel label = label_of(truth, hit, result.window_length());
    if (label == PlaceLabel::same) right[hit.query] = 1;
    if (label == PlaceLabel::different) wrong[hit.query] = 1;
  }
  calibration.right = calibration.wrong = 0;
  for (size_t window = 0; window < right.size(); ++window) {
    calibration.right += right[window] != 0 && wrong[window] == 0 ? 1 : 0;
    calibration.wrong += wrong[window];
  }
}

size_t known_windows(const GroundTruth& truth, const Result& result) {
  size_t known = 0;
  for (size_t window = 0; window < result.query_windows; ++window)
    known += truth.has_match(anchor_of(window, result.window_length())) ? 1 : 0;
  return known;
}

/// A query, and by what its windows are judged.
struct LabelledQuery {
  const SequenceDatabase& database;
  const DescriptorSet& query;
  const std::string& name;
  const GroundTruth& truth;
  const QueryResources& resources;
};

CalibratedLength calibrate_length(QueryPlan plan, const LabelledQuery& walk, double precision,
                                  const Monitor& monitor) {
  CalibratedLength length;
  length.settings = plan.settings;
  length.windows = plan.query_windows;
  length.block = block_of(length.settings, length.windows);
  const Labelled labelled = label_walk(std::move(plan), walk.truth, walk.resources, monitor);
  length.queries = known_windows(walk.truth, labelled.result);
  const CalibrationSettings settings = {precision, least_strength(length.settings), length.block,
                                        walk.resources.seed};
  length.calibration = calibrate(evidence_of(labelled, walk.truth), settings);
  if (!length.calibration.strength) return length;
  set_threshold(length.settings, labelled, *length.calibration.strength);
  const Result again = run_query(plan_query(walk.database, walk.query, walk.name, length.settings,
                                            walk.resources, monitor),
                                 walk.resources, {}, monitor)
                           .result;
  count_windows(length.calibration, again, walk.truth);
  return length;
}

// A shorter window says sooner where one is, and sooner that one is elsewhere. Where last frames
// are asked, the most are taken: they say sooner, too, that one is elsewhere.
std::optional<size_t> choose_length(const std::vector<CalibratedLength>& lengths) {
  const auto found = [](const CalibratedLength& length) {
    return length.calibration.strength ? static_cast<double>(length.calibration.right) : 0;
  };
  const bool has_supported = std::any_of(lengths.begin(), lengths.end(), [&](const auto& length) {
    return length.settings.margin_support && found(length) > 0;
  });
  const auto right = [&](const CalibratedLength& length) {
    return has_supported && !length.settings.margin_support ? 0 : found(length);
  };
  double most = 0;
  for (const CalibratedLength& length : lengths) most = std::max(most, right(length));
  for (size_t l = 0; most > 0 && l < lengths.size(); ++l)
    if (right(lengths[l]) >= (has_supported ? 1 : kEnough) * most) return l;
  return std::nullopt;
}

}  // namespace

CalibratedWalk calibrate_walk(const SequenceDatabase& database, const DescriptorSet& query,
                              const std::string& query_name, const SequenceQuerySettings& base,
                              std::vector<uint64_t> lengths, double precision,
                              const TruthReader& read_truth, const QueryResources& resources,
                              const Monitor& monitor) {
  check_precision(precision);
  if (has_paths(base.method)) lengths = {1};
  std::sort(lengths.begin(), lengths.end());
  CalibratedWalk walk;
  walk.query_name = query_name;
  walk.replay = query.frames.replay;
  std::optional<GroundTruth> truth;
  bool is_known = false;
  for (const uint64_t length : lengths) {
    const Monitor part = part_of(monitor, "c_l", walk.lengths.size(), lengths.size());
    QueryPlan plan =
        plan_query(database, query, query_name, open_settings(base, length), resources, part);
    if (!truth) truth = read_truth(scope_of(make_result(plan)));
    const LabelledQuery labelled = {database, query, query_name, *truth, resources};
    walk.lengths.push_back(calibrate_length(std::move(plan), labelled, precision, part));
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
