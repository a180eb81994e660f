#include "database/sequence_database.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/json_schema.h"
#include "base/mapped_file.h"
#include "base/provenance.h"
#include "base/text.h"
#include "database/archive.h"
#include "recordings/sequence_json.h"

namespace vpr {

template <class Visitor>
void visit_fields(TrainSequence& train, Visitor&& visit) {
  Sequence& sequence = train.sequence;
  visit_sequence(sequence, visit, [&] {
    visit("unreadable", sequence.unreadable, kUnreadableText);
    visit("typical_distance", IfSet{train.typical_distance},
          "Mean distance of frames of the sequence that are not neighbors.", at_least(0));
    visit("exclusion_radius", IfSet{train.exclusion_radius},
          "Frames after which the sequence shows another place: the default exclusion radius of "
          "margins.",
          at_least(1));
    visit("size", IfSet{sequence.size}, "Width and height of the first readable frame, in pixels.");
  });
}

/// The statistics without the values of frames.
template <class Visitor>
void visit_fields(TrainStatistics& statistics, Visitor&& visit) {
  visit_fields(statistics.settings, visit);
  visit("typical_distance", statistics.typical_distance, "Mean distance of frames.", at_least(0));
  visit("code_distance", IfSet{statistics.code_distance},
        "The same for LDB codes alone, with the descriptor ldb+hog.", at_least(0));
}

namespace {

/// manifest.json without the keys that ArchiveWriter::finish adds.
struct Manifest {
  SequenceDatabase& database;
  std::string descriptor;
  std::optional<uint64_t> length;
  std::optional<double> unit;
  std::optional<Witness> features;
  std::optional<std::vector<std::array<size_t, 2>>> overlapping_sequences;
  std::optional<std::vector<std::array<uint32_t, 2>>> repeated_places;
};

template <class Visitor>
void visit_fields(Manifest& manifest, Visitor&& visit) {
  SequenceDatabase& database = manifest.database;
  visit("schema", Derived{schema_name("database")});
  visit("method", Derived{enum_name(DatabaseFamily::sequences)}, "fastable or fabmap.");
  visit("descriptor", manifest.descriptor, "Descriptor of the frames.");
  visit("length", IfSet{manifest.length}, "Dimensions of vectors, or bits.", at_least(1));
  visit("unit", IfSet{manifest.unit}, "Value of the coordinate 1, for points.", above(0));
  visit("features", IfSet{manifest.features}, "Local features of keyframes.");
  visit("settings", database.descriptor, "Description settings.");
  visit("sequences", database.sequences, "Training sequences, in the order of their codes.");
  visit("thresholds", database.thresholds,
        "Sources of automatic thresholds, one entry per window length; sequence methods only.");
  visit("overlapping_sequences", IfSet{manifest.overlapping_sequences},
        "Pairs of training sequences that show the same place, by index, the smaller first. "
        "Neither is a runner-up of the other in margins.");
  visit("repeated_places", IfSet{manifest.repeated_places},
        "Training frames of places that the training sequences passed before, each with the frame "
        "of the first pass; counted over all sequences.");
  visit("statistics", IfSet{database.statistics},
        "Start of z-scores: distances of training frames from the rest of the training data.");
  visit("provenance", NestedObject{[](auto&& inner) {
          visit_origin(inner, Derived{std::string("vpr-train")}, Derived{program_version()},
                       Derived{program_commit()});
        }},
        "Program that the file depends on.");
}

constexpr uint64_t kMaxImageSide = uint64_t{1} << 20;  // pixels, as OpenCV decodes
constexpr const char* kCodesFile = "codes.npy";
constexpr const char* kFramesFile = "frames.txt";
constexpr const char* kSourcesFile = "selected_frames.npy";  // selected frames of recordings
constexpr const char* kStatisticsFile = "statistics.npy";
constexpr const char* kFeaturesFile = "features.npy";  // of keyframes
constexpr const char* kFeatureCountsFile = "feature_counts.npy";

std::string one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

// Upper bound of the distances of stored descriptors.
double most_distance(const DescriptorShape& shape) {
  constexpr size_t kMost = 65535;
  return static_cast<double>(
      shape.element == ElementType::bits ? std::min(8 * shape.row_bytes(), kMost) : kMost);
}

// A number of at most `most`, and above 0 or at least 0.
double read_number(const Fields& fields, const std::string& key,
                   double most = std::numeric_limits<double>::max(), bool may_be_zero = false) {
  const Json& json = fields[key];
  if (!json.is_number()) fields.fail(fmt::format("\"{}\" is not a number", key));
  const auto number = json.get<double>();
  if (!(number >= 0 && number <= most) || (number == 0 && !may_be_zero))
    fields.fail(fmt::format("\"{}\" is out of range", key));
  return number;
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
  const Fields manifest = archive.fields(archive.manifest());
  manifest.read("sequences", sequences);
  auto first = frame_names.begin();
  for (TrainSequence& train : sequences) {
    Sequence& sequence = train.sequence;
    check_sequence(sequence, static_cast<uint64_t>(frame_names.end() - first), manifest.source());
    if (sequence.frames == 0) archive.fail("its frame counts do not match frames.txt");
    if (std::ranges::count(sequences, sequence.name,
                           [](const TrainSequence& one) { return one.sequence.name; }) > 1)
      archive.fail("two sequences have the same name");
    const double distance = train.typical_distance.value_or(-1);
    if (!(distance >= 0 && distance <= most_distance(shape)))
      archive.fail("\"typical_distance\" is out of range");
    const size_t radius = train.exclusion_radius.value_or(0);
    if (radius == 0 || radius > sequence.frames)
      archive.fail("\"exclusion_radius\" is out of range");
    if (sequence.size && std::ranges::max(*sequence.size) > kMaxImageSide)
      archive.fail("\"size\" is out of range");
    const auto end = first + static_cast<ptrdiff_t>(sequence.frames);
    sequence.frame_names.assign(first, end);
    first = end;
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
      [&] { archive.fail("selected_frames.npy does not fit its sequences"); });
  return sequences;
}

std::vector<ThresholdTable> read_thresholds(const Fields& manifest,
                                            const std::vector<TrainSequence>& sequences) {
  std::vector<ThresholdTable> tables;
  manifest.read("thresholds", tables);
  for (const ThresholdTable& table : tables) {
    const auto fits = [&](size_t sequence, size_t window) {
      return sequence < sequences.size() &&
             table.window_length <= sequences[sequence].sequence.frames &&
             window <= sequences[sequence].sequence.frames - table.window_length;
    };
    if (!(table.safety_factor > 0 && table.safety_factor <= 1e6))
      manifest.fail("\"safety_factor\" is out of range");
    if (table.window_length == 0 || table.closest.size() != sequences.size())
      manifest.fail("its thresholds do not fit its sequences");
    for (size_t s = 0; s < sequences.size(); ++s)
      if (const auto& closest = table.closest[s];
          closest &&
          (!fits(s, closest->window) || !fits(closest->other_sequence, closest->other_window)))
        manifest.fail("a closest pair of windows is out of range");
  }
  return tables;
}

std::vector<std::pair<size_t, size_t>> read_overlapping_sequences(const Fields& manifest,
                                                                  size_t sequences) {
  std::vector<std::array<size_t, 2>> lists;
  manifest.read("overlapping_sequences", lists);
  std::vector<std::pair<size_t, size_t>> pairs;
  for (const auto& [a, b] : lists) {
    if (a >= b || b >= sequences || (!pairs.empty() && std::pair(a, b) <= pairs.back()))
      manifest.fail("its \"overlapping_sequences\" are out of range or order");
    pairs.emplace_back(a, b);
  }
  return pairs;
}

std::vector<RepeatedPlace> read_repeated_places(const Fields& manifest, size_t frames) {
  std::vector<std::array<uint32_t, 2>> pairs;
  manifest.read("repeated_places", pairs);
  std::vector<RepeatedPlace> places;
  for (const auto& [frame, first_pass] : pairs) {
    if (frame >= frames || first_pass >= frame || (!places.empty() && frame <= places.back().frame))
      manifest.fail("its \"repeated_places\" are not pairs of frames in order");
    places.push_back({frame, first_pass});
  }
  return places;
}

TrainStatistics read_statistics(const Archive& archive, size_t frame_count,
                                const DescriptorShape& shape) {
  const Fields fields = archive.fields(archive.manifest()).object("statistics");
  TrainStatistics statistics;
  statistics.typical_distance = read_number(fields, "typical_distance", most_distance(shape), true);
  Json json = fields.json();
  json.erase("typical_distance");
  if (shape.element == ElementType::ldb_hog)
    statistics.code_distance = read_number(fields, "code_distance", kLdbBits, true);
  json.erase("code_distance");
  value_from_json(json, statistics.settings, JsonSource{archive.name(), kStoredSettingsForm},
                  "statistics");
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

KeyframeFeatures read_features(const Archive& archive, size_t frame_count) {
  const NpyArray counts = archive.array(kFeatureCountsFile);
  const auto rows = counts.values<int32_t>(2);
  const NpyArray features = archive.array(kFeaturesFile);
  const auto bytes = features.values<uint8_t>(2);
  if (features.shape()[1] != sizeof(LocalFeature) || counts.shape()[1] != 2)
    archive.fail("features.npy does not have one row of 40 bytes per feature");
  KeyframeFeatures read;
  read.all.resize(features.shape()[0]);
  if (!bytes.empty()) std::memcpy(read.all.data(), bytes.data(), bytes.size());
  for (const LocalFeature& feature : read.all)
    if (!(feature.x >= 0 && feature.x <= kMaxImageSide && feature.y >= 0 &&
          feature.y <= kMaxImageSide))
      archive.fail("features.npy has a position out of range");
  uint64_t end = 0;
  for (size_t i = 0; i < rows.size(); i += 2) {
    const int64_t frame = rows[i];
    const int64_t count = rows[i + 1];
    if (frame < 0 || static_cast<size_t>(frame) >= frame_count || count < 0 ||
        (!read.frames.empty() && frame <= read.frames.back()))
      archive.fail("feature_counts.npy is out of range or order");
    end += static_cast<uint64_t>(count);
    if (end > read.all.size()) archive.fail("feature_counts.npy does not fit features.npy");
    read.frames.push_back(static_cast<uint32_t>(frame));
    read.ends.push_back(static_cast<uint32_t>(end));
  }
  if (end != read.all.size()) archive.fail("feature_counts.npy does not fit features.npy");
  return read;
}

void write_features(const KeyframeFeatures& features, ArchiveWriter& writer) {
  std::vector<int32_t> counts;  // keyframe and number of features, interleaved
  for (size_t k = 0; k < features.frames.size(); ++k)
    counts.insert(counts.end(), {static_cast<int32_t>(features.frames[k]),
                                 static_cast<int32_t>(features.of(k).size())});
  writer.add_array(kFeatureCountsFile, std::span<const int32_t>(counts),
                   {features.frames.size(), 2});
  const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(features.all.data()),
                                       features.all.size() * sizeof(LocalFeature));
  writer.add_array(kFeaturesFile, bytes, {features.all.size(), sizeof(LocalFeature)});
}

void read_paths(const std::filesystem::path& file, std::vector<TrainSequence>& sequences) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return;
  const std::string text = read_whole_file(file);
  const auto lines = split_lines(text);
  for (size_t s = 0; s < std::min(lines.size(), sequences.size()); ++s)
    sequences[s].path = lines[s];
}

// Returns the fingerprint.
std::string write_content(const SequenceDatabase& database, ArchiveWriter writer) {
  const DescriptorRows rows = database.descriptors.rows();
  writer.add_array(kCodesFile, rows.bytes, {rows.size(), rows.shape.row_bytes()});
  std::string names;  // one per line, in the order of the codes
  for (const TrainSequence& train : database.sequences)
    for (const std::string& name : train.sequence.frame_names) names += one_line(name) + "\n";
  writer.add_text(kFramesFile, names);
  const std::vector<int32_t> sources = source_rows(pointers_of(database.sequences));
  if (!sources.empty())
    writer.add_array(kSourcesFile, std::span<const int32_t>(sources), {sources.size()});
  if (const auto& statistics = database.statistics) {
    std::vector<float> values;  // bias and variance of every frame, interleaved
    for (size_t i = 0; i < statistics->bias.size(); ++i)
      values.insert(values.end(), {statistics->bias[i], statistics->variance[i]});
    writer.add_array(kStatisticsFile, std::span<const float>(values), {rows.size(), 2});
  }
  if (database.features) write_features(*database.features, writer);
  Manifest manifest{const_cast<SequenceDatabase&>(database),  // visited, not changed
                    std::string(database.descriptors.kind->name), {}, {}, {}, {}, {}};
  if (database.descriptors.kind->is_imported) manifest.length = rows.shape.length;
  if (rows.shape.element == ElementType::points16) manifest.unit = database.descriptors.unit;
  if (database.features) manifest.features = Witness::orb;
  if (database.overlapping_sequences)
    for (auto& pairs = manifest.overlapping_sequences.emplace();
         const auto& [a, b] : *database.overlapping_sequences)
      pairs.push_back({a, b});
  if (database.repeated_places)
    for (auto& pairs = manifest.repeated_places.emplace();
         const RepeatedPlace& place : *database.repeated_places)
      pairs.push_back({place.frame, place.first_pass});
  return writer.finish(value_to_json(manifest, kDataForm));
}

}  // namespace

Json sequence_manifest_schema() {
  SequenceDatabase database;
  Manifest manifest{database, {}, {}, {}, {}, {}, {}};
  return with_files(field_schema(manifest, SchemaForm::data));
}

SequenceDatabase read_sequence_database(const std::filesystem::path& path) {
  const Archive archive(path);
  require_family(archive, DatabaseFamily::sequences);
  SequenceDatabase database;
  database.fingerprint = archive.fingerprint();
  const Fields manifest = archive.fields(archive.manifest());
  manifest.read_settings("settings", database.descriptor);
  const std::string descriptor = manifest.text("descriptor");
  const DescriptorKind* kind = find_descriptor_kind(descriptor);
  if (kind == nullptr)
    throw Error(ErrorKind::data,
                "{}: its frames are described by {}, which this version does not support",
                archive.name(), descriptor);
  DescriptorShape shape = kind->shape;
  if (shape.length == 0) shape.length = manifest.count("length", max_elements(shape.element));
  if (shape.length == 0) archive.fail("\"length\" is out of range");
  const std::string names = archive.text(kFramesFile);
  auto frame_names = split(names, '\n');
  if (frame_names.back().empty()) frame_names.pop_back();  // after the end of the last line
  database.sequences = read_sequences(archive, frame_names, shape);
  read_paths(path / kPathsName, database.sequences);
  database.thresholds = read_thresholds(manifest, database.sequences);
  const size_t frames = frame_names.size();
  NpyArray codes = archive.array(kCodesFile);
  codes.values<uint8_t>(2);
  if (codes.shape()[0] != frames || codes.shape()[1] != shape.row_bytes())
    archive.fail(
        fmt::format("codes.npy does not have one row of {} bytes per frame", shape.row_bytes()));
  const bool has_unit = shape.element == ElementType::points16;
  database.descriptors = {kind,
                          {},
                          std::make_shared<const NpyArray>(std::move(codes)),
                          shape.length,
                          has_unit ? read_number(manifest, "unit") : 0};
  database.statistics = read_statistics(archive, frames, shape);
  database.overlapping_sequences = read_overlapping_sequences(manifest, database.sequences.size());
  if (manifest.has("repeated_places"))
    database.repeated_places = read_repeated_places(manifest, frames);
  if (manifest.has("features")) {
    if (manifest.text("features") != enum_name(Witness::orb))
      archive.fail("its kind of \"features\" is unknown");
    database.features = read_features(archive, frames);
  }
  return database;
}

void write_sequence_database(const std::filesystem::path& path, const SequenceDatabase& database,
                             Outputs& outputs) {
  Output& folder = outputs.folder(path, is_database_folder);
  std::string paths;
  for (const TrainSequence& train : database.sequences) paths += one_line(train.path) + "\n";
  write_part(folder.temporary() / kPathsName, paths);
  write_content(database, ArchiveWriter(&folder));
}

std::string database_fingerprint(const SequenceDatabase& database) {
  return write_content(database, ArchiveWriter(nullptr));
}

std::vector<std::string> names_of(const SequenceDatabase& database) {
  std::vector<std::string> names;
  for (const TrainSequence& train : database.sequences) names.push_back(train.sequence.name);
  return names;
}

const ThresholdTable* find_thresholds(std::span<const ThresholdTable> tables,
                                      size_t window_length) {
  for (const ThresholdTable& table : tables)
    if (table.window_length == window_length) return &table;
  return nullptr;
}

}  // namespace vpr
