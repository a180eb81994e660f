// Text that a terminal shows and does not obey.
#pragma once

#include <string>
#include <string_view>

namespace vpr {

/// Text for people, for a terminal maybe: control characters, of which escape sequences are made,
/// become \xHH, line feeds alone stay; and so does every byte that is not ASCII of a text that is
/// no UTF-8. Names of files and of what is in them may hold anything; all that a program prints
/// goes through here.
std::string printable(std::string_view text);

/// The same for what stands in one line, a name or a sentence: line feeds, too.
std::string printable_line(std::string_view text);

}  // namespace vpr
