#include "evaluate/expectation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"

namespace vpr {
namespace {

bool is_number(const Json& json) {
  if (json.is_number()) return true;
  return json.is_object() &&
         (json.contains("value") || json.contains("min") || json.contains("max"));
}

Json member(const Json& json, const std::string& key) {
  return json.is_object() ? json.value(key, Json()) : Json();
}

struct Check {
  const std::string& where;
  bool is_whole = false;  // an earlier report, which may have more numbers
  std::vector<CheckedValue> values = {};

  [[noreturn]] void fail(const std::string& key, std::string_view what) const {
    throw Error(ErrorKind::usage, "{}: \"{}\" {}", where, key, what);
  }

  void compare_numbers(const Json& found, const Json& expected, const std::string& key) {
    if (is_number(expected) || expected.is_null()) return compare_number(found, expected, key);
    if (!expected.is_object()) fail(key, "must be a number or an object");
    for (const auto& item : expected.items()) {
      const std::string inner = key + "." + item.key();
      if (!is_whole && (!found.is_object() || !found.contains(item.key())))
        fail(inner, "is not in the report");
      compare_numbers(member(found, item.key()), item.value(), inner);
    }
  }

  /// Values of any type, which must be equal.
  void compare_values(const Json& found, const Json& expected, const std::string& key) {
    if (!expected.is_object()) {
      values.push_back({key, expected.dump(), found.dump(), found == expected});
      return;
    }
    for (const auto& item : expected.items())
      compare_values(member(found, item.key()), item.value(), key + "." + item.key());
  }

  void compare_number(const Json& found, const Json& expected, const std::string& key) {
    CheckedValue& checked =
        values.emplace_back(CheckedValue{key, expected.dump(), found.dump(), found == expected});
    if (expected.is_null()) return;
    Json bounds = expected;
    if (expected.is_number()) bounds = {{"value", expected}};
    size_t known = 0;
    const auto read = [&](const char* name) -> std::optional<double> {
      if (!bounds.contains(name)) return std::nullopt;
      ++known;
      if (!bounds[name].is_number()) fail(key, fmt::format("needs a number \"{}\"", name));
      return bounds[name].get<double>();
    };
    const auto value = read("value");
    const auto tolerance = read("tolerance");
    const auto min = read("min");
    const auto max = read("max");
    if (tolerance.value_or(0) < 0) fail(key, "needs a \"tolerance\" of 0 or more");
    if (known < bounds.size() || value.has_value() == (min || max) || (!value && tolerance))
      fail(key, "needs \"value\", optionally with \"tolerance\", or \"min\", \"max\" or both");
    if (min && max && *min > *max) fail(key, "has a \"min\" above its \"max\"");
    if (value)
      checked.expected = bounds["value"].dump() +
                         (tolerance.value_or(0) == 0 ? "" : " +- " + bounds["tolerance"].dump());
    else if (!max)
      checked.expected = "at least " + bounds["min"].dump();
    else if (!min)
      checked.expected = "at most " + bounds["max"].dump();
    else
      checked.expected = bounds["min"].dump() + " to " + bounds["max"].dump();
    if (found.is_null()) return;
    if (!found.is_number()) fail(key, "is not a number in the report");
    const auto number = found.get<double>();
    // The difference of decimal fractions is rounded: 0.4 is within 0.1 of 0.3.
    checked.is_met = value ? std::abs(number - *value) <= tolerance.value_or(0) * (1 + 1e-9)
                           : (!min || number >= *min) && (!max || number <= *max);
    if (value && number != *value) checked.found += fmt::format(" ({:+g})", number - *value);
  }
};

constexpr std::array<std::string_view, 3> kConditions = {"settings", "protocol", "provenance"};

bool is_report(const Json& expected) {
  return expected.is_object() && expected.contains("schema") &&
         expected["schema"] == schema_name("report");
}

// Replaces expected values by found ones. A condition may have values of any type.
void update(Json& expected, const Json& found, bool is_condition) {
  if (!is_condition && expected.is_object() && is_number(expected) && !found.is_null()) {
    if (expected.contains("value")) expected["value"] = found;
    if (expected.contains("min") && found < expected["min"]) expected["min"] = found;
    if (expected.contains("max") && found > expected["max"]) expected["max"] = found;
  } else if (expected.is_object() && !found.is_null()) {
    for (auto item = expected.begin(); item != expected.end(); ++item)
      update(item.value(), member(found, item.key()), is_condition);
  } else {
    expected = found;
  }
}

// The settings and parts of the protocol of an earlier report that must not change.
Json conditions_of(const Json& report) {
  Json conditions = Json::object();
  const auto keep = [&](const char* part, const char* key) {
    if (report.contains(part) && report[part].contains(key))
      conditions[part][key] = report[part][key];
  };
  conditions["settings"] = report.value("settings", Json::object());
  const bool is_of_scores = !report.contains("counts");
  if (is_of_scores) conditions["settings"].erase("method");  // a name for tables
  keep("protocol", "tolerance_frames");
  keep("provenance", "ground_truth");
  if (!conditions.contains("provenance")) keep("protocol", "ground_truth");
  return conditions;
}

}  // namespace

std::vector<CheckedValue> check_expectations(const Json& report, const Json& expected,
                                             const std::string& where) {
  const bool is_whole = is_report(expected);
  if (!is_whole) require_schema(expected, "expected", where, ErrorKind::usage);
  Check check{where, is_whole};
  static const std::vector<std::string> kParts = {
      "counts", "best_match", "metrics", "localization", "settings", "protocol", "schema"};
  constexpr ptrdiff_t kNumbers = 4;  // the first parts
  if (!is_whole) JsonSource{where, kSettingsForm}.refuse_unknown(expected, kParts);
  for (const auto& item : expected.items()) {
    const ptrdiff_t part = std::ranges::find(kParts, item.key()) - kParts.begin();
    if (part < kNumbers)
      check.compare_numbers(member(report, item.key()), item.value(), item.key());
  }
  if (check.values.empty())
    throw Error(ErrorKind::usage, "{}: expects nothing. Add at least one number", where);
  const Json conditions = is_whole ? conditions_of(expected) : expected;
  for (const std::string_view name : kConditions) {
    const std::string part(name);
    if (conditions.contains(part))
      check.compare_values(member(report, part), conditions[part], part);
  }
  return check.values;
}

std::vector<std::string> unmet_expectations(const std::vector<CheckedValue>& values) {
  std::vector<std::string> lines;
  for (const CheckedValue& value : values)
    if (!value.is_met)
      lines.push_back(
          fmt::format("{}: expected {}, found {}", value.key, value.expected, value.found));
  return lines;
}

Json updated_expectations(const Json& report, const Json& expected, const std::string& where) {
  check_expectations(report, expected, where);  // all keys must be in the report
  if (is_report(expected)) return report;
  Json updated = expected;
  for (auto item = updated.begin(); item != updated.end(); ++item) {
    if (item.key() == "schema") continue;
    const bool is_condition = std::ranges::find(kConditions, item.key()) != kConditions.end();
    update(item.value(), report.value(item.key(), Json()), is_condition);
  }
  return updated;
}

}  // namespace vpr
