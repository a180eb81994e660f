#include "evaluation/expectation.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"

namespace vpr {
namespace {

class Comparison {
 public:
  explicit Comparison(const std::string& where) : where_(where) {}

  void compare(const Json& found, const Json& expected, const std::string& key) {
    if (expected.is_null() && found.is_null()) return;  // no rate where there are no queries
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
      ++numbers_;
      if (found != expected)
        unmet.push_back(
            fmt::format("{}: expected {}, found {}", key, expected.dump(), found.dump()));
      return;
    }
    for (const auto& item : expected.items())
      compare_values(found.is_object() ? found.value(item.key(), Json()) : Json(), item.value(),
                     key + "." + item.key());
  }

  size_t numbers() const { return numbers_; }
  std::vector<std::string> unmet;

 private:
  static bool is_number(const Json& json) {
    return json.is_number() || (json.is_object() && json.contains("value"));
  }

  void compare_number(const Json& found, const Json& expected, const std::string& key) {
    ++numbers_;
    if (found.is_null() || expected.is_null()) {
      unmet.push_back(fmt::format("{}: expected {}, found {}", key, expected.dump(), found.dump()));
      return;
    }
    const Json value = expected.is_object() ? expected["value"] : expected;
    const Json tolerance = expected.is_object() ? expected.value("tolerance", Json(0)) : Json(0);
    if (!value.is_number() || !tolerance.is_number() || tolerance.get<double>() < 0)
      fail(key, "needs a number \"value\" and a \"tolerance\" of 0 or more");
    if (expected.is_object() && expected.size() > 1 + expected.count("tolerance"))
      fail(key, "takes only \"value\" and \"tolerance\"");
    if (!found.is_number()) fail(key, "is no number in the report");
    const double difference = found.get<double>() - value.get<double>();
    if (std::abs(difference) <= tolerance.get<double>()) return;
    unmet.push_back(fmt::format("{}: expected {}{}, found {} ({:+g})", key, value.dump(),
                                tolerance == 0 ? "" : " +- " + tolerance.dump(), found.dump(),
                                difference));
  }

  [[noreturn]] void fail(const std::string& key, std::string_view what) const {
    throw Error(ErrorKind::usage, fmt::format("{}: \"{}\" {}", where_, key, what));
  }

  const std::string& where_;
  size_t numbers_ = 0;
};

}  // namespace

namespace {

// What a report of older date says of its ground truth, in today's words.
std::string todays_words(std::string words) {
  static const std::vector<std::pair<std::string_view, std::string_view>> kSaidOtherwise = {
      {", references within 0 frames of one count", ""},
      {": 1 labelled pairs", ": 1 labelled pair"},
      {"within 1 frames", "within 1 frame"}};
  for (const auto& [before, now] : kSaidOtherwise)
    if (const size_t at = words.find(before); at != std::string::npos)
      words.replace(at, before.size(), now);
  return words;
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
  if (conditions.contains("provenance")) return conditions;
  keep("protocol", "ground_truth");
  const Json words = conditions.value("protocol", Json::object()).value("ground_truth", Json());
  if (words.is_string())
    conditions["protocol"]["ground_truth"] = todays_words(words.get<std::string>());
  return conditions;
}

}  // namespace

std::vector<std::string> unmet_expectations(const Json& report, const Json& expected,
                                            const std::string& where) {
  const bool is_report =
      expected.is_object() && expected.contains("schema") && expected["schema"] == "vpr.report/1";
  if (!is_report) require_schema(expected, "expected", where, ErrorKind::usage);
  Comparison comparison(where);
  static const std::vector<std::string> kParts = {"counts",       "best_match", "metrics",
                                                  "localisation", "settings",   "protocol"};
  const auto part_kind = [](const std::string& key) {
    return std::find(kParts.begin(), kParts.end(), key) - kParts.begin();
  };
  constexpr ptrdiff_t kNumbers = 4;  // the first parts
  for (const auto& item : expected.items()) {
    const ptrdiff_t kind = part_kind(item.key());
    if (kind < kNumbers)
      comparison.compare(report.value(item.key(), Json()), item.value(), item.key());
    else if (kind == std::ssize(kParts) && !is_report && item.key() != "schema")
      detail::unknown_key(where, item.key(), kParts);
  }
  if (comparison.numbers() == 0)
    throw Error(ErrorKind::usage,
                fmt::format("{}: expects nothing; give at least one number", where));
  const Json conditions = is_report ? conditions_of(expected) : expected;
  for (const char* part : {"settings", "protocol", "provenance"})
    if (conditions.contains(part))
      comparison.compare_values(report.value(part, Json()), conditions[part], part);
  return comparison.unmet;
}

}  // namespace vpr
