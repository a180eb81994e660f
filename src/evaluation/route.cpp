#include "evaluation/route.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "evaluation/csv.h"
#include "evaluation/ground_truth/file_location.h"
#include "evaluation/ground_truth/numbers.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostFrames = 10'000'000;

std::optional<size_t> find_column(const std::vector<std::string>& header, std::string_view name) {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end()) return std::nullopt;
  return static_cast<size_t>(found - header.begin());
}

/// Rows of a CSV file, by the names of its columns.
class NamedRows {
 public:
  NamedRows(const fs::path& path, const std::vector<std::string>& needed)
      : file_(path), location_{path.string()} {
    rows_ = parse_csv(file_.text(), location_.file);
    for (const std::string& name : needed)
      if (rows_.empty() || !find_column(rows_[0].fields, name))
        location_.fail(fmt::format("its header has no column {}", name));
  }

  size_t size() const { return rows_.size() - 1; }
  void go_to(size_t row) {
    row_ = &rows_[row + 1];
    location_.at("line", row_->line);
    if (row_->fields.size() != rows_[0].fields.size())
      location_.fail(fmt::format("expected {} columns, found {}", rows_[0].fields.size(),
                                 row_->fields.size()));
  }
  /// Of the present row; empty without such a column.
  std::string text(std::string_view name) const {
    const auto column = find_column(rows_[0].fields, name);
    return column ? row_->fields[*column] : std::string();
  }
  double real(std::string_view name) const {
    const auto value = parse_real(text(name));
    if (!value || !std::isfinite(*value))
      location_.fail(fmt::format("\"{}\" is not a number", text(name)));
    return *value;
  }
  const FileLocation& location() const { return location_; }

 private:
  MappedFile file_;
  FileLocation location_;
  std::vector<CsvRow> rows_;
  const CsvRow* row_ = nullptr;
};

}  // namespace

std::optional<PoseColumns> find_pose_columns(const std::vector<std::string>& header) {
  const auto frame = find_column(header, "frame"), x = find_column(header, "x"),
             y = find_column(header, "y");
  if (!frame || !x || !y) return std::nullopt;
  return PoseColumns{*frame, *x, *y, find_column(header, "heading"), find_column(header, "floor")};
}

std::vector<std::optional<RoutePoint>> read_route(const fs::path& path) {
  NamedRows rows(path, {"frame", "x", "y"});
  std::vector<std::optional<RoutePoint>> route;
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    const auto frame = parse_frame(rows.text("frame"));
    if (!frame || !frame->in_range || frame->value >= kMostFrames)
      rows.location().fail(fmt::format("\"{}\" is not a frame number", rows.text("frame")));
    if (frame->value >= route.size()) route.resize(frame->value + 1);
    route[frame->value] = RoutePoint{rows.real("x"), rows.real("y"), rows.text("floor")};
  }
  return route;
}

std::vector<RoutePoint> read_place_positions(const fs::path& path) {
  NamedRows rows(path, {"place", "x", "y"});
  std::vector<RoutePoint> places;
  std::set<std::string> seen;
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    if (seen.insert(rows.text("place")).second)
      places.push_back({rows.real("x"), rows.real("y"), rows.text("floor")});
  }
  return places;
}

std::vector<WallLine> read_walls(const fs::path& path) {
  NamedRows rows(path, {"x0", "y0", "x1", "y1"});
  std::vector<WallLine> walls;
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    const std::string floor = rows.text("floor");
    walls.push_back(
        {{rows.real("x0"), rows.real("y0"), floor}, {rows.real("x1"), rows.real("y1"), floor}});
  }
  return walls;
}

}  // namespace vpr
