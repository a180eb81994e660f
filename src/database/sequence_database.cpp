#include "database/sequence_database.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/provenance.h"
#include "base/text.h"
#include "database/family.h"
#include "database/sequence_rates.h"
#include "database/shared_places_json.h"

namespace vpr {
namespace {

constexpr const char* kCodesFile = "codes.npy";
constexpr const char* kFramesFile = "frames.txt";
constexpr const char* kStatisticsFile = "statistics.npy";

Json sequence_to_json(const TrainSequence& sequence) {
  Json json = {{"name", sequence.name},
               {"frames", sequence.frame_count()},
               {"unreadable", sequence.unreadable}};
  if (sequence.typical_distance) json["typical_distance"] = *sequence.typical_distance;
  if (sequence.half_width) json["half_width"] = *sequence.half_width;
  add_rate(json, sequence);
  return json;
}

// No distance of descriptors as they are stored is larger.
double most_distance(const DescriptorShape& shape) {
  constexpr size_t kMost = 65535;
  return static_cast<double>(
      shape.element == ElementType::bits ? std::min(8 * shape.row_bytes(), kMost) : kMost);
}

// A mean frame distance.
double read_typical_distance(const Archive& archive, const Json& json,
                             const DescriptorShape& shape) {
  const auto found = json.find("typical_distance");
  if (found == json.end() || !found->is_number()) archive.fail("\"typical_distance\" is no number");
  const auto typical = found->get<double>();
  if (!(typical >= 0 && typical <= most_distance(shape)))
    archive.fail("\"typical_distance\" is out of range");
  return typical;
}

size_t read_half_width(const Archive& archive, const Json& json, size_t frame_count) {
  const size_t width = manifest_count(archive, json, "half_width");
  if (width == 0 || width > frame_count) archive.fail("\"half_width\" is out of range");
  return width;
}

Json thresholds_to_json(const ThresholdTable& table) {
  Json closest = Json::array();
  for (const auto& item : table.closest) {
    if (!item) {
      closest.push_back(nullptr);
      continue;
    }
    closest.push_back({{"distance", item->score},
                       {"window", item->window},
                       {"other_sequence", item->other_sequence},
                       {"other_window", item->other_window}});
  }
  return {
      {"c_l", table.window_length}, {"safety_factor", table.safety_factor}, {"closest", closest}};
}

// One name a line, in the order of the codes.
std::string frame_lines(const SequenceDatabase& database) {
  std::string text;
  for (const TrainSequence& sequence : database.sequences) {
    for (std::string name : sequence.frame_names) {
      std::replace(name.begin(), name.end(), '\n', ' ');
      text += name + "\n";
    }
  }
  return text;
}

std::vector<size_t> read_unreadable(const Archive& archive, const Json& json, size_t frame_count) {
  std::vector<size_t> frames;
  for (const Json& item : manifest_list(archive, json, "unreadable")) {
    if (!item.is_number_unsigned()) archive.fail("an unreadable frame is no number");
    const auto frame = item.get<size_t>();
    if (frame >= frame_count || (!frames.empty() && frame <= frames.back()))
      archive.fail("its unreadable frames are out of range or order");
    frames.push_back(frame);
  }
  return frames;
}

std::vector<TrainSequence> read_sequences(const Archive& archive,
                                          const std::vector<std::string_view>& frame_names,
                                          const DescriptorShape& shape) {
  std::vector<TrainSequence> sequences;
  size_t first = 0;
  for (const Json& json : manifest_list(archive, archive.manifest(), "sequences")) {
    const size_t count = manifest_count(archive, json, "frames");
    if (count == 0 || count > frame_names.size() - first)
      archive.fail("its numbers of frames do not fit frames.txt");
    TrainSequence& sequence = sequences.emplace_back();
    sequence.name = manifest_text(archive, json, "name");
    for (size_t s = 0; s + 1 < sequences.size(); ++s)
      if (sequences[s].name == sequence.name) archive.fail("two sequences have the same name");
    sequence.unreadable = read_unreadable(archive, json, count);
    sequence.typical_distance = read_typical_distance(archive, json, shape);
    sequence.half_width = read_half_width(archive, json, count);
    sequence.frame_names.assign(frame_names.begin() + ptrdiff_t(first),
                                frame_names.begin() + ptrdiff_t(first + count));
    first += count;
  }
  if (sequences.empty() || first != frame_names.size())
    archive.fail("its numbers of frames do not fit frames.txt");
  read_rates(archive, sequences);
  return sequences;
}

std::optional<ClosestWindows> read_closest(const Archive& archive, const Json& json,
                                           size_t window_length, size_t own,
                                           const std::vector<TrainSequence>& sequences) {
  if (json.is_null()) return std::nullopt;
  const ClosestWindows closest{
      static_cast<uint32_t>(std::min<size_t>(manifest_count(archive, json, "distance"), ~0U)),
      manifest_count(archive, json, "window"), manifest_count(archive, json, "other_sequence"),
      manifest_count(archive, json, "other_window")};
  const auto fits = [&](size_t sequence, size_t window) {
    return sequence < sequences.size() && window_length <= sequences[sequence].frame_count() &&
           window <= sequences[sequence].frame_count() - window_length;
  };
  if (!fits(own, closest.window) || !fits(closest.other_sequence, closest.other_window))
    archive.fail("a closest pair of windows is out of range");
  return closest;
}

std::vector<ThresholdTable> read_thresholds(const Archive& archive,
                                            const std::vector<TrainSequence>& sequences) {
  std::vector<ThresholdTable> tables;
  for (const Json& json : manifest_list(archive, archive.manifest(), "thresholds")) {
    ThresholdTable& table = tables.emplace_back();
    table.window_length = manifest_count(archive, json, "c_l");
    const auto factor = json.find("safety_factor");
    if (factor == json.end() || !factor->is_number())
      archive.fail("\"safety_factor\" is no number");
    table.safety_factor = factor->get<double>();
    if (!(table.safety_factor > 0 && table.safety_factor <= 1e6))
      archive.fail("\"safety_factor\" is out of range");
    for (const Json& item : manifest_list(archive, json, "closest"))
      table.closest.push_back(
          read_closest(archive, item, table.window_length, table.closest.size(), sequences));
    if (table.window_length == 0 || table.closest.size() != sequences.size())
      archive.fail("its thresholds do not fit its sequences");
  }
  return tables;
}

const DescriptorKind& read_kind(const Archive& archive) {
  const std::string name = manifest_text(archive, archive.manifest(), "descriptor");
  const DescriptorKind* kind = find_descriptor_kind(name);
  if (kind == nullptr)
    throw Error(ErrorKind::data,
                fmt::format("{}: its frames are described by {}, which this version does not know",
                            archive.name(), name));
  return *kind;
}

// Of descriptors that say how long they are.
size_t read_length(const Archive& archive, const DescriptorKind& kind) {
  if (kind.shape.length != 0) return kind.shape.length;
  const size_t length = manifest_count(archive, archive.manifest(), "length");
  if (length == 0 || length > most_elements(kind.shape.element))
    archive.fail("\"length\" is out of range");
  return length;
}

// Of coordinates: what 1 is.
double read_unit(const Archive& archive, const DescriptorKind& kind) {
  if (kind.shape.element != ElementType::coordinates) return 0;
  const auto found = archive.manifest().find("unit");
  if (found == archive.manifest().end() || !found->is_number())
    archive.fail("\"unit\" is no number");
  const auto unit = found->get<double>();
  if (!(unit > 0 && std::isfinite(unit))) archive.fail("\"unit\" is out of range");
  return unit;
}

NpyArray read_codes(const Archive& archive, size_t frame_count, const DescriptorShape& shape) {
  NpyArray codes = archive.array(kCodesFile);
  codes.values<uint8_t>(2);
  if (codes.shape()[0] != frame_count || codes.shape()[1] != shape.row_bytes())
    archive.fail(
        fmt::format("codes.npy does not have one row of {} bytes a frame", shape.row_bytes()));
  return codes;
}

Json statistics_to_json(const TrainStatistics& statistics) {
  Json json = value_to_json(statistics.settings);
  json["typical_distance"] = statistics.typical_distance;
  return json;
}

// Bias and variance of every frame, side by side.
std::vector<float> statistics_rows(const TrainStatistics& statistics) {
  std::vector<float> values;
  for (size_t i = 0; i < statistics.bias.size(); ++i)
    values.insert(values.end(), {statistics.bias[i], statistics.variance[i]});
  return values;
}

TrainStatistics read_statistics(const Archive& archive, size_t frame_count,
                                const DescriptorShape& shape) {
  const auto found = archive.manifest().find("statistics");
  if (found == archive.manifest().end() || !found->is_object())
    archive.fail("\"statistics\" is not an object");
  Json json = *found;
  TrainStatistics statistics;
  statistics.typical_distance = read_typical_distance(archive, json, shape);
  json.erase("typical_distance");
  stored_settings_from_json({{"settings", json}}, statistics.settings, archive.name());
  const NpyArray rows = archive.array(kStatisticsFile);
  const auto values = rows.values<float>(2);
  if (rows.shape()[0] != frame_count || rows.shape()[1] != 2)
    archive.fail("statistics.npy does not have one row of 2 numbers a frame");
  const auto most = static_cast<float>(most_distance(shape));
  for (size_t i = 0; i < values.size(); i += 2) {
    if (!(std::abs(values[i]) <= most) || !(values[i + 1] >= 0 && values[i + 1] <= most * most))
      archive.fail("statistics.npy holds a number out of range");
    statistics.bias.push_back(values[i]);
    statistics.variance.push_back(values[i + 1]);
  }
  return statistics;
}

}  // namespace

SequenceDatabase read_sequence_database(const std::filesystem::path& path) {
  const Archive archive(path);
  require_family(archive, DatabaseFamily::sequences);
  SequenceDatabase database;
  database.fingerprint = archive.fingerprint();
  stored_settings_from_json(archive.manifest(), database.descriptor, archive.name());
  const DescriptorKind& kind = read_kind(archive);
  const DescriptorShape shape{kind.shape.element, read_length(archive, kind)};
  const std::string names = archive.text(kFramesFile);
  auto frame_names = split(names, '\n');
  if (frame_names.back().empty()) frame_names.pop_back();  // behind the end of the last line
  database.sequences = read_sequences(archive, frame_names, shape);
  database.thresholds = read_thresholds(archive, database.sequences);
  const size_t frames = frame_names.size();
  database.descriptors = {
      &kind, {}, read_codes(archive, frames, shape), shape.length, read_unit(archive, kind)};
  database.statistics = read_statistics(archive, frames, shape);
  database.shared_places = read_shared_places(archive, database.sequences.size());
  return database;
}

void write_sequence_database(const std::filesystem::path& path, const SequenceDatabase& database,
                             Outputs& outputs) {
  const DescriptorRows rows = database.descriptors.rows();
  ArchiveWriter writer(outputs.folder(path, is_database_folder));
  writer.add_array(kCodesFile, rows.bytes, {rows.size(), rows.shape.row_bytes()});
  writer.add_text(kFramesFile, frame_lines(database));
  write_kept(writer, database.sequences);
  if (database.statistics)
    writer.add_array(kStatisticsFile, std::span<const float>(statistics_rows(*database.statistics)),
                     {rows.size(), 2});
  Json manifest = {{"schema", "vpr.database/1"},
                   {"method", enum_name(DatabaseFamily::sequences)},
                   {"descriptor", database.descriptors.kind->name}};
  if (database.descriptors.kind->is_imported) manifest["length"] = rows.shape.length;
  if (rows.shape.element == ElementType::coordinates) manifest["unit"] = database.descriptors.unit;
  manifest["settings"] = value_to_json(database.descriptor);
  manifest["sequences"] = Json::array();
  for (const TrainSequence& sequence : database.sequences)
    manifest["sequences"].push_back(sequence_to_json(sequence));
  manifest["thresholds"] = Json::array();
  for (const ThresholdTable& table : database.thresholds)
    manifest["thresholds"].push_back(thresholds_to_json(table));
  if (database.shared_places)
    manifest["shared_places"] = shared_places_to_json(*database.shared_places);
  if (database.statistics) manifest["statistics"] = statistics_to_json(*database.statistics);
  manifest["provenance"] = {
      {"program", "vpr-train"}, {"version", program_version()}, {"commit", program_commit()}};
  writer.finish(manifest);
}

const ThresholdTable* find_thresholds(std::span<const ThresholdTable> tables,
                                      size_t window_length) {
  for (const ThresholdTable& table : tables)
    if (table.window_length == window_length) return &table;
  return nullptr;
}

}  // namespace vpr
