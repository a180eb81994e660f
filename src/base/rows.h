// Rows of text: the tables and lists of any program, with columns by header or by position; and
// numbers in cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace vpr {

/// A file with a line or row, for errors.
struct FileLocation {
  std::string file;
  std::string_view unit = {};  ///< "line" or "row"; empty: the whole file
  size_t number = 0;

  void at(std::string_view new_unit, size_t new_number) {
    unit = new_unit;
    number = new_number;
  }
  /// Throws Error(data): "poses.csv, line 3: WHAT".
  [[noreturn]] void fail(std::string_view what) const;
  template <class First, class... Rest>
  [[noreturn]] void fail(fmt::format_string<First, Rest...> what, First&& first,
                         Rest&&... rest) const {
    fail(fmt::format(what, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
};

/// A frame number: digits, optionally after a minus sign and before ".0". Nullopt if `text` is not
/// an integer, or has leading zeros: those are of file names, which may count from 1.
struct FrameText {
  bool in_range = false;  ///< neither negative nor too large for 64 bits
  size_t value = 0;
};
std::optional<FrameText> parse_frame(std::string_view text);
/// The end of a sentence: why `text` is not a frame number; empty unless it has leading zeros.
std::string_view no_number_hint(std::string_view text);
/// A sentence to append if `text` is a number with a decimal comma; otherwise empty.
std::string_view decimal_comma_hint(std::string_view text);

/// Parses a finite number with a decimal point in any locale; a leading + is allowed. Nullopt
/// otherwise.
std::optional<double> parse_real(std::string_view text);

/// Whether a cell stands for a missing value: it is empty or NaN.
bool is_missing(std::string_view cell);

/// In nanoseconds.
enum class TimeUnit : int64_t {
  nanoseconds = 1,
  microseconds = 1000,
  milliseconds = 1'000'000,
  seconds = 1'000'000'000
};

/// The first one in the first row separates the cells of a table.
inline constexpr std::string_view kTableSeparators = ",;\t";
/// Without any, blanks separate the words of a list.
inline constexpr std::string_view kListSeparators = ",;\t ";

/// The rules of a file of rows.
struct RowRules {
  /// Names in lower case. Without a header, columns are at the positions in this order.
  std::vector<std::string_view> columns = {};
  size_t needed = 0;         ///< the first columns, which every file has
  bool needs_header = true;  ///< otherwise one is optional
  std::string_view separators = kTableSeparators;
  bool has_others = false;  ///< other columns are skipped, not refused
  bool is_ragged = false;   ///< rows may have any number of cells; empty last ones are omitted
};

/// Rules of a list: its header is optional, and other cells follow its first column.
inline RowRules list_rules(std::vector<std::string_view> columns) {
  return {std::move(columns), 1, /*needs_header=*/false, kListSeparators, /*has_others=*/true,
          /*is_ragged=*/true};
}

/// The first line that is neither empty nor a comment, without its end.
std::string_view first_line_of(std::string_view text);
/// The first row of a text, as Rows finds a required header; empty for text without rows, or with
/// damaged quotes.
std::vector<std::string> first_row(std::string text,
                                   std::string_view separators = kTableSeparators);

/// The rows of a file of text. Cells may be in quotes (RFC 4180), with blanks around them. Skips a
/// byte order mark, empty lines, lines that begin with #, and Excel's line sep=; before the first
/// row. That is the header if it is needed, or if it names a needed column; a needed header may
/// also be the last comment before numbers, as numpy.savetxt writes it, or before any row if it
/// names a column for each cell. A header names columns in any order and case, with or without a
/// unit ("time", "Stamp [ms]", "time_ms", "milliseconds"; base/column_names.h).
class Rows {
 public:
  /// `name`: the file in errors. Throws Error(input) if the file cannot be read; Error(data) for
  /// zero bytes and damaged quotes, for a header that lacks a needed column or has another one or
  /// two of one kind, and for a first row without a header that has too few or too many cells, or
  /// counts 0, 1, 2, ... before a row of real numbers or after an empty cell.
  Rows(const std::filesystem::path& path, const std::string& name, const RowRules& rules);
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;
  ~Rows() = default;

  /// Without the header.
  size_t size() const { return rows_.size() - 1 - first_; }
  /// Empty without a header.
  const std::vector<std::string>& header() const { return header_; }
  bool has(std::string_view column) const { return find(column) != nullptr; }
  /// The unit in the name of a column of times.
  std::optional<TimeUnit> time_unit(std::string_view column) const;

  /// Goes to the next row, at first to the first one. Returns false after the last one; the next
  /// call then begins again. Throws Error(data) for another number of cells than in the first row,
  /// unless rows may be ragged.
  bool next();
  /// The line in the file at which the current row starts, counted from 1.
  size_t line() const { return location_.number; }
  const FileLocation& location() const { return location_; }
  /// The cells of the current row; they live as long as the rows.
  std::span<const std::string_view> cells() const { return row_; }
  /// A cell of the current row; empty if there is no such column.
  std::string_view text(std::string_view column) const;
  /// A finite number, converted to meters or degrees from a unit in the header; nullopt for other
  /// text.
  std::optional<double> number(std::string_view column) const;
  /// Throws Error(data), with the line, for other text than a finite number.
  double real(std::string_view column) const;
  /// A frame number. Throws Error(data), with the line, for other text and above `most`.
  size_t frame(std::string_view column, size_t most = std::numeric_limits<size_t>::max()) const;
  /// Throws Error(data) with the current line.
  template <class... Values>
  [[noreturn]] void fail(fmt::format_string<Values...> what, Values&&... values) const {
    location_.fail(fmt::format(what, std::forward<Values>(values)...));
  }

 private:
  struct Row {
    size_t line = 0;
    size_t begin = 0;  ///< of its cells
  };
  struct FoundColumn {
    std::string_view name;
    size_t index = 0;
    std::optional<double> unit = {};  ///< in nanoseconds, meters or degrees; unset: not stated
  };

  std::span<const std::string_view> cells_of(size_t row) const {
    return std::span(cells_).subspan(rows_[row].begin, rows_[row + 1].begin - rows_[row].begin);
  }
  void join_names(size_t columns);
  void find_columns();
  const FoundColumn* find(std::string_view column) const;
  [[noreturn]] void refuse(std::string_view column, std::string_view what) const;

  FileLocation location_;
  RowRules rules_;
  std::string text_;
  std::vector<std::string_view> cells_;  ///< of all rows
  std::vector<Row> rows_;                ///< with one after the last
  std::vector<std::string> header_;
  std::vector<FoundColumn> found_;
  size_t first_ = 0;  ///< row after the header
  size_t next_ = 0;
  size_t width_ = 0;  ///< cells per row
  std::span<const std::string_view> row_;
};

}  // namespace vpr
