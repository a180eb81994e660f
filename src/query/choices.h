// The choice of a rule: from the keys of a command line, a configuration file or a call to a
// checked query. The only place that knows which settings were given.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "query/query_settings.h"
#include "query/setting_rows.h"

namespace vpr {

/// The method of a query that does not name one: the filter, or fastable for loops and sweeps, or
/// if a setting of windows is given, such as c_l. `given`: keys of settings.
std::string_view default_method(QueryCommand command, std::span<const std::string> given);

/// The query of `command` by `keys`, of which `given` have values that the user chose. Throws
/// Error(usage) for a given value that the query cannot have, with the setting that it does not go
/// with and the cure, and as check_settings does. The grid of a sweep replaces t_r or the margin.
SequenceQuerySettings choose_query(SequenceKeys keys, std::span<const std::string> given,
                                   QueryCommand command);

/// Throws Error(usage) "--t-r does not go with --method filter", with the cure.
[[noreturn]] void refuse_setting(std::string_view key, const Rule& rule);

/// Throws Error(usage) for a value out of range, for one that does not fit the score, and for a
/// loop query that needs distances between training frames.
void check_settings(const SequenceQuerySettings& settings);

}  // namespace vpr
