#include "truth/text_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"

namespace vpr {

void FileLocation::fail(std::string_view what) const {
  const std::string position = unit.empty() ? "" : fmt::format(", {} {}", unit, number);
  throw Error(ErrorKind::data, fmt::format("{}{}: {}", file, position, what));
}

std::optional<FrameText> parse_frame(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos)
    return std::nullopt;
  FrameText frame;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), frame.value);
  frame.in_range = error == std::errc{} && (!negative || frame.value == 0);
  return frame;
}

std::optional<double> parse_real(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
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

std::vector<std::string> header_names(std::string_view line) {
  std::vector<std::string> names;
  for (std::string_view name : split(line, ',')) {
    while (name.ends_with('\r')) name.remove_suffix(1);
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"')
      name = name.substr(1, name.size() - 2);
    names.emplace_back(name);
  }
  return names;
}

NamedRows::NamedRows(const std::filesystem::path& path, const std::string& name,
                     const std::vector<std::string>& needed)
    : file_(path), location_{name} {
  rows_ = parse_csv(file_.text(), location_.file);
  if (rows_.empty()) rows_.emplace_back();  // a file without a header
  for (const std::string& column : needed)
    if (!has(column)) fail(fmt::format("its header has no column {}", column));
}

void NamedRows::go_to(size_t row) {
  row_ = &rows_[row + 1];
  location_.at("line", row_->line);
  if (row_->fields.size() != rows_[0].fields.size())
    fail(fmt::format("expected {} columns, found {}", rows_[0].fields.size(), row_->fields.size()));
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
  if (!value) fail(fmt::format("\"{}\" is not a number", text(column)));
  return *value;
}

}  // namespace vpr
