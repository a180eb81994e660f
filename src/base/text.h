// Splitting, quoting, comparing and printing text.
#pragma once

#include <cstdint>
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

/// Whether bytes are UTF-8, as JSON must be.
bool is_utf8(const std::string& text);

/// The text behind the byte order mark that some editors put in front of it.
std::string_view without_byte_order_mark(std::string_view text);

/// Text for people, for a terminal maybe: control characters, of which escape sequences are made,
/// become \xHH, line feeds alone stay; and so does every byte that is not ASCII of a text that is
/// no UTF-8. Names of files and of what is in them may hold anything; all that a program prints
/// goes through here.
std::string printable(std::string_view text);

/// The same for what stands in one line, a name or a sentence: line feeds, too.
std::string printable_line(std::string_view text);

/// "1 hit", "2 hits", "0 hits". `plural`: of nouns that take more than an s.
std::string counted(uint64_t count, std::string_view noun, std::string_view plural = {});

/// Runs of digits compare by value, the rest by bytes: "2" < "10", "a2" < "a10" < "b1". Names that
/// differ only in leading zeros: fewer zeros first. A strict weak order of all byte strings.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace vpr
