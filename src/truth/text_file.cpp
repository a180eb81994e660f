#include "truth/text_file.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"
#include "truth/ground_truth.h"

namespace vpr {

namespace {

// Whether digits begin with zeros, as only those of names do.
bool is_padded(std::string_view text) {
  return text.size() > 1 && text.front() == '0' &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

void FileLocation::fail(std::string_view what) const {
  const std::string position = unit.empty() ? "" : fmt::format(", {} {}", unit, number);
  throw Error(ErrorKind::data, "{}{}: {}", file, position, what);
}

std::optional<FrameText> parse_frame(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
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

namespace {

/// The numbers of a column.
struct Digits {
  FrameCells* column;
  bool are_all = true;  // cells of the column
  size_t named = 0;
  std::string_view moved;     // the first one that is the name of another frame
  std::string_view unnamed;   // the first one that is not a name
  bool count_frames = false;  // from 0, which is not a name

  explicit Digits(FrameCells& cells) : column(&cells) {
    for (const std::string_view text : cells.texts) {
      const auto number = parse_frame(text);
      are_all = are_all && number;
      if (is_padded(text)) cells.are_names = true;
      if (!number) continue;
      const auto frame = cells.names == nullptr ? std::nullopt : cells.names->find(text);
      named += frame ? 1 : 0;
      if (frame && moved.empty() && *frame != number->value) moved = text;
      if (!frame && unnamed.empty()) unnamed = text;
      count_frames = count_frames || (cells.names != nullptr && !frame && number->value == 0);
    }
    count_frames = count_frames && are_all;
  }
};

}  // namespace

void find_names(std::span<FrameCells> columns, const FileLocation& file, std::string_view advice,
                const Monitor& monitor) {
  const std::vector<Digits> all(columns.begin(), columns.end());
  const bool count_frames = std::ranges::any_of(all, &Digits::count_frames);
  for (const Digits& digits : all) {
    FrameCells& column = *digits.column;
    if (column.are_names || digits.moved.empty() || (digits.are_all && count_frames)) continue;
    column.are_names = digits.unnamed.empty();
    if (digits.are_all && !column.are_names && 2 * digits.named <= column.texts.size()) continue;
    const auto other = std::ranges::find_if(all, [&](const Digits& one) {
      return !one.unnamed.empty() && (one.column == &column || (one.are_all && digits.are_all));
    });
    if (other != all.end())
      file.fail(
          "{} {} is the number of one frame and the name of another, {}, but {} {} is not a name. "
          "Write names with their extension. {}",
          column.what, digits.moved, *column.names->find(digits.moved), other->column->what,
          other->unnamed, advice);
    if (digits.are_all)
      warn(monitor,
           "{}: {} is read as the name of frame {}, because every cell of its column is a name. {}",
           file.file, digits.moved, *column.names->find(digits.moved), advice);
  }
}

std::string_view no_number_hint(std::string_view text) {
  return is_padded(text) ? " because of its leading zeros. Frames count from 0" : "";
}

std::optional<double> parse_real(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto value = parse_number<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

bool is_missing(std::string_view cell) {
  constexpr std::array<std::string_view, 6> kMissing = {"", "nan", "NaN", "NAN", "-nan", "-NaN"};
  return std::ranges::find(kMissing, cell) != kMissing.end();
}

std::vector<std::string_view> cells_of(std::string_view line) {
  if (line.find(',') == std::string_view::npos) return split_words(line);
  std::vector<std::string_view> cells;
  for (const std::string_view part : split(line, ',')) {
    const auto words = split_words(part);
    cells.push_back(words.size() == 1 ? words.front() : part);
  }
  return cells;
}

std::vector<CsvRow> read_list_rows(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  if (text.find('\0') != std::string::npos)
    FileLocation{path.string()}.fail("is not a list: it is not text. Save arrays as .npy");
  const std::vector<std::string_view> lines = split_lines(without_byte_order_mark(text));
  const auto is_empty = [](std::string_view line) { return line.empty() || line.starts_with('#'); };
  const auto first = std::ranges::find_if_not(lines, is_empty);
  std::vector<CsvRow> rows;
  if (first != lines.end() && first->find_first_of(",;\t\"") != std::string_view::npos) {
    rows = parse_csv(text, path.string());
    std::erase_if(rows, [&](const CsvRow& row) {  // in quotes, # begins a name
      return row.fields[0].starts_with('#') && !lines[row.line - 1].starts_with('"');
    });
    return rows;
  }
  for (size_t i = 0; i < lines.size(); ++i) {
    const std::vector<std::string_view> words = split_words(lines[i]);
    if (!is_empty(lines[i]) && !words.empty())
      rows.push_back({i + 1, {words.begin(), words.end()}});
  }
  return rows;
}

std::string with_header(std::string text) {
  size_t comment = std::string::npos;
  for (const std::string_view line : split_lines(without_byte_order_mark(text))) {
    if (line.starts_with('#')) {
      comment = static_cast<size_t>(line.data() - text.data());
    } else if (const auto cells = cells_of(line); !cells.empty() && !names_separator(line)) {
      if (comment != std::string::npos && parse_real(cells.front())) text[comment] = ' ';
      break;
    }
  }
  return text;
}

std::vector<std::string> header_names(std::string_view line) {
  try {
    std::vector<CsvRow> rows = parse_csv(line, "");
    if (rows.size() != 1) return {};
    for (std::string& name : rows[0].fields) name = lower_case(name);
    return std::move(rows[0].fields);
  } catch (const Error&) {  // it is not a CSV
    return {};
  }
}

bool has_columns(std::string_view first_line, const std::vector<std::string_view>& columns) {
  const std::vector<std::string> names = header_names(first_line);
  return std::ranges::all_of(columns, [&](std::string_view column) {
    return std::ranges::find(names, column) != names.end();
  });
}

NamedRows::NamedRows(const std::filesystem::path& path, const std::string& name,
                     const std::vector<std::string>& needed)
    : location_{name} {
  rows_ = parse_csv(with_header(read_whole_file(path)), location_.file);
  if (rows_.empty()) rows_.emplace_back();  // a file without a header
  for (std::string& column : rows_[0].fields) column = lower_case(column);
  for (const std::string& column : header())
    if (!column.empty() && std::ranges::count(header(), column) > 1)
      fail("its header has two columns {}; remove or rename one", column);
  for (const std::string& column : needed)
    if (!has(column)) fail("its header has no column {}", column);
}

bool NamedRows::next() {
  if (next_ == rows_.size()) {
    next_ = 1;
    return false;
  }
  row_ = &rows_[next_++];
  location_.at("line", row_->line);
  if (row_->fields.size() != rows_[0].fields.size())
    fail("expected {} columns, found {}", rows_[0].fields.size(), row_->fields.size());
  return true;
}

bool NamedRows::has(std::string_view column) const {
  return std::ranges::find(header(), column) != header().end();
}

const std::string& NamedRows::text(std::string_view column) const {
  static const std::string kNone;
  const auto found = std::ranges::find(header(), column);
  return found == header().end() ? kNone : row_->fields[found - header().begin()];
}

double NamedRows::real(std::string_view column) const {
  const auto value = parse_real(text(column));
  if (!value) fail("\"{}\" is not a number", text(column));
  return *value;
}

size_t NamedRows::frame(std::string_view column) const {
  const auto number = parse_frame(text(column));
  if (!number || !number->in_range || number->value > kMaxGrownFrames)
    fail("{} \"{}\" is not a frame number{}", column, text(column), no_number_hint(text(column)));
  return number->value;
}

void NamedRows::allow(const std::vector<std::string>& columns) const {
  for (const std::string& name : header())
    if (std::ranges::find(columns, name) == columns.end())
      throw Error(ErrorKind::data,
                  "{}: has an unknown column \"{}\". Known columns are {}; remove or rename it",
                  location_.file, name, fmt::join(columns, ", "));
}

}  // namespace vpr
