// The one order of files in a folder.
#pragma once

#include <string_view>

namespace vpr {

/// Runs of digits compare by value, the rest by bytes: "2" < "10", "a2" < "a10" < "b1". Names that
/// differ only in leading zeros: fewer zeros first. A strict weak order of all byte strings.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace vpr
