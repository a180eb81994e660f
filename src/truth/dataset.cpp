#include "truth/dataset.h"

#include <functional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json.h"
#include "base/json_schema.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

/// A path relative to the folder of the file; it stays empty if the key is missing.
auto path_field(fs::path& path, const fs::path& folder) {
  return ReadField{[&](const Fields& fields, const std::string& key) {
    if (fields.has(key)) path = folder / fields.text(key);
  }};
}

SequenceArgument sequence_argument(const std::string& text, const fs::path& folder) {
  return parse_sequence_argument((folder / text).string());  // an absolute path stays
}

auto sequences_field(std::vector<SequenceArgument>& sequences, const fs::path& folder) {
  return ReadField{[&](const Fields& fields, const std::string& key) {
    std::vector<std::string> texts;
    if (fields.has(key)) fields.read(key, texts);
    for (const std::string& text : texts) sequences.push_back(sequence_argument(text, folder));
  }};
}

/// A string that must not be missing.
auto required_text(std::string& text) {
  return ReadField{[&](const Fields& fields, const std::string& key) { text = fields.text(key); }};
}

template <class Visitor>
void visit_sequence(NamedSequence& named, const fs::path& folder, Visitor&& visit) {
  visit("name", required_text(named.name), "Name of the sequence.", kRequired);
  visit("sequence", ReadField{[&](const Fields& fields, const std::string& key) {
          named.sequence = sequence_argument(fields.text(key), folder);
        }},
        "Folder, list or video, with a range.", kRequired);
  visit("poses", path_field(named.poses, folder),
        "CSV frame,x,y with optional heading and floor: positions, in m.");
}

/// A ground truth and the folder of its file.
struct TruthInFile {
  GroundTruthArgument argument;
  fs::path folder;
};

template <class Visitor>
void visit_fields(TruthInFile& file, Visitor&& visit) {
  GroundTruthArgument& argument = file.argument;
  visit("path", path_field(argument.path, file.folder), "Relative to this file.");
  visit("format", argument.format, "Format or preset; default: by content.");
  visit("tolerance", argument.tolerance_frames, "Tolerance, in frames.", at_least(0));
  visit_fields(argument.options,
               [&](const char* name, auto& option, std::string_view text, const auto&... hints) {
                 if constexpr (std::is_same_v<decltype(option), fs::path&>)
                   visit(name, path_field(option, file.folder), text);
                 else
                   visit(name, option, text, hints...);
               });
}

auto truth_field(std::optional<GroundTruthArgument>& truth, const fs::path& folder) {
  return ReadField{[&](const Fields& fields, const std::string& key) {
    if (!fields.has(key)) return;
    TruthInFile file{{}, folder};
    const JsonSource source{fields.where() + ", " + key, fields.source().form};
    value_from_json(fields[key], file, source, key);
    if (file.argument.tolerance_frames < 0) source.fail("\"tolerance\" must not be negative");
    if (file.argument.format.empty() && file.argument.path.empty())
      source.fail("needs a \"format\" or a \"path\"");
    truth = std::move(file.argument);
  }};
}

/// A data set and the folder of its file.
struct DatasetFile {
  Dataset& dataset;
  const fs::path folder;
};

template <class Visitor>
void visit_fields(DatasetFile& file, Visitor&& visit) {
  using Texts = std::vector<std::string>;
  Dataset& dataset = file.dataset;
  const fs::path& base = file.folder;
  visit("schema", Derived{schema_name("dataset")});
  visit("name", required_text(dataset.name), "Name of the data set in tables and pages.",
        kRequired);
  visit("fps", dataset.frames_per_second, "Frames per second of the recordings.", at_least(0));
  visit("pretrain", sequences_field(dataset.pretrain, base), "Vocabulary sequences.", kAs<Texts>);
  visit("train",
        NestedList{dataset.train,
                   [&](NamedSequence& train, auto&& inner) { visit_sequence(train, base, inner); }},
        "Training sequences of the sequence methods.");
  visit("places",
        NestedList{dataset.places,
                   [&](DatasetPlace& place, auto&& inner) {
                     inner("name", required_text(place.name), "Name of the place.", kRequired);
                     inner("sequences", sequences_field(place.views, base),
                           "Sequences of its views.", kAs<Texts>, kRequired);
                   }},
        "FAB-MAP's places.");
  visit("queries",
        NestedList{dataset.queries,
                   [&](DatasetQuery& query, auto&& inner) {
                     visit_sequence(query.sequence, base, inner);
                     inner("ground_truth", truth_field(query.sequence_ground_truth, base),
                           "Ground truth.", kAs<TruthInFile>);
                     inner("place_ground_truth", truth_field(query.place_ground_truth, base),
                           "Ground truth of places.", kAs<TruthInFile>);
                   }},
        "Query sequences.");
  visit("plan", path_field(dataset.plan, base), "CSV of walls.");
  visit("place_poses", path_field(dataset.place_poses, base), "CSV place,x,y with optional floor.");
}

// An unset variable of the program that wrote the file.
void refuse_empty_strings(const Json& json, const std::string& where) {
  for (const auto& [key, value] : json.items()) {
    if (value.is_string() && value.get<std::string>().empty())
      throw Error(ErrorKind::usage, "{}: the value of \"{}\" is empty. Omit it", where, key);
    if (value.is_structured()) refuse_empty_strings(value, fmt::format("{}, {}", where, key));
  }
}

// `name_of` returns the name of an item.
void check_names(const auto& items, const std::string& where, auto name_of) {
  std::set<std::string> seen;
  for (const auto& item : items) {
    const std::string& name = std::invoke(name_of, item);
    if (!seen.insert(name).second)
      throw Error(ErrorKind::usage, "{}: the name \"{}\" is used twice", where, name);
  }
}

}  // namespace

Dataset read_dataset(const fs::path& path) {
  const std::string where = path.string();
  const Json json = read_json(path, ErrorKind::usage);
  require_schema(json, "dataset", where, ErrorKind::usage);
  refuse_empty_strings(json, where);
  Dataset dataset;
  DatasetFile file{dataset, path.parent_path()};
  value_from_json(json, file, where, "the data set");
  if (!(dataset.frames_per_second >= 0))
    throw Error(ErrorKind::usage, "{}: \"fps\" must not be negative", where);
  for (const DatasetPlace& place : dataset.places)
    if (place.views.empty())
      throw Error(ErrorKind::usage, "{}, places: \"{}\" has no sequences", where, place.name);
  check_names(dataset.train, where + ", train", &NamedSequence::name);
  check_names(dataset.places, where + ", places", &DatasetPlace::name);
  check_names(dataset.queries, where + ", queries",
              [](const DatasetQuery& query) -> const std::string& { return query.sequence.name; });
  for (DatasetQuery& query : dataset.queries)
    if (query.place_ground_truth)
      for (const DatasetPlace& place : dataset.places)
        query.place_ground_truth->places.push_back(place.name);
  return dataset;
}

Json dataset_schema() {
  Dataset dataset;
  DatasetFile file{dataset, {}};
  return field_schema(file, SchemaForm::partial);
}

const DatasetQuery& select_query(const Dataset& dataset, const std::optional<std::string>& name) {
  std::vector<std::string> names;
  for (const DatasetQuery& query : dataset.queries) {
    if (name == query.sequence.name || (!name && dataset.queries.size() == 1)) return query;
    names.push_back(query.sequence.name);
  }
  if (names.empty()) throw Error(ErrorKind::usage, "the data set {} has no queries", dataset.name);
  throw Error(ErrorKind::usage, "the data set {} has {}. Choose one of {} with --query NAME",
              dataset.name, name ? "no query " + *name : "several queries", fmt::join(names, ", "));
}

}  // namespace vpr
