#include "present/database_report.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "database/archive.h"
#include "present/table.h"
#include "recordings/sequence_json.h"

namespace vpr {
namespace {

// Empty for LDB, the default.
std::string descriptor_text(const DescriptorStore& descriptors) {
  if (descriptors.kind == &descriptor_kinds().front()) return "";
  const DescriptorShape shape = descriptors.shape();
  if (shape.element == ElementType::ldb_hog)
    return fmt::format(", {} bytes each ({})", shape.row_bytes(), descriptors.kind->name);
  return fmt::format(", {} {} each ({})", shape.length, element_noun(shape),
                     descriptors.kind->name);
}

// "40 of 80" for a selection.
std::string frames_text(const Sequence& sequence) {
  return sequence.selection.is_all()
             ? std::to_string(sequence.frames)
             : fmt::format("{} of {}", sequence.frames, sequence.recorded_frames());
}

std::string frame_span(const Sequence& sequence, size_t window, size_t length) {
  return fmt::format("{}: {} to {}", sequence.name, sequence.frame_names[window],
                     sequence.frame_names[window + length - 1]);
}

/// One sequence at one window length.
struct Line {
  const Sequence& sequence;
  size_t window_length;
  std::optional<double> threshold;
  const std::optional<ClosestWindows>& closest;
  std::string own_frames;  ///< of the closest windows; "-" without
  std::string closest_frames;
};

std::vector<Line> lines_of(std::span<const TrainSequence> sequences,
                           const std::vector<ThresholdTable>& thresholds) {
  std::vector<Line> lines;
  for (const ThresholdTable& table : thresholds)
    for (size_t s = 0; s < sequences.size(); ++s) {
      const size_t length = table.window_length;
      Line& line =
          lines.emplace_back(Line{sequences[s].sequence, length, automatic_threshold(table, s),
                                  table.closest[s], "-", "-"});
      if (!line.closest) continue;
      line.own_frames = frame_span(sequences[s].sequence, line.closest->window, length);
      line.closest_frames = frame_span(sequences[line.closest->other_sequence].sequence,
                                       line.closest->other_window, length);
    }
  return lines;
}

}  // namespace

Json database_json(const SequenceDatabase& database, const RunInfo& run) {
  Json json = {{"schema", schema_name("database-info")},
               {"method", enum_name(DatabaseFamily::sequences)},
               {"descriptor", database.descriptors.kind->name}};
  if (database.descriptors.kind->is_imported) json["length"] = database.descriptors.length;
  json["settings"] = value_to_json(database.descriptor);
  json["sequences"] = Json::array();
  for (size_t s = 0; s < database.sequences.size(); ++s) {
    Sequence sequence = database.sequences[s].sequence;
    Json item = value_to_json(NestedObject{[&](auto&& visit) {
                                visit_sequence(sequence, visit, [&] {
                                  visit("unreadable", Derived{sequence.unreadable.size()});
                                });
                              }},
                              kDataForm);
    item["t_r"] = Json::array();
    for (const ThresholdTable& table : database.thresholds) {
      const std::optional<double> threshold = automatic_threshold(table, s);
      item["t_r"].push_back(
          {{"c_l", table.window_length}, {"bits", threshold ? Json(*threshold) : Json()}});
    }
    json["sequences"].push_back(item);
  }
  json["provenance"] = provenance_json(run);
  return json;
}

std::string database_text(const SequenceDatabase& database, const std::string& name) {
  Table table;
  table.columns = {"sequence", "frames", "unreadable"};
  size_t frames = 0;
  for (const TrainSequence& train : database.sequences) {
    frames += train.sequence.frames;
    add_row(table, train.sequence.name, frames_text(train.sequence),
            train.sequence.unreadable.size());
  }
  for (const ThresholdTable& one : database.thresholds) {
    if (std::ranges::none_of(one.closest, [](const auto& found) { return found.has_value(); }))
      continue;
    table.columns.push_back(fmt::format("t_r at c_l {}", one.window_length));
    for (size_t s = 0; s < table.rows.size(); ++s) {
      const std::optional<double> threshold = automatic_threshold(one, s);
      table.rows[s].push_back(threshold ? fmt::format("{:.2f} bits", *threshold) : "-");
    }
  }
  table.title = fmt::format("{}: {}, {}{}", name, counted(database.sequences.size(), "sequence"),
                            counted(frames, "frame"), descriptor_text(database.descriptors));
  return render_table(table, TableFormat::text);
}

Json thresholds_json(std::span<const TrainSequence> sequences,
                     const std::vector<ThresholdTable>& thresholds, double safety_factor,
                     const RunInfo& run) {
  Json json = {{"schema", schema_name("thresholds")}, {"safety_factor", safety_factor}};
  json["thresholds"] = Json::array();
  for (const Line& line : lines_of(sequences, thresholds)) {
    Json item = {{"sequence", line.sequence.name}, {"c_l", line.window_length}, {"t_r", nullptr}};
    if (line.threshold) {
      item["t_r"] = *line.threshold;
      item["t_r_scale"] = enum_name(ThresholdScale::bits);
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
                       const std::vector<ThresholdTable>& thresholds, double safety_factor,
                       const std::string& name) {
  Table table;
  table.title = fmt::format("{}: automatic t_r, safety factor {:g}", name, safety_factor);
  table.columns = {"sequence", "c_l", "t_r (bits)", "own frames", "closest other frames"};
  for (const Line& line : lines_of(sequences, thresholds))
    add_row(table, line.sequence.name, line.window_length,
            line.threshold ? fmt::format("{:.2f}", *line.threshold) : "-", line.own_frames,
            line.closest_frames);
  return table;
}

}  // namespace vpr
