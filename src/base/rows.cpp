#include "base/rows.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/ranges.h>

#include "base/column_names.h"
#include "base/converters.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"

namespace vpr {

namespace {

// Whether digits begin with zeros, as only those of names do.
bool is_padded(std::string_view text) {
  return text.size() > 1 && text.front() == '0' &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

bool names_separator(std::string_view line) { return line.starts_with("sep="); }

/// Splits text into rows of cells, in place: cells lose their quotes.
class Splitter {
 public:
  /// `reads_header`: the last comment before numbers is the first row. `location` always has the
  /// line of the latest row.
  Splitter(std::string& text, std::string_view separators, bool reads_header,
           FileLocation& location)
      : text_(text),
        separators_(separators),
        reads_header_(reads_header),
        location_(location),
        at_(text.size() - without_byte_order_mark(text).size()) {}

  // Appends the cells of the next row. Returns false after the last one.
  bool next(std::vector<std::string_view>& cells) {
    std::string_view line;
    for (;; ++line_) {
      if (at_ >= text_.size()) return false;
      line = view(at_, std::min(text_.find('\n', at_), text_.size()));
      const size_t start = line.find_first_not_of(separator_ == '\t' ? " \r" : " \t\r");
      const bool is_comment = start < line.size() && line[start] == '#';
      if (start < line.size() && !is_comment && (separator_ != 0 || !names_separator(line))) break;
      if (is_comment) comment_ = at_ + start + 1;
      at_ = std::min(at_ + line.size() + 1, text_.size());
    }
    location_.at("line", line_);
    if (separator_ == 0) {
      const auto separator = std::ranges::find_if(
          separators_, [&](char c) { return c == ' ' || line.find(c) < line.size(); });
      separator_ = separator == separators_.end() ? separators_.front() : *separator;
      const size_t row = at_;
      skip_blanks();
      const bool is_header = reads_header_ && comment_ > 0 && text_[at_] != '"' &&
                             (parse_real(cell()) || comment_names_cells(row));
      at_ = is_header ? comment_ : row;
      if (is_header) read_cells(cells);
      at_ = row;
      if (is_header) return true;
    }
    read_cells(cells);
    ++line_;
    return true;
  }
  char separator() const { return separator_; }

 private:
  std::string_view view(size_t begin, size_t end) const {
    return std::string_view(text_).substr(begin, end - begin);
  }

  // Whether the last comment names a column for each cell of the row at `row`. Not with quotes,
  // which cannot be read twice.
  bool comment_names_cells(size_t row) {
    std::vector<std::string_view> names;
    std::vector<std::string_view> values;
    for (auto [begin, cells] : {std::pair(comment_, &names), std::pair(row, &values)}) {
      const size_t end = std::min(text_.find('\n', begin), text_.size());
      if (view(begin, end).find('"') != std::string_view::npos) return false;
      at_ = begin;
      read_cells(*cells);
    }
    return names.size() == values.size() && are_columns(names);
  }

  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  void skip_blanks() {
    while (take(' ') || (separator_ != '\t' && take('\t'))) {
    }
  }

  void read_cells(std::vector<std::string_view>& cells) {
    do cells.push_back(cell());
    while (take_separator());
    take('\r');
    if (at_ < text_.size() && !take('\n'))
      location_.fail(text_[at_] == '"'
                         ? "a quote is inside a cell without quotes. Enclose the cell in quotes, "
                           "and double those inside"
                         : "expected a separator or a line feed after a cell");
  }

  bool take_separator() {
    const size_t end = at_;
    skip_blanks();
    if (separator_ != ' ') return take(separator_);
    return at_ > end && at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r';
  }

  std::string_view cell() {
    skip_blanks();
    size_t begin = at_;
    if (take('"')) {
      begin = at_;
      for (size_t end = begin;; ++end) {
        if (at_ >= text_.size()) location_.fail("a quote is not closed");
        const char c = text_[at_++];
        if (c == '"' && !take('"')) return view(begin, end);
        if (c == '\n') ++line_;
        text_[end] = c;
      }
    }
    const std::string_view ends = separator_ == ' ' ? " \t\r\n\"" : "\r\n\"";
    while (at_ < text_.size() && text_[at_] != separator_ &&
           ends.find(text_[at_]) == std::string_view::npos)
      ++at_;
    size_t end = at_;
    while (end > begin && (text_[end - 1] == ' ' || text_[end - 1] == '\t')) --end;
    return view(begin, end);
  }

  std::string& text_;
  std::string_view separators_;
  bool reads_header_;
  FileLocation& location_;
  size_t at_;
  size_t line_ = 1;
  char separator_ = 0;  // unknown before the first row
  size_t comment_ = 0;  // after the # of the last one; 0: none
};

// Whether a row is 0, 1, 2, ..., as pandas names columns without names, after an empty cell above
// its index.
bool counts_columns(std::span<const std::string_view> cells) {
  if (!cells.empty() && cells[0].empty()) cells = cells.subspan(1);
  for (size_t i = 0; i < cells.size(); ++i)
    if (cells[i] != std::to_string(i)) return false;
  return cells.size() > 2;
}

// "query,match[,score]".
std::string columns_text(const RowRules& rules) {
  std::string text;
  for (size_t i = 0; i < rules.columns.size(); ++i)
    text += i < rules.needed ? fmt::format("{}{}", i == 0 ? "" : ",", rules.columns[i])
                             : fmt::format("[,{}]", rules.columns[i]);
  return text;
}

}  // namespace

void FileLocation::fail(std::string_view what) const {
  const std::string position = unit.empty() ? "" : fmt::format(", {} {}", unit, number);
  throw Error(ErrorKind::data, "{}{}: {}", file, position, what);
}

std::optional<FrameText> parse_frame(std::string_view text) {
  constexpr double kMostExact = 9007199254740992;  // 2^53
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  // 7.000000000000000000e+00, as numpy.savetxt writes all numbers.
  if (const size_t power = text.find('e'); power < text.size() && text.find('.') < power) {
    const auto value = parse_real(text);
    if (value && *value == std::floor(*value) && *value < kMostExact)
      return FrameText{!negative || *value == 0, static_cast<size_t>(*value)};
  }
  if (const size_t point = text.find('.');
      point != 0 && point + 1 < text.size() &&
      text.find_first_not_of('0', point + 1) == std::string_view::npos)
    text = text.substr(0, point);  // 7.0, as other programs write integers in a column with gaps
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos ||
      is_padded(text))
    return std::nullopt;
  const auto value = parse_number<size_t>(text);
  return FrameText{value && (!negative || *value == 0), value.value_or(0)};
}

std::string_view no_number_hint(std::string_view text) {
  return is_padded(text) ? " because of its leading zeros. Frames count from 0" : "";
}

std::string_view decimal_comma_hint(std::string_view text) {
  std::string with_point(text);
  std::ranges::replace(with_point, ',', '.');
  return text.find(',') < text.size() && parse_real(with_point) ? ". Write decimal points" : "";
}

std::optional<double> parse_real(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto value = parse_number<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

bool is_missing(std::string_view cell) {
  constexpr std::array<std::string_view, 9> kMissing = {"",     "nan",  "NaN", "NAN", "-nan",
                                                        "-NaN", "null", "NA",  "N/A"};
  return std::ranges::find(kMissing, cell) != kMissing.end();
}

std::string_view first_line_of(std::string_view text) {
  for (const std::string_view line : split_lines(text))
    if (!line.empty() && !line.starts_with('#') && !names_separator(line)) return line;
  return "";
}

std::vector<std::string> first_row(std::string text, std::string_view separators) {
  FileLocation location;
  std::vector<std::string_view> cells;
  try {
    Splitter(text, separators, /*reads_header=*/true, location).next(cells);
  } catch (const Error&) {
    return {};
  }
  return {cells.begin(), cells.end()};
}

Rows::Rows(const std::filesystem::path& path, const std::string& name, const RowRules& rules)
    : location_{name}, rules_(rules), text_(read_whole_file(path)) {
  constexpr size_t kStart = 256;
  refuse_convertible(path, std::string_view(text_).substr(0, kStart), /*arrays_only=*/true);
  if (const size_t zero = text_.find('\0'); zero != std::string::npos) {
    location_.at("line", split_lines(std::string_view(text_).substr(0, zero + 1)).size());
    fail("it is not text, because it has a zero byte{}",
         text_.starts_with("\x93NUMPY") ? ". numpy.savetxt writes an array as text"
                                        : ". Save arrays as .npy");
  }
  Splitter splitter(text_, rules.separators, rules.needs_header, location_);
  for (size_t begin = 0; splitter.next(cells_); begin = cells_.size())
    rows_.push_back({location_.number, begin});
  rows_.push_back({0, cells_.size()});
  location_ = {name};
  const auto first = rows_.size() > 1 ? cells_of(0) : row_;
  header_.assign(first.begin(), first.end());
  const auto is_named = [&](auto column) { return has_columns(header_, {column}); };
  // The zone of a date may be "UTC", which is also the name of a column.
  const bool begins_with_digit = !first.empty() && first[0].find_first_of("0123456789") == 0;
  const bool has_header =
      rules.needs_header ||
      (!begins_with_digit &&
       std::ranges::any_of(std::span(rules.columns).first(rules.needed), is_named));
  if (has_header) {
    first_ = next_ = first.empty() ? 0 : 1;
    if (splitter.separator() == ' ' && rows_.size() > 2) join_names(cells_of(1).size());
  } else {
    const auto has_point = [](std::string_view cell) { return cell.find('.') < cell.size(); };
    if (counts_columns(first) && rows_.size() > 2 &&
        (first[0].empty() || std::ranges::any_of(cells_of(1), has_point)))
      fail(
          "its first line, 0, 1, 2, ..., seems to be a header of pandas. Name the columns, or omit "
          "it, as in to_csv(header=False, index=False)");
    header_.assign(rules.columns.begin(), rules.columns.end());
    if (!rules.is_ragged && !first.empty()) header_.resize(std::min(header_.size(), first.size()));
  }
  width_ = has_header || !rules.has_others ? header_.size() : first.size();
  find_columns();
  if (!has_header) header_.clear();
}

// Joins words of names that blanks have split: "time [ms]" and, down to `columns`, "time ms".
void Rows::join_names(size_t columns) {
  for (size_t i = header_.size(); i-- > 1;) {
    const std::string name = header_[i - 1] + " " + header_[i];
    const bool is_name = std::ranges::any_of(
        rules_.columns, [&](auto column) { return has_columns({name}, {column}); });
    if (std::string_view("[(").find(header_[i][0]) == std::string_view::npos &&
        (header_.size() <= columns || !is_name))
      continue;
    header_[i - 1] = name;
    header_.erase(header_.begin() + static_cast<ptrdiff_t>(i));
  }
}

void Rows::find_columns() {
  std::vector<bool> is_known(header_.size());
  for (size_t c = 0; c < rules_.columns.size(); ++c) {
    const std::string_view column = rules_.columns[c];
    size_t rank = 0;  // of the column that was found
    for (size_t i = 0; i < header_.size(); ++i) {
      const auto name = parse_column_name(header_[i], column);
      if (!name || (has(column) && name->rank > rank && rules_.has_others)) continue;
      is_known[i] = true;
      if (has(column) && name->rank < rank && rules_.has_others) found_.pop_back();
      if (has(column))
        fail("its header has two columns {}: \"{}\" and \"{}\". Remove or rename one", column,
             header_[find(column)->index], header_[i]);
      found_.push_back({column, i, name->unit});
      rank = name->rank;
    }
    if (c < rules_.needed && !has(column))
      fail("has no column {}. Expected {}", column, columns_text(rules_));
  }
  // pandas writes its index as a first column without a name.
  if (header_.size() > 1 && header_[0].empty()) is_known[0] = true;
  for (size_t i = 0; i < header_.size() && !rules_.has_others; ++i)
    if (!is_known[i])
      fail("has an unknown column \"{}\". Known columns are {}; remove or rename it", header_[i],
           fmt::join(rules_.columns, ", "));
}

const Rows::FoundColumn* Rows::find(std::string_view column) const {
  const auto found = std::ranges::find(found_, column, &FoundColumn::name);
  return found == found_.end() ? nullptr : &*found;
}

std::optional<TimeUnit> Rows::time_unit(std::string_view column) const {
  const FoundColumn* found = find(column);
  if (found == nullptr || !found->unit) return std::nullopt;
  return TimeUnit(static_cast<int64_t>(*found->unit));
}

bool Rows::next() {
  if (next_ + 1 == rows_.size()) {
    next_ = first_;
    location_ = {location_.file};
    return false;
  }
  row_ = cells_of(next_);
  location_.at("line", rows_[next_++].line);
  if (!rules_.is_ragged && row_.size() != width_)
    fail("expected {} columns, found {}", width_, row_.size());
  while (rules_.is_ragged && row_.size() > 1 && row_.back().empty())
    row_ = row_.first(row_.size() - 1);
  return true;
}

std::string_view Rows::text(std::string_view column) const {
  const FoundColumn* found = find(column);
  return found != nullptr && found->index < row_.size() ? row_[found->index] : "";
}

std::optional<double> Rows::number(std::string_view column) const {
  const auto value = parse_real(text(column));
  return value ? std::optional(*value * find(column)->unit.value_or(1)) : std::nullopt;
}

double Rows::real(std::string_view column) const {
  const auto value = number(column);
  if (!value) refuse(column, "number");
  return *value;
}

size_t Rows::frame(std::string_view column, size_t most) const {
  const auto number = parse_frame(text(column));
  if (!number || !number->in_range || number->value > most) refuse(column, "frame number");
  return number->value;
}

void Rows::refuse(std::string_view column, std::string_view what) const {
  const std::string_view cell = text(column);
  const bool may_be_header = header_.empty() && next_ == 1 && !parse_real(row_.front());
  fail("{} \"{}\" is not a {}{}{}{}", column, shortened(cell), what, no_number_hint(cell),
       decimal_comma_hint(cell),
       may_be_header ? ". A header has the columns " + columns_text(rules_) : "");
}

}  // namespace vpr
