#include "truth/dataset.h"

#include <algorithm>
#include <functional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

/// Reads one object of the file: consumes keys, and reports those that remain.
class ObjectReader {
 public:
  ObjectReader(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
    if (!json.is_object()) fail("must be an object");
  }

  const Json* find(const std::string& key) {
    known_.push_back(key);
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
  }
  const Json& require(const std::string& key) {
    const Json* found = find(key);
    if (found == nullptr) fail(fmt::format("needs the key \"{}\"", key));
    return *found;
  }
  std::string text(const std::string& key) {
    std::string value;
    value_from_json(require(key), value, where_, key);
    return value;
  }
  const Json& list(const std::string& key) {
    const Json* found = find(key);
    static const Json kEmpty = Json::array();
    if (found == nullptr) return kEmpty;
    if (!found->is_array()) fail(fmt::format("\"{}\" must be a list", key));
    return *found;
  }
  void finish() const { JsonSource{where_, kSettingsForm}.refuse_unknown(json_, known_); }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::usage, fmt::format("{}: {}", where_, what));
  }
  const std::string& where() const { return where_; }

 private:
  const Json& json_;
  std::string where_;
  std::vector<std::string> known_;
};

SequenceArgument sequence_argument(const Json& json, const fs::path& folder,
                                   const std::string& where) {
  std::string text;
  value_from_json(json, text, where, "sequence");
  return parse_sequence_argument((folder / text).string());  // an absolute path stays
}

// Relative to the description; empty if the key is missing.
fs::path optional_path(ObjectReader& reader, const std::string& key, const fs::path& folder) {
  return reader.find(key) == nullptr ? fs::path() : folder / reader.text(key);
}

NamedSequence named_sequence(ObjectReader& reader, const fs::path& folder) {
  return {reader.text("name"),
          sequence_argument(reader.require("sequence"), folder, reader.where()),
          optional_path(reader, "poses", folder)};
}

void read_options(ObjectReader& reader, const fs::path& folder, GroundTruthArgument& argument) {
  if (reader.find("format") != nullptr) argument.format = reader.text("format");
  visit_paths(argument.options, [&](const char* name, fs::path& file) {
    file = optional_path(reader, name, folder);
  });
  const auto read = [&](const char* name, auto& field) {
    if (const Json* value = reader.find(name)) value_from_json(*value, field, reader.where(), name);
  };
  read("tolerance", argument.tolerance_frames);
  visit_fields(argument.options, read);
  if (argument.tolerance_frames < 0) reader.fail("\"tolerance\" must not be negative");
  reader.finish();
}

std::optional<GroundTruthArgument> ground_truth(ObjectReader& query, const std::string& key,
                                                const fs::path& folder) {
  const Json* json = query.find(key);
  if (json == nullptr) return std::nullopt;
  ObjectReader reader(*json, query.where() + ", " + key);
  GroundTruthArgument argument;
  argument.path = optional_path(reader, "path", folder);
  read_options(reader, folder, argument);
  if (argument.format.empty() && argument.path.empty())
    reader.fail("needs a \"format\" or a \"path\"");
  return argument;
}

// `name_of` returns the name of an item.
void check_names(const auto& items, const std::string& where, auto name_of) {
  std::set<std::string> seen;
  for (const auto& item : items) {
    const std::string& name = std::invoke(name_of, item);
    if (name.empty()) throw Error(ErrorKind::usage, fmt::format("{}: a name is empty", where));
    if (!seen.insert(name).second)
      throw Error(ErrorKind::usage, fmt::format("{}: the name \"{}\" is used twice", where, name));
  }
}

}  // namespace

void read_ground_truth_settings(const Json& json, const fs::path& folder, const std::string& where,
                                GroundTruthArgument& argument) {
  ObjectReader reader(json, where);
  read_options(reader, folder, argument);
}

Dataset read_dataset(const fs::path& path) {
  const std::string where = path.string();
  const Json json = read_json(path, ErrorKind::usage);
  require_schema(json, "dataset", where, ErrorKind::usage);
  const fs::path folder = path.parent_path();
  ObjectReader reader(json, where);
  reader.find("schema");
  Dataset dataset;
  dataset.name = reader.text("name");
  if (const Json* fps = reader.find("fps"))
    value_from_json(*fps, dataset.frames_per_second, where, "fps");
  for (const Json& item : reader.list("pretrain"))
    dataset.pretrain.push_back(sequence_argument(item, folder, where + ", pretrain"));
  if (!(dataset.frames_per_second >= 0)) reader.fail("\"fps\" must not be negative");
  for (const Json& item : reader.list("train")) {
    ObjectReader train(item, where + ", train");
    dataset.train.push_back(named_sequence(train, folder));
    train.finish();
  }
  check_names(dataset.train, where + ", train", &NamedSequence::name);
  for (const Json& item : reader.list("places")) {
    ObjectReader place(item, where + ", places");
    DatasetPlace& added = dataset.places.emplace_back();
    added.name = place.text("name");
    for (const Json& view : place.list("sequences"))
      added.views.push_back(sequence_argument(view, folder, place.where()));
    place.finish();
    if (added.views.empty()) place.fail(fmt::format("\"{}\" has no sequences", added.name));
  }
  check_names(dataset.places, where + ", places", &DatasetPlace::name);
  for (const Json& item : reader.list("queries")) {
    ObjectReader query(item, where + ", queries");
    DatasetQuery& added = dataset.queries.emplace_back();
    added.sequence = named_sequence(query, folder);
    added.sequence_ground_truth = ground_truth(query, "ground_truth", folder);
    added.place_ground_truth = ground_truth(query, "place_ground_truth", folder);
    query.finish();
  }
  check_names(dataset.queries, where + ", queries",
              [](const DatasetQuery& query) -> const std::string& { return query.sequence.name; });
  dataset.plan = optional_path(reader, "plan", folder);
  dataset.place_poses = optional_path(reader, "place_poses", folder);
  reader.finish();
  return dataset;
}

const DatasetQuery& select_query(const Dataset& dataset, const std::optional<std::string>& name) {
  std::vector<std::string> names;
  for (const DatasetQuery& query : dataset.queries) {
    if (name == query.sequence.name || (!name && dataset.queries.size() == 1)) return query;
    names.push_back(query.sequence.name);
  }
  if (names.empty())
    throw Error(ErrorKind::usage, fmt::format("the data set {} has no queries", dataset.name));
  throw Error(
      ErrorKind::usage,
      fmt::format("the data set {} has {}. Choose one of {} with --query NAME", dataset.name,
                  name ? "no query " + *name : "several queries", fmt::join(names, ", ")));
}

}  // namespace vpr
