#include "present/calibration_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/json_fields.h"
#include "base/text.h"

namespace vpr {
namespace {

constexpr double kSecondsAnHour = 3600;

/// What the walk's false recognitions make in another time.
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
  return {{"expected", rate.expected}, {"interval", interval_json(rate.interval)}};
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
  json["recognized"] = {{"right", found.right}, {"wrong", found.wrong}};
  json["false_recognitions"] = {{"block", length.block},
                                {"seen", found.expected.seen},
                                {"interval", interval_json(found.expected.interval)}};
  return json;
}

}  // namespace

Json calibration_json(const CalibratedWalk& walk, const CalibrationRequest& request,
                      const RunInfo& run, double seconds) {
  Json json = {{"schema", "vpr.calibration/1"},
               {"settings", nullptr},
               {"query", {{"name", walk.query.name}, {"ground_truth", walk.protocol}}},
               {"precision", request.precision},
               {"chosen", walk.chosen ? Json(*walk.chosen) : Json()},
               {"lengths", Json::array()}};
  add_selection(json["query"], walk.query.selection);
  for (const CalibratedLength& length : walk.lengths)
    json["lengths"].push_back(length_json(length));
  if (walk.chosen) {
    const CalibratedLength& length = walk.lengths[*walk.chosen];
    json["settings"] = settings_in_force(length.settings);
    json["in_1000_windows"] = rate_json(rate_of(length, 1000));
    if (request.fps) {
      json["fps"] = *request.fps;
      json["in_an_hour"] = rate_json(rate_of(length, *request.fps * kSecondsAnHour));
    }
  }
  json["provenance"] = provenance_json(run);
  json["machine"] = machine_json(run);
  json["timing"] = timing_json({{"calibrate", seconds}});
  return json;
}

Table calibration_table(const CalibratedWalk& walk) {
  Table table;
  table.title = fmt::format("{}: windows recognized at the margin found{}", walk.query.name,
                            walk.chosen ? " (* chosen)" : "");
  table.columns = {"c_l", "margin", "right", "wrong", "of", "false recognitions", "95 %"};
  for (size_t l = 0; l < walk.lengths.size(); ++l) {
    const CalibratedLength& length = walk.lengths[l];
    const Calibration& found = length.calibration;
    std::vector<std::string>& row = table.rows.emplace_back();
    row = {std::to_string(length.settings.window_length) + (walk.chosen == l ? "*" : "")};
    if (!found.strength) {
      row.insert(row.end(), {"-", "-", "-", std::to_string(length.windows), "-", "-"});
      continue;
    }
    const Interval& interval = found.expected.interval;
    row.insert(row.end(), {fmt::format("{:.4g}", *length.settings.margin),
                           std::to_string(found.right), std::to_string(found.wrong),
                           std::to_string(length.windows), std::to_string(found.expected.seen),
                           fmt::format("{:.1f} to {:.1f}", interval.low, interval.high)});
  }
  return table;
}

std::string calibration_text(const CalibratedWalk& walk, const CalibrationRequest& request) {
  if (!walk.chosen)
    return fmt::format("{}: no margin: {}.\n", walk.query.name, calibration_failure(walk));
  const CalibratedLength& length = walk.lengths[*walk.chosen];
  const Calibration& found = length.calibration;
  std::string text = fmt::format(
      "{}: margin {:.4g} at c_l {}: {} recognized correctly and {} incorrectly, of {} whose place "
      "is trained.\n",
      walk.query.name, *length.settings.margin, length.settings.window_length,
      counted(found.right, "window"), found.wrong, length.queries);
  const ScaledRate rate =
      request.fps ? rate_of(length, *request.fps * kSecondsAnHour) : rate_of(length, 1000);
  text += fmt::format("False recognitions to expect in {}: {:.0f} (95 %: {:.0f} to {:.0f}).\n",
                      request.fps ? "an hour" : "1000 windows", rate.expected, rate.interval.low,
                      rate.interval.high);
  return text + "Other rooms or another speed may give more.\n";
}

std::string calibration_failure(const CalibratedWalk& walk) {
  // The length that recognizes most places tells best why there is no margin.
  const CalibratedLength& length =
      *std::ranges::max_element(walk.lengths, {}, &CalibratedLength::queries);
  if (length.calibration.advice == CalibrationAdvice::no_right_recognition)
    return "no window is recognized correctly; check that the ground truth belongs to this query";
  return "at every setting that recognizes a window correctly, others are incorrect, or would be "
         "if their place were not trained";
}

}  // namespace vpr
