// docs/schemas/settings.txt defines the settings as in their structs: keys, types, names and order
// follow visit_fields; the file adds descriptions, at first the help, and bounds that a type does
// not imply.
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "bench/benches.h"
#include "common/command.h"
#include "evaluate/metrics.h"
#include "fabmap/place_query.h"
#include "present/table.h"
#include "query/query_settings.h"
#include "query/setting_rows.h"
#include "query/train_sequences.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

/// The settings of vpr-eval, which are values of its flags.
struct EvalOptions {
  std::optional<uint64_t> tolerance;
  TableFormat format = TableFormat::text;
};
VPR_FIELDS(EvalOptions, tolerance, format)

// The names of structs within others.
template <class S>
constexpr const char* kName = nullptr;
template <>
constexpr const char* kName<FilterSettings> = "filter_settings";
template <>
constexpr const char* kName<LshSettings> = "lsh_settings";
template <>
constexpr const char* kName<ClusterSettings> = "cluster_settings";
template <>
constexpr const char* kName<PosteriorSettings> = "posterior_settings";
template <>
constexpr const char* kName<StatisticsSettings> = "statistics_settings";
template <>
constexpr const char* kName<FeatureSettings> = "feature_settings";

// A type in the notation of scripts/dev/schemas.py.
template <class T>
std::string type_of() {
  if constexpr (Settings<T>) {
    return fmt::format("@{}", kName<T>);
  } else if constexpr (detail::kIsOptional<T>) {
    using Value = typename T::value_type;
    if constexpr (std::is_enum_v<Value>) return type_of<Value>() + "|'auto'";
    return std::is_floating_point_v<Value> ? "@auto_number" : "@auto_count";
  } else if constexpr (detail::kIsList<T>) {
    return fmt::format("[{}]", type_of<typename T::value_type>());
  } else if constexpr (std::is_enum_v<T>) {
    return fmt::format("'{}'", fmt::join(kEnumNames<T>, "'|'"));
  } else if constexpr (std::is_same_v<T, bool>) {
    return "bool";
  } else if constexpr (std::is_integral_v<T>) {
    return std::is_unsigned_v<T> ? "count" : "integer";
  } else {
    return std::is_floating_point_v<T> ? "number" : "string";
  }
}

// The help of a setting as the description of its key; empty without a flag.
std::string help_of(std::string_view key) {
  for (const auto rows : {sequence_setting_rows(), fabmap_setting_rows()})
    for (const SettingRow& row : rows) {
      if (row.key != key) continue;
      std::string text(row.help.substr(0, row.help.find(" (default")));
      text[0] = static_cast<char>(std::toupper(text[0]));
      return fmt::format("  {}.", text);
    }
  return "";
}

// The lines of a struct; each keeps the "?", bounds and description of the old line with its key.
template <class S>
std::string lines_of(const std::map<std::string, std::string>& old_lines) {
  static const std::regex kBounds("(>=|<=|>)[-0-9.]+|~\\S+?(?=\\]*$)");
  std::string lines;
  S settings;
  visit_fields(settings, [&]<class T>(const char* key, T&) {
    const auto old = old_lines.find(key);
    const std::string line = old == old_lines.end()
                                 ? fmt::format("  {}: {}{}", key, type_of<T>(), help_of(key))
                                 : old->second;
    const size_t type_at = line.find(": ") + 2;
    const size_t end = std::min(line.size(), line.find("  ", type_at));
    const std::string type = line.substr(type_at, end - type_at);
    std::string unbounded = std::regex_replace(type, kBounds, "");
    const std::string expected = type_of<T>();
    if (std::is_integral_v<T> && (type == "count" || type.starts_with("integer>=")))
      unbounded = expected;  // with a bound
    lines += line.substr(0, type_at) + (unbounded == expected ? type : expected) +
             line.substr(end) + "\n";
  });
  return lines;
}

using Generator = std::string (*)(const std::map<std::string, std::string>& old_lines);

const std::map<std::string, Generator> kGenerators = {
    {"sequence_query_settings", lines_of<SequenceKeys>},
    {"fabmap_query_settings", lines_of<FabmapQuerySettings>},
    {"common_options", lines_of<ProcessSettings>},
    {"sequence_train_settings", lines_of<SequenceTrainSettings>},
    {"fabmap_train_settings", lines_of<FabmapTrainSettings>},
    {"descriptor_settings", lines_of<DescriptorSettings>},
    {"eval_options", lines_of<EvalOptions>},
    {"matching_bench_settings", lines_of<MatchingBenchSettings>},
    {"describe_bench_settings", lines_of<DescribeBenchSettings>},
    {"fabmap_bench_settings", lines_of<FabmapBenchSettings>},
    {"training_bench_settings", lines_of<TrainingBenchSettings>},
    {"realtime_bench_settings", lines_of<RealtimeBenchSettings>},
    {"filter_settings", lines_of<FilterSettings>},
    {"lsh_settings", lines_of<LshSettings>},
    {"cluster_settings", lines_of<ClusterSettings>},
    {"posterior_settings", lines_of<PosteriorSettings>},
    {"statistics_settings", lines_of<StatisticsSettings>},
    {"feature_settings", lines_of<FeatureSettings>}};

}  // namespace

TEST_CASE("settings are described in the schemas as programs read and write them") {
  const auto path = source_path("docs/schemas/settings.txt");
  const std::string text = read_whole_file(path);
  std::string expected;
  size_t described = 0;
  const auto lines = split_lines(text);
  for (size_t i = 0; i < lines.size();) {
    const std::string head(lines[i++]);
    expected += head + "\n";
    std::map<std::string, std::string> keys;
    std::string rest;  // lines without a key
    std::string block;
    for (; i < lines.size() && lines[i].starts_with("  "); ++i) {
      const std::string line(lines[i]);
      block += line + "\n";
      if (line.starts_with("  stored + "))
        rest += line + "\n";
      else
        keys[line.substr(2, line.find_first_of("?:") - 2)] = line;
    }
    const bool is_settings = head.starts_with("settings ");
    described += is_settings ? 1 : 0;
    expected +=
        is_settings ? kGenerators.at(head.substr(9, head.find(':') - 9))(keys) + rest : block;
  }
  CHECK(described == kGenerators.size());
  if (std::getenv("VPR_SCHEMAS") != nullptr) std::ofstream(path) << expected;
  INFO("run scripts/generate.sh, and describe what is new");
  CHECK((text == expected || std::getenv("VPR_SCHEMAS") != nullptr));
}

TEST_CASE("every measure has its key in the schemas and in the reference") {
  const auto properties = [](const char* file, const char* where) {
    const Json schema =
        read_json(source_path(fmt::format("docs/schemas/{}.schema.json", file)), ErrorKind::input);
    return schema.at(Json::json_pointer(where));
  };
  const Json of_curves = properties("common", "/$defs/precision_recall/properties");
  const Json of_report = properties("report", "/properties/metrics/properties");
  const Json of_path = properties("report", "/properties/localization/properties");
  Json of_counts = properties("common", "/$defs/counts/properties");
  of_counts.update(properties("common", "/$defs/sequence_counts/properties"));
  Json of_best_match = properties("common", "/$defs/best_match/properties");
  of_best_match.update(properties("report", "/properties/best_match/properties"));
  const std::string reference = read_text(source_path("docs/reference/metrics.md"));
  for (const Metric& metric : metrics()) {
    const std::string key(metric.key.substr(metric.key.find('.') + 1));
    INFO(key);
    CHECK(has(reference, "`" + key));
    CHECK((metric.of_curve != nullptr ? of_curves
           : metric.of_path           ? of_path
           : metric.of_counts         ? of_counts
           : metric.of_best_match     ? of_best_match
                                      : of_report)
              .contains(key));
  }
}
