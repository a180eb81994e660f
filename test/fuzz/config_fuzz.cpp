// Any bytes as a file for --config: settings of every method, and a small query with accepted ones.
#include "base/json.h"
#include "bench/generated.h"
#include "common/parser.h"
#include "fabmap/place_query.h"
#include "fuzz.h"
#include "query/choices.h"
#include "query/prepare.h"
#include "query/run_query.h"
#include "query/train_sequences.h"

using namespace vpr;

namespace {

constexpr size_t kFrames = 12;

template <class S>
S settings_from(const Json& json) {
  S settings;
  value_from_json(json, settings, "config", "settings");
  value_to_json(settings);
  return settings;
}

SequenceDatabase make_database() {
  SequenceDatabase database;
  database.sequences.push_back({{"walk", kFrames, std::vector<std::string>(kFrames)}});
  database.descriptors.append(generate_sequence(kFrames, 1));
  database.statistics =
      TrainStatistics{{}, 400, std::vector<float>(kFrames, 0), std::vector<float>(kFrames, 4096)};
  ensure_statistics(database, {});
  return database;
}

void query(const Json& json) {
  std::vector<std::string> given;
  for (const auto& item : json.items()) given.push_back(item.key());
  const SequenceQuerySettings settings =
      choose_query(settings_from<SequenceKeys>(json), given, QueryCommand::query);
  settings_in_force(settings);
  static const SequenceDatabase kDatabase = make_database();
  DescriptorSet query;
  query.descriptors.append(generate_sequence(kFrames, 2));
  query.sequence.frames = kFrames;
  QueryResources resources;
  resources.memory_limit = size_t{1} << 26;
  run_query(
      plan_query(prepare(kDatabase, settings, resources), query, "q", settings, resources, {}), {},
      {});
}

}  // namespace

void fuzz::run(std::string_view input) {
  const Json json = read_config(memory_file(input));
  refuses([&] { query(json); });
  refuses([&] { check_query_settings(settings_from<FabmapQuerySettings>(json)); });
  refuses([&] { settings_from<SequenceTrainSettings>(json); });
  refuses([&] { settings_from<FabmapTrainSettings>(json); });
}
