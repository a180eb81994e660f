#include "base/json_schema.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace vpr {
namespace {

// Calls body(schema) for each schema of this type in a schema without the properties of objects.
template <class Body>
void for_each_of(Json& schema, std::initializer_list<std::string_view> types, const Body& body) {
  if (schema.contains("items")) for_each_of(schema["items"], types, body);
  if (schema.contains("additionalProperties") && schema["additionalProperties"].is_object())
    for_each_of(schema["additionalProperties"], types, body);
  if (schema.contains("anyOf"))
    for (Json& one : schema["anyOf"]) for_each_of(one, types, body);
  if (!schema.contains("type")) return;
  const Json& type = schema["type"];
  for (const std::string_view name : types)
    if (type == name || (type.is_array() && type.front() == name)) return body(schema);
}

Json number_json(double value) {
  return value == std::floor(value) ? Json(static_cast<int64_t>(value)) : Json(value);
}

}  // namespace

std::string sentence(std::string_view text) {
  constexpr std::string_view kDefault = " (default: {})";
  if (text.ends_with(kDefault)) text.remove_suffix(kDefault.size());
  std::string result(text);
  result[0] = static_cast<char>(std::toupper(result[0]));
  return result.ends_with('.') ? result : result + ".";
}

Json merged(Json a, const Json& b) {
  if (a.contains("items") && b.contains("items")) a["items"] = merged(a["items"], b["items"]);
  if (!a.contains("properties") || !b.contains("properties")) return a;
  std::erase_if(a["required"].get_ref<Json::array_t&>(), [&](const Json& key) {
    return std::ranges::find(b["required"], key) == b["required"].end();
  });
  for (const auto& [key, property] : b["properties"].items()) {
    Json& own = a["properties"][key];
    own = own.is_null() ? property : merged(own, property);
  }
  return a;
}

Json file_schema(std::string_view title, const std::vector<Json>& schemas) {
  Json file = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  file.update(detail::any_of(schemas));
  return file;
}

namespace detail {

Json or_null(Json schema) {
  if (!schema.contains("type") || !schema["type"].is_string())
    return {{"anyOf", {schema, {{"type", "null"}}}}};
  schema["type"] = {schema["type"], "null"};
  return schema;
}

Json or_auto(Json schema) {
  if (!schema.contains("enum")) return {{"anyOf", {schema, {{"const", "auto"}}}}};
  schema["enum"].push_back("auto");
  return schema;
}

Json any_of(std::vector<Json> schemas) {
  return schemas.size() == 1 ? schemas.front() : Json{{"anyOf", schemas}};
}

void add_hint(Json& schema, const Bounds& bounds) {
  for_each_of(schema, {"number", "integer"}, [&](Json& numbers) {
    numbers.erase("minimum");
    numbers[bounds.is_open ? "exclusiveMinimum" : "minimum"] = number_json(bounds.least);
    if (std::isfinite(bounds.most)) numbers["maximum"] = number_json(bounds.most);
  });
}

void add_hint(Json& schema, const Matches& pattern) {
  for_each_of(schema, {"string"}, [&](Json& text) { text["pattern"] = pattern.regex; });
}

void add_hint(Json& schema, OrNull) { schema = or_null(schema); }

void add_property(Json& object, std::string_view key, const Json& schema, std::string_view text,
                  bool is_required) {
  Json property = Json::object();
  if (!text.empty()) property["description"] = sentence(text);
  property.update(schema);
  object["properties"][std::string(key)] = std::move(property);
  if (is_required && std::ranges::count(object["required"], Json(key)) == 0)
    object["required"].push_back(key);
}

}  // namespace detail
}  // namespace vpr
