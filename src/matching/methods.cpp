#include "matching/methods.h"

#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/named_table.h"
#include "matching/fastable_batch.h"
#include "matching/fastable_online.h"
#include "matching/lsh.h"
#include "matching/openable.h"

namespace vpr {
namespace {

constexpr std::array<SequenceMethod, 4> kMethods = {{
    {"fastable", "distances re-used from row to row, the whole query at once", true, true, true,
     match_fastable},
    {"fastable-online", "the same, one query frame after the other as on a phone", true, true, true,
     match_fastable_online},
    {"openable", "every window distance by its definition (slow)", true, false, false,
     match_openable},
    {"lsh", "hashing, approximate: near windows only, and not all of them", false, false, false,
     match_lsh},
}};

}  // namespace

std::span<const SequenceMethod> sequence_methods() { return kMethods; }

const SequenceMethod& find_sequence_method(std::string_view name) {
  return find_named(kMethods, "method", name);
}

}  // namespace vpr
