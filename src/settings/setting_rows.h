// Rows of the tables of settings: everything about a setting except its field. Flags, checks of
// combinations and the help read them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"

namespace vpr {

/// Commands, inputs and outputs of a run, and settings that are chosen although they have their
/// default value. Errors name them as here.
enum class Feature {
  query,
  live,
  loops,
  sweep,
  database,
  fabmap,
  save_matrix,
  window_length,
  raw_score,
  by_threshold,
  thresholds,
  margins
};
template <>
inline constexpr std::array<std::string_view, 12> kEnumNames<Feature> = {
    "vpr-query",   "vpr-query live",     "vpr-query loops", "vpr-tune fastable",
    "DB",          "a FAB-MAP database", "--save-matrix",   "--c-l",
    "--score raw", "--decide threshold", "--t-r",           "--margin"};

using Features = std::vector<Feature>;

/// Facets of a run: every run has all of them, except those that its choices exclude.
enum Facet : uint32_t {
  kThreshold = 1 << 0,
  kMargin = 1 << 1,
  kRaw = 1 << 2,
  kZScores = 1 << 3,
  kWindows = 1 << 4,
  kEveryScore = 1 << 5,
  kSingleFrames = 1 << 6,
  kLaterFrames = 1 << 7,
  kTrainingDistances = 1 << 8,
  kSequences = 1 << 9,
  kPast = 1 << 10,
  kSeconds = 1 << 11,
  kDescriptor = 1 << 12,
  kAutomaticThreshold = 1 << 13,
};

/// By bit number.
inline constexpr std::array<std::string_view, 14> kFacetNames = {
    "threshold",
    "margin",
    "raw distances",
    "z-scores",
    "windows of c_l frames",
    "scores of all windows",
    "frame-by-frame matching",
    "later frames",
    "distances between training frames",
    "training sequences",
    "past frames",
    "gap in seconds",
    "choice of descriptors",
    "automatic t_r",
};

/// Headings of flags in the help.
inline constexpr const char* kQueryGroup = "Query";
inline constexpr const char* kWindowGroup = "Windows (FastABLE and OpenABLE) and the filter";

/// The commands of a flag, as bits of Feature.
template <class... Commands>
constexpr uint32_t in(Commands... commands) {
  return (0U | ... | (1U << static_cast<uint32_t>(commands)));
}

/// A setting as a flag. Its name is made from the key: "--t-r-scale" from t_r_scale. It needs and
/// excludes facets once its field is set: neither empty nor zero.
struct SettingRow {
  std::string_view key;         ///< of the field in visit_fields
  const char* group = nullptr;  ///< heading in the help; null: essential
  uint32_t commands = 0;        ///< that have the flag
  std::string_view help;        ///< {} is the default, the value of the field before flags are read
  std::string_view value = {};  ///< in the help; empty: by the type of the field
  std::vector<std::string> (*choices)() = nullptr;  ///< values for completions, or null
  bool is_for_windows = false;                      ///< selects FastABLE instead of the filter
  uint32_t needs = 0;                               ///< facets, as bits
  uint32_t excludes = 0;                            ///< facets, as bits
  std::string_view instead = {};  ///< of a missing facet: advice, an imperative sentence
};

std::string flag_of(std::string_view key);

/// The settings of sequence methods that have flags. A key has several rows if its help differs
/// between commands.
std::span<const SettingRow> sequence_setting_rows();

}  // namespace vpr
