// Text files: locations for errors, strict numbers, the cells of a line, and CSV rows by column.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/mapped_file.h"
#include "base/monitor.h"
#include "base/text.h"
#include "sequence/sequence_source.h"

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

/// The cells of a column that refer to the frames of one side, each by its number or its name.
struct FrameCells {
  std::string_view what;              ///< such as "query"
  const FrameNames* names = nullptr;  ///< null: unknown
  std::vector<std::string_view> texts = {};
  bool are_names = false;  ///< numbers as well; set by find_names
};

/// Decides for all columns of a file whether numbers are names. They are if every cell of the
/// column is a name, and nothing shows that the file counts frames: a 0 that is not a name. Warns
/// where both readings are possible. Throws Error(data) if columns or cells contradict each other;
/// `advice` says how to state that they are numbers.
void find_names(std::span<FrameCells> columns, const FileLocation& file, std::string_view advice,
                const Monitor& monitor);

/// Parses a finite number with a decimal point in any locale; a leading + is allowed. Nullopt
/// otherwise.
std::optional<double> parse_real(std::string_view text);

/// Whether a cell stands for a missing value: it is empty or NaN.
bool is_missing(std::string_view cell);

/// The cells of a line, separated by commas and without surrounding blanks, or separated by blanks
/// if the line has no comma.
std::vector<std::string_view> cells_of(std::string_view line);

/// The rows of a list: of a CSV if its first line has a comma, a semicolon, a tab or a quote,
/// otherwise the words between blanks. Omits empty lines and lines that begin with #. Throws
/// Error(data) for a file that is not text, and as parse_csv does.
std::vector<CsvRow> read_list_rows(const std::filesystem::path& path);

/// The text of a CSV, with its header as the first line that is not a comment: if numbers follow
/// comments (#), the last comment, as numpy.savetxt writes the header.
std::string with_header(std::string text);

/// The column names in the first line of a CSV, in lower case. Empty if it is not a CSV.
std::vector<std::string> header_names(std::string_view line);

/// Whether the first line of a CSV names all of these columns.
bool has_columns(std::string_view first_line, const std::vector<std::string_view>& columns);

/// The rows of a CSV with access by column name, in lower case; columns may have any order.
class NamedRows {
 public:
  /// `name`: the file in errors. Throws Error(input) if the file cannot be read, Error(data) if it
  /// is not a CSV or its header lacks a column in `needed`.
  NamedRows(const std::filesystem::path& path, const std::string& name,
            const std::vector<std::string>& needed);

  /// The number of rows after the header.
  size_t size() const { return rows_.size() - 1; }
  /// Goes to the next row, at first to the first one. Returns false after the last one; the next
  /// call then begins again. Throws Error(data) if the number of fields differs from the header.
  bool next();
  bool has(std::string_view column) const;
  /// Throws Error(data) for a column that is not among these.
  void allow(const std::vector<std::string>& columns) const;
  const std::vector<std::string>& header() const { return rows_[0].fields; }
  const FileLocation& location() const { return location_; }
  /// The line in the file at which the current row starts, counted from 1.
  size_t line() const { return row_->line; }
  /// A field of the current row; empty if there is no such column.
  const std::string& text(std::string_view column) const;
  /// A finite number. Throws Error(data), with the line, for other text.
  double real(std::string_view column) const;
  /// A frame number up to kMaxGrownFrames. Throws Error(data), with the line, for other text.
  size_t frame(std::string_view column) const;
  /// Throws Error(data) with the current line.
  template <class... Values>
  [[noreturn]] void fail(fmt::format_string<Values...> what, Values&&... values) const {
    location_.fail(fmt::format(what, std::forward<Values>(values)...));
  }

 private:
  FileLocation location_;
  std::vector<CsvRow> rows_;
  size_t next_ = 1;
  const CsvRow* row_ = nullptr;
};

}  // namespace vpr
