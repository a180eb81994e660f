#include "present/database_report.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/json.h"
#include "base/json_schema.h"
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

/// An automatic threshold at one window length.
struct AutomaticThreshold {
  size_t c_l = 0;
  std::optional<double> bits;
};

VPR_FIELDS(AutomaticThreshold, (c_l, "Window length in frames."),
           (bits, "Automatic t_r in bits per frame, safety factor applied."))

struct SequenceInfo {
  Sequence sequence;
  std::vector<AutomaticThreshold> thresholds;
};

template <class Visitor>
void visit_fields(SequenceInfo& info, Visitor&& visit) {
  visit_sequence(info.sequence, visit, [&] {
    visit("unreadable", Derived{info.sequence.unreadable.size()}, "Undecodable frames.");
  });
  visit("t_r", info.thresholds, "Automatic thresholds, one for each trained window length.");
}

/// The output of vpr-train --json.
struct DatabaseInfo {
  std::string descriptor;
  std::optional<size_t> length;
  DescriptorSettings settings;
  std::vector<SequenceInfo> sequences;
  Provenance provenance;
};

template <class Visitor>
void visit_fields(DatabaseInfo& info, Visitor&& visit) {
  visit("schema", Derived{schema_name("database-info")});
  visit("method", Derived{enum_name(DatabaseFamily::sequences)}, "fastable or fabmap.");
  visit("descriptor", info.descriptor, "Descriptor of the frames.");
  visit("length", IfSet{info.length}, "Dimensions of vectors, or bits.", at_least(1));
  visit("settings", info.settings,
        "Settings that can change the numbers; keys are the names of flags.");
  visit("sequences", info.sequences, "Training sequences in the order of the database.");
  visit("provenance", info.provenance, kProvenanceText);
}

struct ThresholdEntry {
  std::string sequence;
  size_t window_length = 0;
  std::optional<double> threshold;
  std::optional<ThresholdScale> scale;
  std::optional<uint32_t> distance;
  std::optional<std::string> own_frames, closest_frames;
};

template <class Visitor>
void visit_fields(ThresholdEntry& entry, Visitor&& visit) {
  visit("sequence", entry.sequence, "Name of the training sequence.");
  visit("c_l", entry.window_length, "Window length in frames.");
  visit("t_r", entry.threshold, "Automatic threshold.");
  visit("t_r_scale", IfSet{entry.scale}, "Scale of t_r.");
  visit("distance", IfSet{entry.distance}, "Distance of the closest window of another sequence.");
  visit("own_frames", IfSet{entry.own_frames}, "Window: sequence, first, last frame.");
  visit("closest_frames", IfSet{entry.closest_frames}, "Window: sequence, first, last frame.");
}

struct ThresholdsFile {
  double safety_factor = 0;
  std::vector<ThresholdEntry> thresholds;
  Provenance provenance;
};

VPR_FILE(ThresholdsFile, "thresholds", (safety_factor, "Factor of the closest distance."),
         (thresholds, "One entry for each training sequence and window length."),
         (provenance, kProvenanceText))

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
  DatabaseInfo info{std::string(database.descriptors.kind->name),
                    {},
                    database.descriptor,
                    {},
                    provenance_of(run)};
  if (database.descriptors.kind->is_imported) info.length = database.descriptors.length;
  for (size_t s = 0; s < database.sequences.size(); ++s) {
    SequenceInfo& item = info.sequences.emplace_back();
    item.sequence = database.sequences[s].sequence;
    for (const ThresholdTable& table : database.thresholds)
      item.thresholds.push_back({table.window_length, automatic_threshold(table, s)});
  }
  return value_to_json(info, kDataForm);
}

Json sequence_info_schema() { return schema_of<DatabaseInfo>(); }

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
  ThresholdsFile file{safety_factor, {}, provenance_of(run)};
  for (const Line& line : lines_of(sequences, thresholds)) {
    ThresholdEntry& entry = file.thresholds.emplace_back();
    entry = {line.sequence.name, line.window_length, line.threshold, {}, {}, {}, {}};
    if (!line.threshold) continue;
    entry.scale = ThresholdScale::bits;
    entry.distance = line.closest->score;
    entry.own_frames = line.own_frames;
    entry.closest_frames = line.closest_frames;
  }
  return value_to_json(file, kDataForm);
}

Json thresholds_schema() { return schema_of<ThresholdsFile>(); }

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
