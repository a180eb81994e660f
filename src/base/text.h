// Functions that split, quote, escape, compare and print strings.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace vpr {

/// The parts between separators, including empty ones: one part more than there are separators. The
/// parts are views of `text`.
std::vector<std::string_view> split(std::string_view text, char separator);

/// The lines of a text without their ends, \n or \r\n, and without a byte order mark. The end of
/// the last line does not start another line; an empty text has no lines.
std::vector<std::string_view> split_lines(std::string_view text);

/// A word of a shell command line, quoted if necessary.
std::string shell_word(const std::string& word);

/// The number that is the whole text, with a decimal point in any locale; nullopt for other text,
/// and for a number out of range of T.
template <class T>
std::optional<T> parse_number(std::string_view text) {
  T value{};
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  return error == std::errc{} && end == last ? std::optional(value) : std::nullopt;
}

/// The number of insertions, deletions, replacements and swaps of adjacent characters between two
/// words, for "did you mean".
size_t edit_distance(std::string_view a, std::string_view b);

/// The name closest to `word`, the first one on a tie; names must not be empty.
std::string nearest(std::string_view word, const std::vector<std::string>& names);

/// The text with the letters A to Z in lower case, in any locale.
std::string lower_case(std::string text);

/// Whether bytes are valid UTF-8, as JSON requires.
bool is_utf8(const std::string& text);

/// The text without the byte order mark that some editors put at its beginning.
std::string_view without_byte_order_mark(std::string_view text);

/// Text that is safe on a terminal: control characters, which form escape sequences, become \xHH,
/// except line feeds; if the text is not valid UTF-8, so does every byte outside ASCII. Names of
/// files and their contents may hold any bytes, so all output of a program passes through here.
std::string printable(std::string_view text);

/// As printable, for a single line: line feeds are escaped as well.
std::string printable_line(std::string_view text);

/// "1 recognition", "2 recognitions", "0 recognitions". `plural`: for nouns whose plural is not
/// formed with s.
std::string counted(uint64_t count, std::string_view noun, std::string_view plural = {});

/// Whether a byte starts a letter of UTF-8.
constexpr bool starts_letter(char byte) { return (byte & 0xc0) != 0x80; }

/// The largest position up to `at` where a letter of UTF-8 starts; `at` is below the size.
size_t letter_start(std::string_view text, size_t at);

/// A value of the user for a message: at most 60 bytes of it.
std::string shortened(std::string_view text);

/// Breaks a line of more than `width` columns between words. Broken lines end with `end`, and the
/// following ones are indented by `indent` columns. A longer word is a line of its own.
std::string wrapped_line(const std::string& line, size_t width, size_t indent,
                         const std::string& end = {});

/// A shell command, indented by two columns, on lines of at most 80 columns that end with a
/// backslash if another follows. Words are not broken; one may be a flag with its value.
std::string wrapped_command(const std::vector<std::string>& words);

/// Runs of digits compare by value, other characters by byte: "2" < "10", "a2" < "a10" < "b1". If
/// names differ only in leading zeros, fewer zeros come first. A strict weak order of all byte
/// strings.
bool natural_less(std::string_view a, std::string_view b);

/// A field of CSV, quoted if necessary.
std::string csv_field(std::string_view text);

/// A string for element content and quoted attributes: & < > " ' become references; bytes that are
/// not UTF-8 and control characters become U+FFFD.
std::string html_escaped(std::string_view text);

/// RFC 4648, padded.
std::string base64(std::span<const std::byte> bytes);

}  // namespace vpr
