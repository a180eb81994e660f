#include "ground_truth/named_rows.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "ground_truth/numbers.h"

namespace vpr {
namespace {

std::optional<size_t> find_column(const std::vector<std::string>& header, std::string_view name) {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end()) return std::nullopt;
  return static_cast<size_t>(found - header.begin());
}

}  // namespace

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
  return find_column(rows_[0].fields, column).has_value();
}

const std::string& NamedRows::text(std::string_view column) const {
  static const std::string kNone;
  const auto found = find_column(rows_[0].fields, column);
  return found ? row_->fields[*found] : kNone;
}

double NamedRows::real(std::string_view column) const {
  const auto value = parse_real(text(column));
  if (!value) fail(fmt::format("\"{}\" is not a number", text(column)));
  return *value;
}

}  // namespace vpr
