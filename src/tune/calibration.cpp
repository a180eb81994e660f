#include "tune/calibration.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/monitor.h"
#include "base/text.h"
#include "evaluate/outcomes.h"
#include "present/evaluation_text.h"
#include "sequence/sequence_json.h"

namespace vpr {
namespace {

constexpr size_t kMaxFolds = 200;  // limits the time

/// Windows [first, end) are excluded.
struct Gap {
  size_t first = 0;
  size_t end = 0;

  bool holds(size_t window) const { return first <= window && window < end; }
};

struct WindowCounts {
  int64_t correct = 0;
  int64_t incorrect = 0;
};

bool reaches(const std::optional<int64_t>& margin, int64_t strength) {
  return margin && *margin >= strength;
}

std::optional<int64_t> choose(std::span<const CalibrationWindow> windows, const Gap& gap,
                              const CalibrationSettings& settings) {
  int64_t above_all = settings.least;
  std::map<int64_t, WindowCounts, std::greater<>> changes;  // from the largest strength on
  for (size_t w = 0; w < windows.size(); ++w) {
    if (gap.holds(w)) continue;
    const CalibrationWindow& window = windows[w];
    for (const auto& strength : {window.incorrect, window.unknown_place})
      if (strength) above_all = std::max(above_all, *strength + 1);
    if (settings.precision == 1) continue;
    if (window.correct) ++changes[*window.correct].correct;
    if (window.incorrect) ++changes[*window.incorrect].incorrect;
  }
  if (settings.precision == 1) return above_all;
  std::optional<int64_t> chosen;
  WindowCounts sum;
  for (const auto& [strength, change] : changes) {
    if (strength < settings.least) break;
    sum.correct += change.correct;
    sum.incorrect += change.incorrect;
    if (sum.correct > 0 &&
        static_cast<double>(sum.correct) >=
            settings.precision * static_cast<double>(sum.correct + sum.incorrect))
      chosen = strength;
  }
  return chosen;
}

// Cross-validation: the strength for each fold is chosen without the fold and a block around it.
FalseRecognitions expect(std::span<const CalibrationWindow> windows,
                         const CalibrationSettings& settings) {
  std::vector<double> begins(windows.size(), 0);  // 1 where a run of incorrect windows begins
  FalseRecognitions expected;
  bool was_wrong = false;
  const size_t size = std::max(settings.block, (windows.size() + kMaxFolds - 1) / kMaxFolds);
  for (size_t first = 0; first < windows.size(); first += size) {
    const size_t end = std::min(first + size, windows.size());
    const Gap gap = {first - std::min(first, settings.block), end + settings.block};
    const std::optional<int64_t> strength = choose(windows, gap, settings);
    for (size_t w = first; w < end; ++w) {
      const bool is_wrong_now = strength && reaches(windows[w].incorrect, *strength);
      if (is_wrong_now && !was_wrong) {
        begins[w] = 1;
        ++expected.seen;
      }
      was_wrong = is_wrong_now;
    }
  }
  const Interval drawn = bootstrap_sum(begins, settings.block, settings.seed);
  const Interval counted = poisson_interval(expected.seen);
  expected.interval = {std::min(drawn.low, counted.low), std::max(drawn.high, counted.high)};
  return expected;
}

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
CalibratedLength calibrate_length(const QueryPlan& plan, const GroundTruth& truth, double precision,
                                  const Monitor& monitor) {
  constexpr size_t kPathBlock = 40;  // query frames with dependent positions on a path
  const bool has_path = std::holds_alternative<ByPath>(plan.decision);
  const size_t window_length = plan.match.window_length;
  CalibratedLength length;
  length.settings = std::get<SequenceQuerySettings>(plan.result.settings);
  length.windows = plan.result.query_windows;
  length.block =
      std::min(has_path ? kPathBlock : window_length, std::max<size_t>(length.windows, 1));
  UnknownPlaceScan scan(truth, *plan.exclusion_zones, window_length, length.windows);
  Sinks observers;
  if (!has_path) observers.rows.push_back(std::ref(scan));
  const Result result = run_query(plan, observers, monitor).result;
  const std::vector<std::optional<uint32_t>> unknown_place = scan.result();
  std::vector<CalibrationWindow> evidence;
  for (size_t window = 0; window < length.windows; ++window) {
    length.queries += truth.has_match(anchor_of(window, window_length)) ? 1 : 0;
    evidence.push_back(evidence_at(result, unknown_place[window], truth, window));
  }
  const ScoreKind& score = score_kind(length.settings.score);
  const int64_t least =
      has_path ? static_cast<int64_t>(kFilterMargin / score.frame_value(1, 1)) : 1;
  length.calibration = calibrate(evidence, {precision, least, length.block, plan.match.seed});
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

// The reason for a missing margin.
const char* failure_of(const std::vector<CalibratedLength>& lengths) {
  // The length with the most queries is the best explanation.
  if (std::ranges::max_element(lengths, {}, &CalibratedLength::queries)->calibration.advice ==
      CalibrationAdvice::no_right_recognition)
    return "no window is recognized correctly; check that the ground truth belongs to this query";
  return "at every setting that recognizes a window correctly, others are incorrect, or would be "
         "if their place were not trained";
}

constexpr double kSecondsPerHour = 3600;

/// False recognitions to expect in another number of windows.
struct ScaledRate {
  double expected = 0;
  Interval interval;
};

ScaledRate rate_of(const CalibratedLength& length, double windows) {
  const FalseRecognitions& found = length.calibration.expected;
  const double factor = windows / static_cast<double>(length.windows);
  return {static_cast<double>(found.seen) * factor,
          {found.interval.low * factor, found.interval.high * factor}};
}

Json rate_json(const ScaledRate& rate) {
  return {{"expected", rate.expected}, {"interval", {rate.interval.low, rate.interval.high}}};
}

Json length_json(const CalibratedLength& length) {
  const Calibration& found = length.calibration;
  Json json = {{"c_l", length.settings.window_length},
               {"windows", length.windows},
               {"queries", length.queries},
               {"advice", enum_name(found.advice)},
               {"margin", nullptr}};
  if (!found.strength) return json;
  json["margin"] = *length.settings.margin;
  json["recognized"] = {{"correct", found.correct}, {"incorrect", found.incorrect}};
  json["false_recognitions"] = {
      {"block", length.block},
      {"seen", found.expected.seen},
      {"interval", {found.expected.interval.low, found.expected.interval.high}}};
  return json;
}

}  // namespace

TruthReader reader_of(const EvaluationSettings& by, const Monitor& monitor) {
  return
      [by, &monitor](const GroundTruthScope& scope) { return whole_truth_of(by, scope, monitor); };
}

void UnknownPlaceScan::operator()(std::span<const ScoreRow> row) {
  const size_t anchor = window_length_ - 1;
  std::vector<ScoreRow> unknown_place;
  for (const ScoreRow& piece : row) {
    const size_t width = zones_.widths[piece.sequence];
    const size_t first = piece.train_window + anchor;  // frames of the piece: [first, end)
    const size_t end = first + piece.scores.size();
    size_t next = first;
    for (const LabelStretch& run :
         label_runs(truth_, piece.query_window + anchor, piece.sequence, end + width)) {
      const size_t begin = run.first - std::min(run.first, width);
      if (begin > next) unknown_place.push_back(part_of_row(piece, next - first, begin - next));
      next = std::max(next, run.last + width + 1);
    }
    if (next < end) unknown_place.push_back(part_of_row(piece, next - first, end - next));
  }
  if (!unknown_place.empty()) untrained_(unknown_place);
}

Calibration calibrate(std::span<const CalibrationWindow> windows,
                      const CalibrationSettings& settings) {
  assert(settings.precision > 0 && settings.precision <= 1 && settings.block > 0);
  Calibration found;
  if (const std::optional<int64_t> strength = choose(windows, {}, settings)) {
    for (const CalibrationWindow& window : windows) {
      found.correct += reaches(window.correct, *strength) ? 1 : 0;
      found.incorrect += reaches(window.incorrect, *strength) ? 1 : 0;
    }
    found.strength = strength;
  }
  if (found.correct > 0) {
    found.advice = CalibrationAdvice::calibrated;
    found.expected = expect(windows, settings);
    return found;
  }
  found.strength.reset();
  if (std::ranges::any_of(windows, [&](const CalibrationWindow& window) {
        return reaches(window.correct, settings.least);
      }))
    found.advice = CalibrationAdvice::none_is_safe;
  return found;
}

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
  calibrated.precision = precision;
  std::optional<GroundTruth> truth;
  for (const uint64_t length : lengths) {
    const Monitor part = part_of(monitor, "c_l", calibrated.lengths.size(), lengths.size());
    SequenceQuerySettings changed = *base;
    changed.window_length = length;
    changed.margin = 0;
    const QueryPlan plan =
        plan_query(database, query, query_name, ResolvedSettings(changed), resources, part);
    if (!truth) truth = read_truth(scope_of(plan.result));
    calibrated.lengths.push_back(calibrate_length(plan, *truth, precision, part));
  }
  if (std::ranges::none_of(calibrated.lengths, [](const auto& one) { return one.queries > 0; }))
    throw Error(ErrorKind::usage,
                "{}: shows no trained place according to the ground truth. Use a sequence that "
                "passes trained places.",
                query_name);
  const std::optional<size_t> chosen = choose_length(calibrated.lengths);
  if (!chosen)
    throw Error(ErrorKind::expectation, "{}: no margin: {}", query_name,
                failure_of(calibrated.lengths));
  calibrated.protocol = truth->protocol;
  calibrated.chosen = *chosen;
  return calibrated;
}

Json calibration_json(const CalibratedSequence& calibrated, const RunInfo& run, double seconds) {
  const CalibratedLength& chosen = calibrated.lengths[calibrated.chosen];
  Json json = {{"schema", schema_name("calibration")},
               {"settings", settings_in_force(chosen.settings)},
               {"query", {{"name", calibrated.query.name}, {"ground_truth", calibrated.protocol}}},
               {"precision", calibrated.precision},
               {"chosen", calibrated.chosen},
               {"lengths", Json::array()},
               {"in_1000_windows", rate_json(rate_of(chosen, 1000))}};
  json["query"].update(value_to_json(calibrated.query.selection, kDataForm));
  for (const CalibratedLength& length : calibrated.lengths)
    json["lengths"].push_back(length_json(length));
  if (calibrated.fps) {
    json["fps"] = *calibrated.fps;
    json["in_an_hour"] = rate_json(rate_of(chosen, *calibrated.fps * kSecondsPerHour));
  }
  json["provenance"] = provenance_json(run);
  add_run(json, run, {{"calibrate", seconds}});
  return json;
}

Table calibration_table(const CalibratedSequence& calibrated) {
  Table table;
  table.title = calibrated.query.name + ": windows recognized at the margin found (* chosen)";
  table.columns = {"c_l", "margin", "correct", "incorrect", "of", "false recognitions", "95 %"};
  for (size_t l = 0; l < calibrated.lengths.size(); ++l) {
    const CalibratedLength& length = calibrated.lengths[l];
    const Calibration& found = length.calibration;
    const std::string name =
        fmt::format("{}{}", length.settings.window_length, calibrated.chosen == l ? "*" : "");
    if (!found.strength) {
      add_row(table, name, "-", "-", "-", length.windows, "-", "-");
      continue;
    }
    const Interval& interval = found.expected.interval;
    add_row(table, name, fmt::format("{:.4g}", *length.settings.margin), found.correct,
            found.incorrect, length.windows, found.expected.seen,
            fmt::format("{:.1f} to {:.1f}", interval.low, interval.high));
  }
  return table;
}

std::string calibration_text(const CalibratedSequence& calibrated) {
  const CalibratedLength& length = calibrated.lengths[calibrated.chosen];
  const Calibration& found = length.calibration;
  std::string text = wrapped_text(
      fmt::format("{}: margin {:.4g} at c_l {}: {} of {} whose place is trained recognized "
                  "correctly, {} of all {} incorrectly.",
                  calibrated.query.name, *length.settings.margin, length.settings.window_length,
                  found.correct, counted(length.queries, "window"), found.incorrect,
                  length.windows),
      2);
  const ScaledRate rate =
      calibrated.fps ? rate_of(length, *calibrated.fps * kSecondsPerHour) : rate_of(length, 1000);
  text += fmt::format("False recognitions to expect in {}: {:.0f} (95 %: {:.0f} to {:.0f}).\n",
                      calibrated.fps ? "an hour" : "1000 windows", rate.expected, rate.interval.low,
                      rate.interval.high);
  return text + "Expect more in other rooms and at another speed.\n";
}

}  // namespace vpr
