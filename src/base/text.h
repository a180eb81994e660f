// Texts cut into parts, and words that are nearly alike.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vpr {

/// What stands between separators, empty parts included: one part more than there are separators.
/// The parts are views of `text`.
std::vector<std::string_view> split(std::string_view text, char separator);

/// The lines of a text without their ends, \n or \r\n. The end of the last line begins no other;
/// an empty text has no lines.
std::vector<std::string_view> split_lines(std::string_view text);

/// What stands between blanks (spaces, tabs and carriage returns), however many there are.
std::vector<std::string_view> split_words(std::string_view text);

/// A word of a shell's command line, quoted where a shell needs it.
std::string shell_word(const std::string& word);

/// Inserts, deletes, replacements and swaps of neighbours between two words, for "did you mean".
size_t edit_distance(std::string_view a, std::string_view b);

/// The name closest to `word`, the first of several; names must not be empty.
std::string nearest(std::string_view word, const std::vector<std::string>& names);

}  // namespace vpr
