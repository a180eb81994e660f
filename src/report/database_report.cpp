#include "report/database_report.h"

#include <numeric>

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "database/archive.h"
#include "report/table.h"

namespace vpr {
namespace {

Json head_json(DatabaseFamily family) {
  return {{"schema", "vpr.database-info/1"}, {"method", enum_name(family)}};
}

std::string threshold_text(const std::optional<AutomaticThreshold>& automatic) {
  if (!automatic) return "-";
  return fmt::format("{:.2f} bits", automatic->value);
}

// Nothing of LDB, the usual one.
std::string descriptor_text(const DescriptorStore& descriptors) {
  if (descriptors.kind == &descriptor_kinds().front()) return "";
  const DescriptorShape shape = descriptors.shape();
  return fmt::format(", {} of {} {}", descriptors.kind->name, shape.length, element_words(shape));
}

// Of a thinned sequence, of how many.
std::string frames_text(const TrainSequence& sequence) {
  const std::string frames = std::to_string(sequence.frame_count());
  return sequence.kept ? fmt::format("{} of {}", frames, sequence.kept->recorded_frames) : frames;
}

Json threshold_json(size_t window_length, const std::optional<AutomaticThreshold>& automatic) {
  return {{"c_l", window_length}, {"bits", automatic ? Json(automatic->value) : Json()}};
}

}  // namespace

Json database_json(const SequenceDatabase& database,
                   const std::vector<AutomaticThresholds>& thresholds, const RunInfo& run) {
  Json json = head_json(DatabaseFamily::sequences);
  json["descriptor"] = database.descriptors.kind->name;
  if (database.descriptors.kind->is_imported) json["length"] = database.descriptors.length;
  json["settings"] = value_to_json(database.descriptor);
  json["sequences"] = Json::array();
  for (size_t s = 0; s < database.sequences.size(); ++s) {
    const TrainSequence& sequence = database.sequences[s];
    Json item = {{"name", sequence.name},
                 {"frames", sequence.frame_count()},
                 {"unreadable", sequence.unreadable.size()}};
    if (sequence.fps) item["fps"] = *sequence.fps;
    if (sequence.kept) add_replay(item, *sequence.kept);
    item["t_r"] = Json::array();
    for (const AutomaticThresholds& one : thresholds)
      item["t_r"].push_back(threshold_json(one.table.window_length, one.sequences[s]));
    json["sequences"].push_back(item);
  }
  json["provenance"] = provenance_json(run);
  return json;
}

Json database_json(const FabmapDatabase& database, const RunInfo& run) {
  Json json = head_json(DatabaseFamily::fabmap);
  json["settings"] = value_to_json(database.settings);
  json["words"] = database.tree.words();
  json["pretraining_frames"] = database.pretrain.views();
  json["views"] = database.views.views();
  const std::vector<size_t> featureless = featureless_frames(database);
  json["featureless_views"] = std::accumulate(featureless.begin(), featureless.end(), size_t{0});
  json["places"] = database.place_names();
  json["provenance"] = provenance_json(run);
  return json;
}

std::string database_text(const SequenceDatabase& database,
                          const std::vector<AutomaticThresholds>& thresholds,
                          const std::string& name) {
  Table table;
  table.columns = {"sequence", "frames", "unreadable"};
  for (const AutomaticThresholds& one : thresholds)
    table.columns.push_back(fmt::format("t_r at c_l {}", one.table.window_length));
  size_t frames = 0;
  for (size_t s = 0; s < database.sequences.size(); ++s) {
    const TrainSequence& sequence = database.sequences[s];
    frames += sequence.frame_count();
    std::vector<std::string>& row = table.rows.emplace_back();
    row = {sequence.name, frames_text(sequence), std::to_string(sequence.unreadable.size())};
    for (const AutomaticThresholds& one : thresholds)
      row.push_back(threshold_text(one.sequences[s]));
  }
  table.title = fmt::format("{}: {}, {}, {}{}", name, enum_name(DatabaseFamily::sequences),
                            counted(database.sequences.size(), "sequence"),
                            counted(frames, "frame"), descriptor_text(database.descriptors));
  return render_table(table, TableFormat::text);
}

std::string database_text(const FabmapDatabase& database, const std::string& name) {
  Table table;
  table.title = fmt::format(
      "{}: {}, {} of {}, {}, {}", name, enum_name(DatabaseFamily::fabmap),
      counted(database.tree.words(), "word"), enum_name(database.settings.features.kind),
      counted(database.place_names().size(), "place"), counted(database.views.views(), "view"));
  table.columns = {"group", "frames", "places", "words a frame", "featureless"};
  const std::vector<size_t> featureless = featureless_frames(database);
  size_t view = 0;
  for (const ViewGroup& group : database.groups) {
    const size_t first = view;
    view += group.frame_names.size();
    const auto words =
        static_cast<double>(database.views.offsets[view] - database.views.offsets[first]);
    table.rows.push_back({group.name, std::to_string(group.frame_names.size()),
                          group.is_place ? "one" : "each frame",
                          fmt::format("{:.1f}", words / static_cast<double>(view - first)),
                          std::to_string(featureless[table.rows.size()])});
  }
  return render_table(table, TableFormat::text);
}

}  // namespace vpr
