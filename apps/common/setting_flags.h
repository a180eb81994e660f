// Flags that set one field of a settings struct, with the same checks as in a configuration file.
#pragma once

#include <optional>
#include <string>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "flags.h"

namespace vpr {

struct SequenceQuerySettings;

/// --max-memory, which errors name, too.
inline constexpr const char* kMemoryFlag = "--max-memory";

/// The number or text that a flag means, as JSON: ".5", "+1" and "1e-3" are numbers here.
Json flag_value(const std::string& text);

/// Whether a field is one of some names, or may be.
template <class T>
inline constexpr bool kIsEnumField = std::is_enum_v<T>;
template <class T>
inline constexpr bool kIsEnumField<std::optional<T>> = std::is_enum_v<T>;

/// What a flag's value is called in help: the names of an enum, which completions offer, or a word.
template <class T>
std::string value_name() {
  if constexpr (detail::kIsOptional<T>)
    return value_name<typename T::value_type>();
  else if constexpr (std::is_enum_v<T>)
    return fmt::format("{}", fmt::join(kEnumNames<T>, "|"));
  else
    return std::is_arithmetic_v<T> ? "NUMBER" : "VALUE";
}

/// A flag that sets one field of a settings struct, with the same checks as in a file.
template <class T>
Flag add_setting(const Command& command, const std::string& flag, T& field,
                 const std::string& help) {
  return command
      .add_option(
          flag,
          [&field, flag](const std::string& text) {
            const bool is_text = std::is_same_v<T, std::string> || kIsEnumField<T>;
            value_from_json(is_text ? Json(text) : flag_value(text), field, "command line", flag);
          },
          help)
      .type_name(value_name<T>());
}

/// Flags of scores and exclusion zones: --score, --rates, --margin-width, --same-place. Help lists
/// them under `group`; empty: under the usual heading.
void add_score_settings(const Command& command, SequenceQuerySettings& settings,
                        const std::string& group = "");

/// Flags of decisions and of scores that are fused with FAB-MAP's: --decide, --t-r-scale, --fuse,
/// whose path is `fabmap`, and --fuse-beta.
void add_decision_settings(const Command& command, SequenceQuerySettings& settings,
                           std::string& fabmap, const std::string& group = "");

/// --skip-unreadable.
void add_unreadable_flag(const Command& command, bool& skip_unreadable);

/// --max-memory, in bytes or as "512M" or "2G", powers of 1024; the help ends with the value that
/// `bytes` has.
Flag add_memory_flag(const Command& command, size_t& bytes, const std::string& help);

}  // namespace vpr
