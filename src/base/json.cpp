#include "base/json.h"

#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include <fmt/ranges.h>

#include "base/mapped_file.h"
#include "base/text.h"

namespace vpr {

std::optional<Json> parse_json(std::string_view text) {
  constexpr int kMaxDepth = 64;
  bool is_bad = false;
  std::vector<std::set<std::string>> keys;  // of the objects around the current position
  Json json = Json::parse(
      text,
      [&](int depth, Json::parse_event_t event, Json& value) {
        if (is_bad) return false;
        if (event == Json::parse_event_t::object_start) keys.emplace_back();
        if (event == Json::parse_event_t::object_end) keys.pop_back();
        is_bad = depth > kMaxDepth || (event == Json::parse_event_t::key &&
                                       !keys.back().insert(value.get<std::string>()).second);
        return !is_bad;
      },
      false);
  if (json.is_discarded() || is_bad) return std::nullopt;
  return json;
}

Json read_json(const std::filesystem::path& path, ErrorKind kind) {
  const std::string file = read_whole_file(path);
  std::optional<Json> json = parse_json(file);
  if (!json)
    throw Error(kind, "{}: is not {}", path.string(),
                file[std::min(file.find_first_not_of(" \t\r\n"), file.size())] == '{'
                    ? "valid JSON; check its commas, quotes and brackets, and keys "
                      "that occur twice"
                    : "a JSON file");
  return *std::move(json);
}

std::string schema_name(std::string_view kind) {
  constexpr std::array<std::string_view, 8> kNewer = {
      "result", "report", "reports", "comparison", "comparisons", "expected", "sweep", "tuning"};
  return fmt::format("vpr.{}/{}", kind, std::ranges::find(kNewer, kind) != kNewer.end() ? 5 : 3);
}

void require_schema(const Json& json, std::string_view schema_kind, const std::string& where,
                    ErrorKind error_kind) {
  const std::string wanted = schema_name(schema_kind);
  const auto found = json.is_object() ? json.find("schema") : json.end();
  if (!json.is_object() || found == json.end() || !found->is_string())
    throw Error(error_kind, "{}: expected a JSON object with \"schema\": \"{}\"", where, wanted);
  const std::string schema = found->get<std::string>();
  if (schema == wanted) return;
  if (schema.starts_with(fmt::format("vpr.{}/", schema_kind)))
    throw Error(error_kind,
                "{}: has schema {}, written by another version of the program (this one reads {}). "
                "Run the command that wrote it again",
                where, schema, wanted);
  throw Error(error_kind, "{}: expected schema {}, found {}", where, wanted, schema);
}

std::string to_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void JsonSource::fail(std::string_view defect) const {
  throw Error(form.error, fmt::format(fmt::runtime(form.message), where, defect));
}

void JsonSource::refuse(const std::string& key, std::string_view expected,
                        const Json& found) const {
  fail(fmt::format("\"{}\" must be {}, found {}", key, expected, shortened(to_line(found))));
}

void JsonSource::refuse_unknown(const Json& json, const std::vector<std::string>& known) const {
  for (const auto& item : json.items()) {
    const std::string& key = item.key();
    if (std::ranges::find(known, key) != known.end()) continue;
    const std::string near = nearest(key, known);
    const bool is_typo = edit_distance(key, near) <= std::max<size_t>(1, (key.size() - 1) / 3);
    fail(fmt::format("unknown key \"{}\"{}", key,
                     is_typo ? fmt::format("; did you mean \"{}\"?", near) : ""));
  }
}

Fields::Fields(const Json& json, JsonSource source, const std::string& key)
    : json_(json), source_(std::move(source)) {
  if (!json.is_object()) source_.refuse(key, "an object", json);
}

const Json& Fields::operator[](const std::string& key) const {
  const auto found = json_.find(key);
  if (found == json_.end()) fail(fmt::format("\"{}\" is missing", key));
  return *found;
}

uint64_t Fields::count(const std::string& key, uint64_t most) const {
  const Json& value = (*this)[key];
  if (!value.is_number_unsigned() || value.get<uint64_t>() > most)
    fail(fmt::format("\"{}\" is not a number in range", key));
  return value.get<uint64_t>();
}

std::string Fields::text(const std::string& key) const {
  std::string value;
  read(key, value);
  return value;
}

const Json& Fields::list(const std::string& key) const {
  const Json& value = (*this)[key];
  if (!value.is_array()) source_.refuse(key, "a list", value);
  return value;
}

namespace detail {

std::string one_of(std::span<const std::string_view> names) {
  return fmt::format("one of {}", fmt::join(names, ", "));
}

void read_value(const Json& json, bool& value, const JsonSource& source, const std::string& key) {
  if (!json.is_boolean()) source.refuse(key, "true or false", json);
  value = json.get<bool>();
}

void read_value(const Json& json, double& value, const JsonSource& source, const std::string& key) {
  const bool is_infinite = json.is_null() && !source.form.is_partial;
  if (!is_infinite && !json.is_number()) source.refuse(key, "a number", json);
  value = is_infinite ? std::numeric_limits<double>::infinity() : json.get<double>();
}

void read_value(const Json& json, std::string& value, const JsonSource& source,
                const std::string& key) {
  if (!json.is_string()) source.refuse(key, "a string", json);
  value = json.get<std::string>();
}

void read_value(const Json& json, std::filesystem::path& value, const JsonSource& source,
                const std::string& key) {
  std::string text;
  read_value(json, text, source, key);
  value = text;
}

size_t number_of_key(const std::string& key, const JsonSource& source) {
  const auto number = parse_number<size_t>(key);
  if (!number) source.fail(fmt::format("\"{}\" is not a number", key));
  return *number;
}

}  // namespace detail
}  // namespace vpr
