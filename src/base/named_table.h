// Tables whose rows are selected by name: methods, variants, formats, presets.
#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"

namespace vpr {

/// The names of all rows, in their order. Rows have a member `name`.
template <class Table>
std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& row : table) names.emplace_back(row.name);
  return names;
}

/// Throws Error(usage): `word` is not the name of a `what` ("method"). The message lists all
/// `names`, of which there is at least one, and names the nearest one within two edits.
[[noreturn]] inline void refuse_name(std::string_view what, std::string_view word,
                                     const std::vector<std::string>& names) {
  constexpr size_t kMostEdits = 2;
  const std::string near = nearest(word, names);
  throw Error(
      ErrorKind::usage, "unknown {} \"{}\"{} There are {}", what, word,
      edit_distance(word, near) > kMostEdits ? "." : fmt::format("; did you mean {}?", near),
      fmt::join(names, ", "));
}

/// The first row with this name; null if there is none.
const auto* find_in(const auto& table, std::string_view name) {
  const auto found = std::ranges::find_if(table, [&](const auto& row) { return row.name == name; });
  return found == std::end(table) ? nullptr : &*found;
}

/// The first row with this name. Throws as refuse_name does.
template <class Table>
const auto& find_named(const Table& table, std::string_view what, std::string_view name) {
  for (const auto& row : table)
    if (row.name == name) return row;
  refuse_name(what, name, names_of(table));
}

}  // namespace vpr
