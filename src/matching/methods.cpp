#include "matching/methods.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/named_table.h"
#include "matching/fastable_batch.h"
#include "matching/fastable_online.h"
#include "matching/match_filter.h"
#include "matching/openable.h"

namespace vpr {
namespace {

constexpr std::array<SequenceMethod, 4> kMethods = {{
    {"fastable", "distances re-used from row to row, the whole query at once", true, true, false,
     match_fastable},
    {"fastable-online", "the same, one query frame after the other as on a phone", true, true,
     false, match_fastable_online},
    {"openable", "every window distance by its definition (slow)", false, false, false,
     match_openable},
    {"filter", "a path through frames at any pace, believed once it was followed for a while", true,
     false, true, match_filter},
}};

}  // namespace

std::span<const SequenceMethod> sequence_methods() { return kMethods; }

const SequenceMethod& find_sequence_method(std::string_view name) {
  return find_named(kMethods, "method", name);
}

bool has_paths(std::string_view method) {
  return std::any_of(kMethods.begin(), kMethods.end(),
                     [&](const SequenceMethod& m) { return m.name == method && m.has_paths; });
}

}  // namespace vpr
