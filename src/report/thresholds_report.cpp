#include "report/thresholds_report.h"

#include <fmt/format.h>

#include "base/json.h"

namespace vpr {
namespace {

std::string frame_span(const TrainSequence& sequence, size_t window, size_t length) {
  const std::string& first = sequence.frame_names[window];
  const std::string& last = sequence.frame_names[window + length - 1];
  return fmt::format("{}: {} to {}", sequence.name, first, last);
}

/// One sequence at one window length.
struct Line {
  const TrainSequence& sequence;
  size_t window_length;
  const std::optional<AutomaticThreshold>& threshold;
  const std::optional<ClosestWindows>& closest;
  std::string own_frames;  ///< of the closest windows, where there are some
  std::string closest_frames;
};

std::vector<Line> lines_of(std::span<const TrainSequence> sequences,
                           const std::vector<AutomaticThresholds>& thresholds) {
  std::vector<Line> lines;
  for (const AutomaticThresholds& automatic : thresholds)
    for (size_t s = 0; s < sequences.size(); ++s) {
      const size_t length = automatic.table.window_length;
      Line& line = lines.emplace_back(
          Line{sequences[s], length, automatic.sequences[s], automatic.table.closest[s], "-", "-"});
      if (!line.closest) continue;
      line.own_frames = frame_span(sequences[s], line.closest->window, length);
      line.closest_frames =
          frame_span(sequences[line.closest->other_sequence], line.closest->other_window, length);
    }
  return lines;
}

}  // namespace

Json thresholds_json(std::span<const TrainSequence> sequences,
                     const std::vector<AutomaticThresholds>& thresholds, double safety_factor,
                     const RunInfo& run) {
  Json json = {{"schema", "vpr.thresholds/1"}, {"safety_factor", safety_factor}};
  json["thresholds"] = Json::array();
  for (const Line& line : lines_of(sequences, thresholds)) {
    Json item = {{"sequence", line.sequence.name}, {"c_l", line.window_length}, {"t_r", nullptr}};
    if (line.threshold) {
      item["t_r"] = line.threshold->value;
      item["t_r_scale"] = enum_name(ThresholdScale::bits);
      item["limited"] = line.threshold->is_largest;
    }
    if (line.closest) {
      item["distance"] = line.closest->score;
      item["own_frames"] = line.own_frames;
      item["closest_frames"] = line.closest_frames;
    }
    json["thresholds"].push_back(item);
  }
  json["provenance"] = provenance_json(run);
  return json;
}

Table thresholds_table(std::span<const TrainSequence> sequences,
                       const std::vector<AutomaticThresholds>& thresholds, double safety_factor,
                       const std::string& name) {
  Table table;
  table.title = fmt::format("{}: automatic t_r, safety factor {:g}", name, safety_factor);
  table.columns = {"sequence", "c_l", "t_r (bits)", "from", "own frames", "closest other frames"};
  for (const Line& line : lines_of(sequences, thresholds)) {
    std::string value = "-";
    std::string from = "-";
    if (line.threshold) {
      value = fmt::format("{:.2f}", line.threshold->value);
      from = line.threshold->is_largest ? "upper limit" : "closest windows";
    }
    table.rows.push_back({line.sequence.name, std::to_string(line.window_length), value, from,
                          line.own_frames, line.closest_frames});
  }
  return table;
}

}  // namespace vpr
