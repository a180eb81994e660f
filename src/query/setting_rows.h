// Rows of the tables of settings: everything about a setting except its field. Flags, refusals and
// the help read them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"

namespace vpr {

/// The commands that match sequences. Errors name them as here.
enum class QueryCommand { query, live, loops, sweep };
template <>
inline constexpr std::array<std::string_view, 4> kEnumNames<QueryCommand> = {
    "vpr-query", "vpr-query live", "vpr-query loops", "vpr-tune fastable"};

/// Headings of flags in the help.
inline constexpr const char* kQueryGroup = "Query";
inline constexpr const char* kWindowGroup = "Windows (FastABLE and OpenABLE) and the filter";

/// The commands of a flag, as bits of QueryCommand.
template <class... Commands>
constexpr uint32_t in(Commands... commands) {
  return (0U | ... | (1U << static_cast<uint32_t>(commands)));
}

/// A setting as a flag. Its name is made from the key: "--t-r-scale" from t_r_scale.
struct SettingRow {
  std::string_view key;         ///< of the field in visit_fields
  const char* group = nullptr;  ///< heading in the help; null: essential
  uint32_t commands = 0;        ///< that have the flag
  std::string_view help;        ///< {} is the default, the value of the field before flags are read
  std::string_view value = {};  ///< in the help; empty: by the type of the field
  std::vector<std::string> (*choices)() = nullptr;  ///< values for completions, or null
  bool is_for_windows = false;                      ///< selects FastABLE instead of the filter
  /// With a rule or a command that does not have the setting: advice, an imperative sentence.
  std::string_view instead = {};
};

std::string flag_of(std::string_view key);

/// The settings of sequence methods that have flags. A key has several rows if its help differs
/// between commands.
std::span<const SettingRow> sequence_setting_rows();

}  // namespace vpr
