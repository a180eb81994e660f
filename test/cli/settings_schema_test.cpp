// The schemas in docs/ describe settings as their structs do: keys, types, names and order come
// from visit_fields; descriptions, and bounds that a type does not say, stand in the schemas.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <map>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "bench/describe_bench.h"
#include "bench/fabmap_bench.h"
#include "bench/matching_bench.h"
#include "bench/nordland_bench.h"
#include "bench/realtime_bench.h"
#include "common/session.h"
#include "database/fabmap_database.h"
#include "pipeline/train.h"
#include "recognition/query_settings.h"
#include "report/table.h"
#include "support.h"

using namespace vpr;

namespace {

/// given: in a configuration, where every key may be missing. stored: in files, where a name that
/// was left to be chosen is the one that was chosen.
enum class Form { given, stored };

/// Of vpr-eval, whose settings are values of its flags.
struct EvalKeys {
  std::optional<uint64_t> tolerance;
  TableFormat format = TableFormat::text;
};
template <class Visitor>
void visit_fields(EvalKeys& keys, Visitor&& visit) {
  visit("tolerance", keys.tolerance);
  visit("format", keys.format);
}

template <class T>
Json schema_of(T& value, const Json& old, Form form);

// A part of `old`, or nothing.
Json part(const Json& old, const std::string& key) {
  return old.is_object() && old.contains(key) ? old[key] : Json::object();
}

template <class T>
Json type_of(T& value, const Json& old, Form form) {
  if constexpr (Settings<T>) {
    Json properties = Json::object();
    Json required = Json::array();
    visit_fields(value, [&](const char* key, auto& field) {
      properties[key] = schema_of(field, part(part(old, "properties"), key), form);
      required.push_back(key);
    });
    Json schema = {{"type", "object"}, {"properties", properties}};
    // A key that is new may be missing in files that are older.
    if (form == Form::stored)
      schema["required"] = old.contains("required") ? old["required"] : required;
    schema["additionalProperties"] = false;
    return schema;
  } else if constexpr (detail::kIsOptional<T>) {
    typename T::value_type chosen{};
    Json schema = type_of(chosen, {}, form);
    if (!std::is_enum_v<typename T::value_type>) return {{"oneOf", {schema, {{"const", "auto"}}}}};
    if (form == Form::given) schema["enum"].push_back("auto");
    return schema;
  } else if constexpr (detail::kIsList<T>) {
    typename T::value_type item{};
    return {{"type", "array"}, {"items", schema_of(item, part(old, "items"), form)}};
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
Json schema_of(T& value, const Json& old, Form form) {
  Json schema = Json::object();
  if (old.contains("description")) schema["description"] = old["description"];
  schema.update(type_of(value, old.is_object() ? old : Json::object(), form));
  for (const char* bound : {"exclusiveMinimum", "minimum", "maximum", "pattern"})
    if (old.contains(bound)) schema[bound] = old[bound];
  return schema;
}

template <class S>
Json stored(const Json& old) {
  S settings;
  return schema_of(settings, old, Form::stored);
}

// Of settings in force: which of them stand in a file depends on others, and the schema says how.
template <class S>
Json in_force(const Json& old) {
  Json schema = stored<S>(old);
  for (const char* key : {"dependentRequired", "if", "then", "else"})
    if (old.contains(key)) schema[key] = old[key];
  if (!schema["properties"].contains("score")) return schema;
  Json& scores = schema["properties"]["score"]["enum"];
  scores.erase(std::find(scores.begin(), scores.end(), enum_name(Score{})));
  return schema;
}

// What a configuration of a program may hold: settings, those of another method, common keys.
template <class S, class... Others>
Json configuration(const Json& old) {
  CommonOptions common;
  Json schema = {{"title", part(old, "title")}};
  schema.update(schema_of(common, old, Form::given));
  Json& properties = schema["properties"];
  Json all = {{"schema", part(part(old, "properties"), "schema")}};
  const auto add = [&](auto settings) {
    all.update(schema_of(settings, old, Form::given)["properties"]);
  };
  (add(S{}), ..., add(Others{}));
  all.update(properties);
  properties = all;
  return schema;
}

using Generator = Json (*)(const Json& old);

// Where a schema of settings stands: the file, and the path in it.
const std::vector<std::pair<std::string, std::map<std::string, Generator>>>& places() {
  static const std::map<std::string, Generator> kQuery = {
      {"/properties/settings/oneOf/0", in_force<SequenceQuerySettings>},
      {"/properties/settings/oneOf/1", in_force<FabmapQuerySettings>}};
  static const std::map<std::string, Generator> kDatabase = {
      {"/properties/settings/oneOf/0", stored<DescriptorSettings>},
      {"/properties/settings/oneOf/1", stored<FabmapTrainSettings>}};
  static const std::vector<std::pair<std::string, std::map<std::string, Generator>>> kPlaces = {
      {"result", kQuery},
      {"report", kQuery},
      {"database", kDatabase},
      {"database-info", kDatabase},
      {"bench",
       {{"/properties/settings/anyOf/0", stored<MatchingBenchSettings>},
        {"/properties/settings/anyOf/1", stored<DescribeBenchSettings>},
        {"/properties/settings/anyOf/2", stored<FabmapBenchSettings>},
        {"/properties/settings/anyOf/3", stored<NordlandBenchSettings>},
        {"/properties/settings/anyOf/4", stored<RealtimeBenchSettings>}}},
      {"config",
       {{"/anyOf/0", configuration<SequenceQuerySettings, FabmapQuerySettings>},
        {"/anyOf/1", configuration<SequenceTrainSettings>},
        {"/anyOf/2", configuration<FabmapTrainSettings>},
        {"/anyOf/3", configuration<EvalKeys>},
        {"/anyOf/4", configuration<MatchingBenchSettings>},
        {"/anyOf/5", configuration<DescribeBenchSettings>},
        {"/anyOf/6", configuration<FabmapBenchSettings>},
        {"/anyOf/7", configuration<NordlandBenchSettings>},
        {"/anyOf/8", configuration<RealtimeBenchSettings>}}}};
  return kPlaces;
}

}  // namespace

TEST_CASE("settings are described in the schemas as programs read and write them") {
  const char* mode = std::getenv("VPR_SCHEMAS");
  for (const auto& [name, generators] : places()) {
    const auto path = test::source_path(fmt::format("docs/{}.schema.json", name));
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
