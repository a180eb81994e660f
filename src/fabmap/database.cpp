#include "fabmap/database.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <map>
#include <numeric>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "base/json.h"
#include "base/json_schema.h"
#include "base/provenance.h"
#include "base/text.h"
#include "database/archive.h"
#include "fabmap/chow_liu.h"
#include "present/table.h"
#include "recordings/sequence_json.h"

namespace vpr {

template <class Visitor>
void visit_fields(ViewGroup& group, Visitor&& visit) {
  visit("name", group.sequence.name, "Name of the group.");
  const auto write_places = [&](Json& json, const std::string& key) {
    json[key] = group.is_place ? "one" : "each frame";
  };
  visit("places",
        CustomField{write_places,
                    [&](const Fields& fields, const std::string& key) {
                      group.is_place = fields.text(key) == "one";
                    }},
        "Whether the group is one place or each of its frames is a place.",
        Matches{"^one$|^each frame$"}, kAs<std::string>);
  visit_sequence(group.sequence, visit,
                 [&] { visit("unreadable", group.sequence.unreadable, kUnreadableText); });
}

template <class Visitor>
void visit_fields(FabmapDatabase& database, Visitor&& visit) {
  visit("schema", Derived{schema_name("database")});
  visit("method", Derived{enum_name(DatabaseFamily::fabmap)}, "fastable or fabmap.");
  visit("settings", database.settings, "Description settings.");
  visit("groups", database.groups, "Frames that were trained together.");
  visit("provenance", NestedObject{[&](auto&& inner) {
          visit_origin(inner, Derived{std::string("vpr-train")}, Derived{program_version()},
                       Derived{program_commit()});
          inner("seed", database.seed, "Seed of random choices.");
        }},
        "Program and seed that the file depends on.");
}

namespace {

/// Calls visit(group, frame, place index) for every view.
template <class Visit>
void for_each_view(const std::vector<ViewGroup>& groups, Visit&& visit) {
  std::map<std::string, uint32_t> named;
  uint32_t next = 0;
  for (const ViewGroup& group : groups) {
    uint32_t shared = 0;
    if (group.is_place) {
      const auto [entry, is_new] = named.emplace(group.sequence.name, next);
      shared = entry->second;
      if (is_new) ++next;
    }
    for (size_t frame = 0; frame < group.sequence.frames; ++frame)
      visit(group, frame, group.is_place ? shared : next++);
  }
}

template <class T>
void add_list(ArchiveWriter& writer, const std::string& name, const std::vector<T>& values) {
  writer.add_array<T>(name, values, {values.size()});
}

template <class T>
std::vector<T> read_list(const Archive& archive, const std::string& name) {
  const NpyArray array = archive.array(name);
  const auto values = array.values<T>(1);
  return {values.begin(), values.end()};
}

ViewWords read_words(const Archive& archive, const std::string& name,
                     const std::string& offsets_name, size_t words) {
  const ViewWords read{read_list<uint64_t>(archive, offsets_name),
                       read_list<uint32_t>(archive, name)};
  bool fits = !read.offsets.empty() && read.offsets.front() == 0 &&
              read.offsets.back() == read.words.size() &&
              std::is_sorted(read.offsets.begin(), read.offsets.end());
  for (size_t v = 0; fits && v < read.views(); ++v) {
    const auto view = read.view(v);
    fits = (view.empty() || view.back() < words) &&
           std::adjacent_find(view.begin(), view.end(), std::greater_equal<>()) == view.end();
  }
  if (!fits) archive.fail(name + " and its offsets do not match");
  return read;
}

WordIndex read_index(const Archive& archive, const ViewWords& views, size_t words) {
  const WordIndex index{words, views.views(), read_list<uint64_t>(archive, "index_offsets.npy"),
                        read_list<uint16_t>(archive, "index.npy")};
  if (!is_valid_index(index) || index.lists.size() != views.words.size())
    archive.fail("index.npy and its offsets do not match the places");
  return index;
}

cv::Mat read_vocabulary(const Archive& archive, FeatureKind kind) {
  const NpyArray array = archive.array("vocabulary.npy");
  if (array.shape().size() != 2 || array.shape()[0] == 0 || array.shape()[0] > 100'000'000 ||
      array.shape()[1] != static_cast<size_t>(descriptor_length(kind)))
    archive.fail("vocabulary.npy does not match the features");
  const int rows = static_cast<int>(array.shape()[0]);
  const int cols = static_cast<int>(array.shape()[1]);
  if (is_binary(kind))
    return cv::Mat(rows, cols, CV_8U, const_cast<uint8_t*>(array.values<uint8_t>(2).data()))
        .clone();
  const cv::Mat words(rows, cols, CV_32F, const_cast<float*>(array.values<float>(2).data()));
  if (!cv::checkRange(words)) archive.fail("a word in vocabulary.npy is not finite");
  return words.clone();
}

std::vector<ViewGroup> read_groups(const Archive& archive, const std::string& names) {
  std::vector<ViewGroup> groups;
  const Fields manifest = archive.fields(archive.manifest());
  manifest.read("groups", groups);
  size_t at = 0;
  for (ViewGroup& group : groups) {
    check_sequence(group.sequence, names.size(), manifest.source());
    if (group.sequence.frames == 0) archive.fail("a group has no frames");
    for (size_t frames = group.sequence.frames; frames > 0; --frames) {
      const size_t end = names.find('\n', at);
      if (end == std::string::npos) archive.fail("its frame counts do not match frames.txt");
      group.sequence.frame_names.push_back(names.substr(at, end - at));
      at = end + 1;
    }
  }
  if (at != names.size()) archive.fail("its frame counts do not match frames.txt");
  return groups;
}

std::string write_content(const FabmapDatabase& database, ArchiveWriter writer) {
  const cv::Mat& words = database.vocabulary;
  const std::vector<size_t> shape = {static_cast<size_t>(words.rows),
                                     static_cast<size_t>(words.cols)};
  if (words.type() == CV_8U)
    writer.add_array<uint8_t>("vocabulary.npy", {words.ptr(), words.total()}, shape);
  else
    writer.add_array<float>("vocabulary.npy", {words.ptr<float>(), words.total()}, shape);
  writer.add_array<double>("tree.npy", tree_rows(database.tree), {4, database.tree.words()});
  add_list(writer, "pretrain.npy", database.pretrain.words);
  add_list(writer, "pretrain_offsets.npy", database.pretrain.offsets);
  add_list(writer, "places.npy", database.views.words);
  add_list(writer, "place_offsets.npy", database.views.offsets);
  assert(database.index.views == database.views.views());
  add_list(writer, "index.npy", database.index.lists);
  add_list(writer, "index_offsets.npy", database.index.offsets);
  std::string names;
  for (const ViewGroup& group : database.groups) {
    for (std::string name : group.sequence.frame_names) {
      std::replace(name.begin(), name.end(), '\n', ' ');
      names += name + "\n";
    }
  }
  writer.add_text("frames.txt", names);
  return writer.finish(value_to_json(database, kDataForm));
}

}  // namespace

std::vector<size_t> FabmapDatabase::unreadable_views() const {
  std::vector<size_t> unreadable;
  size_t first = 0;
  for (const ViewGroup& group : groups) {
    for (const size_t frame : group.sequence.unreadable) unreadable.push_back(first + frame);
    first += group.sequence.frames;
  }
  return unreadable;
}

std::vector<uint32_t> FabmapDatabase::places() const {
  std::vector<uint32_t> places;
  for_each_view(groups, [&](const ViewGroup&, size_t, uint32_t place) { places.push_back(place); });
  return places;
}

std::vector<std::string> FabmapDatabase::place_names() const {
  std::vector<std::string> names;
  for_each_view(groups, [&](const ViewGroup& group, size_t frame, uint32_t place) {
    if (place < names.size()) return;
    const std::string& name = group.sequence.name;
    names.push_back(group.is_place ? name : fmt::format("{}#{}", name, frame));
  });
  return names;
}

std::vector<size_t> featureless_frames(const FabmapDatabase& database) {
  std::vector<size_t> counts;
  size_t view = 0;
  for (const ViewGroup& group : database.groups) {
    const auto& unreadable = group.sequence.unreadable;
    counts.push_back(0);
    for (size_t frame = 0; frame < group.sequence.frames; ++frame, ++view)
      if (database.views.view(view).empty() && !std::ranges::binary_search(unreadable, frame))
        ++counts.back();
  }
  return counts;
}

void add_group(FabmapDatabase& database, const ViewGroup& group, std::span<const WordSet> frames) {
  for (const WordSet& frame : frames) database.views.add(frame);
  database.groups.push_back(group);
}

void index_views(FabmapDatabase& database) {
  database.index = make_word_index(database.views, database.tree.words());
}

FabmapDatabase read_fabmap_database(const std::filesystem::path& path) {
  const Archive archive(path);
  require_family(archive, DatabaseFamily::fabmap);
  FabmapDatabase database;
  database.fingerprint = archive.fingerprint();
  archive.fields(archive.manifest()).read_settings("settings", database.settings);
  const auto provenance = archive.manifest().find("provenance");
  if (provenance == archive.manifest().end()) archive.fail("\"provenance\" is missing");
  database.seed = archive.fields(*provenance).count("seed", std::numeric_limits<size_t>::max());
  database.vocabulary = read_vocabulary(archive, database.settings.features.kind);
  const auto words = static_cast<size_t>(database.vocabulary.rows);
  const NpyArray tree = archive.array("tree.npy");
  if (tree.shape() != std::vector<size_t>{4, words}) archive.fail("tree.npy is not 4 x words");
  database.tree = tree_of_rows(tree.values<double>(2), archive.name() + "/tree.npy");
  database.pretrain = read_words(archive, "pretrain.npy", "pretrain_offsets.npy", words);
  if (database.pretrain.views() == 0) archive.fail("there are no pretraining frames");
  database.views = read_words(archive, "places.npy", "place_offsets.npy", words);
  database.index = read_index(archive, database.views, words);
  database.groups = read_groups(archive, archive.text("frames.txt"));
  if (database.places().size() != database.views.views())
    archive.fail("its views do not match its groups");
  return database;
}

std::string database_fingerprint(const FabmapDatabase& database) {
  return write_content(database, ArchiveWriter(nullptr));
}

AnyDatabase read_database(const std::filesystem::path& path) {
  if (database_family(path) == DatabaseFamily::fabmap) return read_fabmap_database(path);
  return read_sequence_database(path);
}

void write_database(const std::filesystem::path& path, const AnyDatabase& database,
                    Outputs& outputs) {
  if (const auto* sequences = std::get_if<SequenceDatabase>(&database))
    write_sequence_database(path, *sequences, outputs);
  else
    write_content(std::get<FabmapDatabase>(database),
                  ArchiveWriter(&outputs.folder(path, is_database_folder)));
}

std::vector<std::string> names_of(const FabmapDatabase& database) {
  std::vector<std::string> names;
  for (const ViewGroup& group : database.groups) names.push_back(group.sequence.name);
  return names;
}

namespace {

/// The output of vpr-train --json.
struct DatabaseInfo {
  FabmapTrainSettings settings;
  size_t words = 0, pretraining_frames = 0, views = 0, featureless_views = 0;
  std::vector<std::string> places;
  Provenance provenance;
  std::string_view method = enum_name(DatabaseFamily::fabmap);
};

VPR_FILE(DatabaseInfo, "database-info", (method, "fastable or fabmap."),
         (settings, "Settings that can change the numbers; keys are the names of flags."),
         (words, "Words of the vocabulary."), (pretraining_frames, "Frames of vocabulary."),
         (views, "Views of all places."), (featureless_views, "Frames without words."),
         (places, "Names of the places."), (provenance, kProvenanceText))

}  // namespace

Json database_json(const FabmapDatabase& database, const RunInfo& run) {
  const std::vector<size_t> featureless = featureless_frames(database);
  return value_to_json(
      DatabaseInfo{database.settings, database.tree.words(), database.pretrain.views(),
                   database.views.views(),
                   std::accumulate(featureless.begin(), featureless.end(), size_t{0}),
                   database.place_names(), provenance_of(run)},
      kDataForm);
}

Json fabmap_manifest_schema() { return with_files(schema_of<FabmapDatabase>()); }

Json fabmap_info_schema() { return schema_of<DatabaseInfo>(); }

std::string database_text(const FabmapDatabase& database, const std::string& name) {
  Table table;
  table.title = fmt::format(
      "{}: {}, {} of {}, {}, {}", name, enum_name(DatabaseFamily::fabmap),
      counted(database.tree.words(), "word"), enum_name(database.settings.features.kind),
      counted(database.place_names().size(), "place"), counted(database.views.views(), "view"));
  table.columns = {"group", "frames", "places", "words per frame", "featureless"};
  const std::vector<size_t> featureless = featureless_frames(database);
  size_t view = 0;
  for (const ViewGroup& group : database.groups) {
    const size_t first = view;
    view += group.sequence.frames;
    const auto words =
        static_cast<double>(database.views.offsets[view] - database.views.offsets[first]);
    add_row(table, group.sequence.name, group.sequence.frames,
            group.is_place ? "one" : "each frame",
            fmt::format("{:.1f}", words / static_cast<double>(view - first)),
            featureless[table.rows.size()]);
  }
  return render_table(table, TableFormat::text);
}

}  // namespace vpr
