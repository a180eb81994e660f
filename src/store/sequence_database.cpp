#include "store/sequence_database.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/provenance.h"
#include "base/text.h"
#include "store/archive.h"

namespace vpr {
namespace {

constexpr const char* kCodesFile = "codes.npy";
constexpr const char* kFramesFile = "frames.txt";
constexpr const char* kSourcesFile = "kept.npy";  // selected frames of recordings
constexpr const char* kStatisticsFile = "statistics.npy";

Json train_json(const TrainSequence& train) {
  Json own = {{"unreadable", train.sequence.unreadable}};
  if (train.typical_distance) own["typical_distance"] = *train.typical_distance;
  if (train.half_width) own["half_width"] = *train.half_width;
  return sequence_json(train.sequence, own);
}

// Upper bound of the distances of stored descriptors.
double most_distance(const DescriptorShape& shape) {
  constexpr size_t kMost = 65535;
  return static_cast<double>(
      shape.element == ElementType::bits ? std::min(8 * shape.row_bytes(), kMost) : kMost);
}

// A number of a manifest, at most `most`, and above 0 or at least 0.
double read_number(const Archive& archive, const Json& json, const std::string& key,
                   double most = std::numeric_limits<double>::max(), bool may_be_zero = false) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number())
    archive.fail(fmt::format("\"{}\" is not a number", key));
  const auto number = found->get<double>();
  if (!(number >= 0 && number <= most) || (number == 0 && !may_be_zero))
    archive.fail(fmt::format("\"{}\" is out of range", key));
  return number;
}

double read_typical_distance(const Archive& archive, const Json& json,
                             const DescriptorShape& shape) {
  return read_number(archive, json, "typical_distance", most_distance(shape), true);
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

// One name per line, in the order of the codes.
std::string frame_lines(const SequenceDatabase& database) {
  std::string text;
  for (const TrainSequence& train : database.sequences) {
    for (std::string name : train.sequence.frame_names) {
      std::replace(name.begin(), name.end(), '\n', ' ');
      text += name + "\n";
    }
  }
  return text;
}

// Pointers to the sequences of a database.
auto pointers_of(auto& sequences) {
  std::vector<decltype(&sequences.front().sequence)> pointers;
  for (auto& train : sequences) pointers.push_back(&train.sequence);
  return pointers;
}

std::vector<TrainSequence> read_sequences(const Archive& archive,
                                          const std::vector<std::string_view>& frame_names,
                                          const DescriptorShape& shape) {
  std::vector<TrainSequence> sequences;
  auto first = frame_names.begin();
  for (const Json& json : manifest_list(archive, archive.manifest(), "sequences")) {
    TrainSequence train{
        read_sequence(archive.fields(json), static_cast<uint64_t>(frame_names.end() - first))};
    Sequence& sequence = train.sequence;
    if (sequence.frames == 0) archive.fail("its frame counts do not match frames.txt");
    for (const TrainSequence& before : sequences)
      if (before.sequence.name == sequence.name) archive.fail("two sequences have the same name");
    train.typical_distance = read_typical_distance(archive, json, shape);
    train.half_width = read_half_width(archive, json, sequence.frames);
    const auto end = first + static_cast<ptrdiff_t>(sequence.frames);
    sequence.frame_names.assign(first, end);
    first = end;
    sequences.push_back(std::move(train));
  }
  if (sequences.empty() || first != frame_names.end())
    archive.fail("its frame counts do not match frames.txt");
  read_sources(
      pointers_of(sequences),
      [&] {
        const NpyArray array = archive.array(kSourcesFile);
        const auto rows = array.values<int32_t>(1);
        return std::vector<int32_t>(rows.begin(), rows.end());
      },
      [&] { archive.fail("kept.npy does not fit its sequences"); });
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
    return sequence < sequences.size() && window_length <= sequences[sequence].sequence.frames &&
           window <= sequences[sequence].sequence.frames - window_length;
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
    table.safety_factor = read_number(archive, json, "safety_factor", 1e6);
    for (const Json& item : manifest_list(archive, json, "closest"))
      table.closest.push_back(
          read_closest(archive, item, table.window_length, table.closest.size(), sequences));
    if (table.window_length == 0 || table.closest.size() != sequences.size())
      archive.fail("its thresholds do not fit its sequences");
  }
  return tables;
}

std::vector<std::pair<size_t, size_t>> read_shared_places(const Archive& archive,
                                                          size_t sequences) {
  std::vector<std::pair<size_t, size_t>> pairs;
  for (const Json& item : manifest_list(archive, archive.manifest(), "shared_places")) {
    if (!item.is_array() || item.size() != 2 || !item[0].is_number_unsigned() ||
        !item[1].is_number_unsigned())
      archive.fail("its \"shared_places\" are not pairs of sequences");
    const std::pair pair(item[0].get<size_t>(), item[1].get<size_t>());
    if (pair.first >= pair.second || pair.second >= sequences ||
        (!pairs.empty() && pair <= pairs.back()))
      archive.fail("its \"shared_places\" are out of range or order");
    pairs.push_back(pair);
  }
  return pairs;
}

const DescriptorKind& read_kind(const Archive& archive) {
  const std::string name = manifest_text(archive, archive.manifest(), "descriptor");
  const DescriptorKind* kind = find_descriptor_kind(name);
  if (kind == nullptr)
    throw Error(
        ErrorKind::data,
        fmt::format("{}: its frames are described by {}, which this version does not support",
                    archive.name(), name));
  return *kind;
}

// The length in the manifest, for kinds with a length per database.
size_t read_length(const Archive& archive, const DescriptorKind& kind) {
  if (kind.shape.length != 0) return kind.shape.length;
  const size_t length = manifest_count(archive, archive.manifest(), "length");
  if (length == 0 || length > most_elements(kind.shape.element))
    archive.fail("\"length\" is out of range");
  return length;
}

NpyArray read_codes(const Archive& archive, size_t frame_count, const DescriptorShape& shape) {
  NpyArray codes = archive.array(kCodesFile);
  codes.values<uint8_t>(2);
  if (codes.shape()[0] != frame_count || codes.shape()[1] != shape.row_bytes())
    archive.fail(
        fmt::format("codes.npy does not have one row of {} bytes per frame", shape.row_bytes()));
  return codes;
}

Json statistics_to_json(const TrainStatistics& statistics) {
  Json json = value_to_json(statistics.settings);
  json["typical_distance"] = statistics.typical_distance;
  return json;
}

// Bias and variance of every frame, interleaved.
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
    archive.fail("statistics.npy does not have one row of 2 values per frame");
  const auto most = static_cast<float>(most_distance(shape));
  for (size_t i = 0; i < values.size(); i += 2) {
    if (!(std::abs(values[i]) <= most) || !(values[i + 1] >= 0 && values[i + 1] <= most * most))
      archive.fail("statistics.npy holds a value out of range");
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
  if (frame_names.back().empty()) frame_names.pop_back();  // after the end of the last line
  database.sequences = read_sequences(archive, frame_names, shape);
  database.thresholds = read_thresholds(archive, database.sequences);
  const size_t frames = frame_names.size();
  const bool has_unit = shape.element == ElementType::points16;
  database.descriptors = {&kind,
                          {},
                          read_codes(archive, frames, shape),
                          shape.length,
                          has_unit ? read_number(archive, archive.manifest(), "unit") : 0};
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
  const std::vector<int32_t> sources = source_rows(pointers_of(database.sequences));
  if (!sources.empty())
    writer.add_array(kSourcesFile, std::span<const int32_t>(sources), {sources.size()});
  if (database.statistics)
    writer.add_array(kStatisticsFile, std::span<const float>(statistics_rows(*database.statistics)),
                     {rows.size(), 2});
  Json manifest = {{"schema", "vpr.database/1"},
                   {"method", enum_name(DatabaseFamily::sequences)},
                   {"descriptor", database.descriptors.kind->name}};
  if (database.descriptors.kind->is_imported) manifest["length"] = rows.shape.length;
  if (rows.shape.element == ElementType::points16) manifest["unit"] = database.descriptors.unit;
  manifest["settings"] = value_to_json(database.descriptor);
  manifest["sequences"] = Json::array();
  for (const TrainSequence& train : database.sequences)
    manifest["sequences"].push_back(train_json(train));
  manifest["thresholds"] = Json::array();
  for (const ThresholdTable& table : database.thresholds)
    manifest["thresholds"].push_back(thresholds_to_json(table));
  if (database.shared_places) {
    manifest["shared_places"] = Json::array();
    for (const auto& [a, b] : *database.shared_places) manifest["shared_places"].push_back({a, b});
  }
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
