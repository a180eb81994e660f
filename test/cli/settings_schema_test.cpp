// docs/schemas/common.schema.json defines the settings as in their structs: keys, types, names and
// order follow visit_fields; the schema adds descriptions, and bounds that a type does not imply.
#include <cstdlib>
#include <fstream>
#include <map>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "bench/benches.h"
#include "common/command.h"
#include "present/table.h"
#include "run/train_sequences.h"
#include "settings/query_settings.h"
#include "support.h"
#include "words/database.h"

using namespace vpr;
using namespace vpr::test;

namespace {

/// The settings of vpr-eval, which are values of its flags.
struct EvalOptions {
  std::optional<uint64_t> tolerance;
  TableFormat format = TableFormat::text;
};
template <class Visitor>
void visit_fields(EvalOptions& options, Visitor&& visit) {
  visit("tolerance", options.tolerance);
  visit("format", options.format);
}

// The names of the definitions; a struct without a name has none.
template <class S>
constexpr const char* kDefinition = nullptr;
template <>
constexpr const char* kDefinition<ZScoreSettings> = "zscore_settings";
template <>
constexpr const char* kDefinition<FilterSettings> = "filter_settings";
template <>
constexpr const char* kDefinition<LshSettings> = "lsh_settings";
template <>
constexpr const char* kDefinition<ClusterSettings> = "cluster_settings";
template <>
constexpr const char* kDefinition<PosteriorSettings> = "posterior_settings";
template <>
constexpr const char* kDefinition<StatisticsSettings> = "statistics_settings";
template <>
constexpr const char* kDefinition<FeatureSettings> = "feature_settings";

Json reference(const std::string& definition) { return {{"$ref", "#/$defs/" + definition}}; }

// A part of `old`, or an empty object.
Json part(const Json& old, const std::string& key) {
  return old.is_object() && old.contains(key) ? old[key] : Json::object();
}

template <class T>
Json schema_of(const Json& old);

template <class T>
Json type_of(const Json& old) {
  if constexpr (Settings<T>) {
    return reference(kDefinition<T>);
  } else if constexpr (detail::kIsOptional<T>) {
    using Value = typename T::value_type;
    if constexpr (std::is_enum_v<Value>) {
      Json schema = type_of<Value>({});
      schema["enum"].push_back("auto");
      return schema;
    } else {
      return reference(std::is_floating_point_v<Value> ? "auto_number" : "auto_count");
    }
  } else if constexpr (detail::kIsList<T>) {
    return {{"type", "array"}, {"items", schema_of<typename T::value_type>(part(old, "items"))}};
  } else if constexpr (std::is_enum_v<T>) {
    return {{"enum", kEnumNames<T>}};
  } else if constexpr (std::is_same_v<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_integral_v<T>) {
    Json schema = {{"type", "integer"}};
    if (std::is_unsigned_v<T> && !old.contains("minimum")) schema["minimum"] = 0;
    return schema;
  } else if constexpr (std::is_floating_point_v<T>) {
    return {{"type", "number"}};
  } else {
    static_assert(std::is_same_v<T, std::string>);
    return {{"type", "string"}};
  }
}

template <class T>
Json schema_of(const Json& old) {
  Json schema = Json::object();
  if (old.contains("description")) schema["description"] = old["description"];
  schema.update(type_of<T>(old.is_object() ? old : Json::object()));
  for (const char* bound : {"exclusiveMinimum", "minimum", "maximum", "pattern"})
    if (old.contains(bound)) schema[bound] = old[bound];
  return schema;
}

// Settings that other definitions extend: each key is optional, and other keys are permitted.
template <class S>
Json open(const Json& old) {
  S settings;
  Json properties = Json::object();
  visit_fields(settings, [&]<class T>(const char* key, T&) {
    properties[key] = schema_of<T>(part(part(old, "properties"), key));
  });
  return {{"type", "object"}, {"properties", properties}};
}

// Settings within others: each key is optional, and other keys are not permitted.
template <class S>
Json closed(const Json& old) {
  Json schema = open<S>(old);
  schema["additionalProperties"] = false;
  return schema;
}

template <class S>
Json keys() {
  S settings;
  Json keys = Json::array();
  visit_fields(settings, [&](const char* key, auto&) { keys.push_back(key); });
  return keys;
}

// Settings in a file: all keys are present, each with the value that was used. Some settings of
// sequence methods depend on others, as defined in the schema.
template <class S>
Json stored(const Json& old) {
  S settings;
  Json properties = Json::object();
  visit_fields(settings, [&]<class T>(const char* key, T&) {
    if constexpr (Settings<T>) {
      properties[key] = {{"required", keys<T>()}};
    } else if constexpr (detail::kIsOptional<T>) {
      if (std::is_enum_v<typename T::value_type>) properties[key] = {{"not", {{"const", "auto"}}}};
    }
  });
  Json schema = {{"$ref", part(old, "$ref")}};
  if (!properties.empty()) schema["properties"] = properties;
  const bool has_conditions = std::is_same_v<S, SequenceQuerySettings>;
  schema["required"] = has_conditions ? part(old, "required") : keys<S>();
  if (has_conditions)
    for (const char* key : {"dependentRequired", "if", "then", "else"})
      if (old.contains(key)) schema[key] = old[key];
  schema["unevaluatedProperties"] = false;
  return schema;
}

using Generator = Json (*)(const Json& old);

// The places of settings in schemas: the file, and the path in it.
const std::vector<std::pair<std::string, std::map<std::string, Generator>>>& places() {
  static const std::vector<std::pair<std::string, std::map<std::string, Generator>>> kPlaces = {
      {"common",
       {{"/$defs/sequence_query_settings", open<SequenceQuerySettings>},
        {"/$defs/fabmap_query_settings", open<FabmapQuerySettings>},
        {"/$defs/common_options", open<CommonOptions>},
        {"/$defs/sequence_train_settings", open<SequenceTrainSettings>},
        {"/$defs/fabmap_train_settings", open<FabmapTrainSettings>},
        {"/$defs/descriptor_settings", open<DescriptorSettings>},
        {"/$defs/eval_options", open<EvalOptions>},
        {"/$defs/matching_bench_settings", open<MatchingBenchSettings>},
        {"/$defs/describe_bench_settings", open<DescribeBenchSettings>},
        {"/$defs/fabmap_bench_settings", open<FabmapBenchSettings>},
        {"/$defs/realtime_bench_settings", open<RealtimeBenchSettings>},
        {"/$defs/zscore_settings", closed<ZScoreSettings>},
        {"/$defs/filter_settings", closed<FilterSettings>},
        {"/$defs/lsh_settings", closed<LshSettings>},
        {"/$defs/cluster_settings", closed<ClusterSettings>},
        {"/$defs/posterior_settings", closed<PosteriorSettings>},
        {"/$defs/statistics_settings", closed<StatisticsSettings>},
        {"/$defs/feature_settings", closed<FeatureSettings>},
        {"/$defs/stored_sequence_query_settings", stored<SequenceQuerySettings>},
        {"/$defs/stored_fabmap_query_settings", stored<FabmapQuerySettings>},
        {"/$defs/stored_descriptor_settings", stored<DescriptorSettings>},
        {"/$defs/stored_fabmap_train_settings", stored<FabmapTrainSettings>}}},
      {"bench",
       {{"/properties/settings/anyOf/0", stored<MatchingBenchSettings>},
        {"/properties/settings/anyOf/1", stored<DescribeBenchSettings>},
        {"/properties/settings/anyOf/2", stored<FabmapBenchSettings>},
        {"/properties/settings/anyOf/3", stored<RealtimeBenchSettings>}}}};
  return kPlaces;
}

}  // namespace

TEST_CASE("settings are described in the schemas as programs read and write them") {
  const char* mode = std::getenv("VPR_SCHEMAS");
  for (const auto& [name, generators] : places()) {
    const auto path = source_path(fmt::format("docs/schemas/{}.schema.json", name));
    Json schema = read_json(path, ErrorKind::input);
    for (const auto& [where, generate] : generators) {
      Json& old = schema[Json::json_pointer(where)];
      const Json expected = generate(old);
      INFO(path.string() << where << ": run scripts/schemas.sh, and describe what is new");
      if (mode == nullptr) CHECK(old == expected);
      old = expected;
    }
    if (mode != nullptr) std::ofstream(path) << to_text(schema);
  }
}
