#include "evaluate/expectation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"

namespace vpr {
namespace {

/// A number as a file expects it.
struct ExpectedNumber {
  std::optional<double> value;
  double tolerance = 0;
  std::optional<double> min;
  std::optional<double> max;
};

bool is_number(const Json& json) {
  if (json.is_number()) return true;
  return json.is_object() &&
         (json.contains("value") || json.contains("min") || json.contains("max"));
}

class Comparison {
 public:
  explicit Comparison(const std::string& where) : where_(where) {}

  void compare(const Json& found, const Json& expected, const std::string& key) {
    if (is_number(expected) || expected.is_null()) {
      compare_number(found, expected, key);
      return;
    }
    if (!expected.is_object()) fail(key, "must be a number or an object");
    for (const auto& item : expected.items()) {
      const std::string inner = key + "." + item.key();
      const auto value = found.is_object() ? found.find(item.key()) : found.end();
      if (!found.is_object() || value == found.end()) fail(inner, "is not in the report");
      compare(*value, item.value(), inner);
    }
  }

  /// Values of any kind, which must be equal.
  void compare_values(const Json& found, const Json& expected, const std::string& key) {
    if (!expected.is_object()) {
      values.push_back({key, expected.dump(), found.dump(), found == expected});
      return;
    }
    for (const auto& item : expected.items())
      compare_values(found.is_object() ? found.value(item.key(), Json()) : Json(), item.value(),
                     key + "." + item.key());
  }

  std::vector<CheckedValue> values;

 private:
  ExpectedNumber parse(const Json& expected, const std::string& key) const {
    if (expected.is_number()) return {expected.get<double>(), 0, {}, {}};
    ExpectedNumber number;
    size_t known = 0;
    const auto take = [&](const char* name, auto& field) {
      if (!expected.contains(name)) return;
      ++known;
      if (!expected[name].is_number()) fail(key, fmt::format("needs a number \"{}\"", name));
      field = expected[name].get<double>();
    };
    take("value", number.value);
    take("tolerance", number.tolerance);
    take("min", number.min);
    take("max", number.max);
    if (number.tolerance < 0) fail(key, "needs a \"tolerance\" of 0 or more");
    const bool is_exact = number.value.has_value();
    if (known < expected.size() || is_exact == (number.min || number.max) ||
        (!is_exact && expected.contains("tolerance")))
      fail(key, "takes \"value\" with or without \"tolerance\", or \"min\", \"max\" or both");
    if (number.min && number.max && *number.min > *number.max)
      fail(key, "has a \"min\" above its \"max\"");
    return number;
  }

  static bool is_met(double found, const ExpectedNumber& expected) {
    if (expected.value) return std::abs(found - *expected.value) <= expected.tolerance;
    return (!expected.min || found >= *expected.min) && (!expected.max || found <= *expected.max);
  }

  static std::string words(const Json& expected) {
    if (!expected.is_object()) return expected.dump();
    if (expected.contains("value")) {
      const Json tolerance = expected.value("tolerance", Json(0));
      return expected["value"].dump() + (tolerance == 0 ? "" : " +- " + tolerance.dump());
    }
    if (!expected.contains("max")) return "at least " + expected["min"].dump();
    if (!expected.contains("min")) return "at most " + expected["max"].dump();
    return expected["min"].dump() + " to " + expected["max"].dump();
  }

  void compare_number(const Json& found, const Json& expected, const std::string& key) {
    if (found.is_null() || expected.is_null()) {
      values.push_back({key, words(expected), found.dump(), found == expected});
      return;
    }
    const ExpectedNumber number = parse(expected, key);
    if (!found.is_number()) fail(key, "is no number in the report");
    const auto value = found.get<double>();
    const std::string difference = number.value && value != *number.value
                                       ? fmt::format(" ({:+g})", value - *number.value)
                                       : "";
    values.push_back({key, words(expected), found.dump() + difference, is_met(value, number)});
  }

  [[noreturn]] void fail(const std::string& key, std::string_view what) const {
    throw Error(ErrorKind::usage, fmt::format("{}: \"{}\" {}", where_, key, what));
  }

  const std::string& where_;
};

constexpr std::array<std::string_view, 3> kConditions = {"settings", "protocol", "provenance"};

bool is_report(const Json& expected) {
  return expected.is_object() && expected.contains("schema") &&
         expected["schema"] == "vpr.report/1";
}

// What is found takes the place of what was expected. `is_condition`: of values of any kind.
void update(Json& expected, const Json& found, bool is_condition) {
  if (!is_condition && expected.is_object() && is_number(expected) && !found.is_null()) {
    if (expected.contains("value")) expected["value"] = found;
    if (expected.contains("min") && found < expected["min"]) expected["min"] = found;
    if (expected.contains("max") && found > expected["max"]) expected["max"] = found;
  } else if (expected.is_object() && !found.is_null()) {
    for (auto item = expected.begin(); item != expected.end(); ++item)
      update(item.value(), found.is_object() ? found.value(item.key(), Json()) : Json(),
             is_condition);
  } else {
    expected = found;
  }
}

// What an earlier report was made under, of what must not change.
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
  Comparison comparison(where);
  static const std::vector<std::string> kParts = {"counts",       "best_match", "metrics",
                                                  "localization", "settings",   "protocol"};
  const auto part_kind = [](const std::string& key) {
    return std::find(kParts.begin(), kParts.end(), key) - kParts.begin();
  };
  constexpr ptrdiff_t kNumbers = 4;  // the first parts
  for (const auto& item : expected.items()) {
    const ptrdiff_t kind = part_kind(item.key());
    if (kind < kNumbers)
      comparison.compare(report.value(item.key(), Json()), item.value(), item.key());
    else if (kind == std::ssize(kParts) && !is_whole && item.key() != "schema")
      detail::unknown_key(where, item.key(), kParts);
  }
  if (comparison.values.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: expects nothing; give at least one number", where));
  const Json conditions = is_whole ? conditions_of(expected) : expected;
  for (const std::string_view name : kConditions) {
    const std::string part(name);
    if (conditions.contains(part))
      comparison.compare_values(report.value(part, Json()), conditions[part], part);
  }
  return comparison.values;
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
  check_expectations(report, expected, where);  // so that all keys are the report's
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
