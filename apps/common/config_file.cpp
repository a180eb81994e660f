#include "config_file.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "report/result_file.h"

namespace vpr {
namespace {

// The settings and the seed that a result was made with.
Json settings_of_result(const std::string& path) {
  const Json result = read_result_json(path);
  Json json = result.value("settings", Json::object());
  const Json provenance = result.value("provenance", Json::object());
  if (json.is_object() && provenance.is_object() && provenance.contains("seed"))
    json["seed"] = provenance["seed"];
  return json;
}

bool is_result(const Json& json) {
  return json["schema"].is_string() &&
         json["schema"].get_ref<const std::string&>().starts_with("vpr.result/");
}

// What vpr-tune calibrate found.
Json calibrated_settings(const Json& json, const std::string& path) {
  if (json.contains("settings") && json["settings"].is_object()) return json["settings"];
  throw Error(
      ErrorKind::usage,
      fmt::format("{}: is a calibration that found no threshold; calibrate on another walk, "
                  "or with other settings",
                  path));
}

}  // namespace

Json read_config(const std::string& path) {
  Json json = read_json(path, ErrorKind::usage);
  if (!json.is_object() || !json.contains("schema")) return json;
  if (is_result(json)) return settings_of_result(path);
  if (json["schema"] == "vpr.sweep/1")
    throw Error(ErrorKind::usage,
                fmt::format("{}: is a sweep, of many settings; let vpr-tune write those that it "
                            "recommends (--save-config FILE), and give that file",
                            path));
  if (json["schema"] == "vpr.calibration/1") return calibrated_settings(json, path);
  require_schema(json, "config", path, ErrorKind::usage);
  json.erase("schema");
  return json;
}

}  // namespace vpr
