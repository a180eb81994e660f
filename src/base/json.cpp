#include "base/json.h"

#include <algorithm>
#include <array>

#include <fmt/ranges.h>

#include "base/mapped_file.h"
#include "base/text.h"

namespace vpr {

std::optional<Json> parse_json(std::string_view text) {
  constexpr int kMaxDepth = 64;
  bool too_deep = false;
  Json json = Json::parse(
      text,
      [&](int depth, Json::parse_event_t, Json&) {
        too_deep = too_deep || depth > kMaxDepth;
        return !too_deep;  // drop values that are nested too deeply
      },
      false);
  if (json.is_discarded() || too_deep) return std::nullopt;
  return json;
}

Json read_json(const std::filesystem::path& path, ErrorKind kind) {
  const std::string file = read_whole_file(path);
  std::optional<Json> json = parse_json(file);
  if (!json)
    throw Error(kind, fmt::format("{}: is not valid JSON; check its commas, quotes and brackets",
                                  path.string()));
  return *std::move(json);
}

std::string schema_name(std::string_view kind) {
  constexpr std::array<std::string_view, 7> kOfReports = {
      "report", "reports", "protocols", "comparison", "expected", "sweep", "tuning"};
  const bool is_of_reports = std::ranges::find(kOfReports, kind) != kOfReports.end();
  return fmt::format("vpr.{}/{}", kind, is_of_reports ? 4 : 3);
}

void require_schema(const Json& json, std::string_view schema_kind, const std::string& where,
                    ErrorKind error_kind) {
  const std::string wanted = schema_name(schema_kind);
  const auto found = json.is_object() ? json.find("schema") : json.end();
  if (!json.is_object() || found == json.end() || !found->is_string())
    throw Error(error_kind,
                fmt::format("{}: expected a JSON object with \"schema\": \"{}\"", where, wanted));
  const std::string schema = found->get<std::string>();
  if (schema == wanted) return;
  if (schema.starts_with(fmt::format("vpr.{}/", schema_kind)))
    throw Error(
        error_kind,
        fmt::format("{}: has schema {}, written by another version of the program (this one "
                    "reads {}). Run the command that wrote it again",
                    where, schema, wanted));
  throw Error(error_kind, fmt::format("{}: expected schema {}, found {}", where, wanted, schema));
}

std::string to_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

namespace detail {

std::string one_of(std::span<const std::string_view> names) {
  return fmt::format("one of [\"{}\"]", fmt::join(names, "\",\""));
}

void bad_value(const std::string& where, const std::string& key, std::string_view expected,
               const Json& found) {
  std::string text = to_line(found);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  throw Error(ErrorKind::usage,
              fmt::format("{}: \"{}\" must be {}, found {}", where, key, expected, text));
}

void unknown_key(const std::string& where, const std::string& key,
                 const std::vector<std::string>& known) {
  throw Error(ErrorKind::usage, fmt::format("{}: unknown key \"{}\"; did you mean \"{}\"?", where,
                                            key, nearest(key, known)));
}

}  // namespace detail
}  // namespace vpr
