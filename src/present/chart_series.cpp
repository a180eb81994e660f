#include "present/chart_series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "base/text.h"

namespace vpr {
namespace {

// A mark as a stroked path from its center.
struct MarkShape {
  std::string_view path;
  double stroke;
  std::string_view cap;
};

constexpr std::array<MarkShape, 6> kShapes = {  // by SeriesMark
    {{"h0", 6.5, "round"},
     {"h0", 4.5, "round"},
     {"m-4 0h8", 8, "butt"},
     {"m-3.5 -3.5l7 7m0 -7l-7 7", 2, "butt"},
     {"m-2.5 0a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0", 1.5, "butt"},
     {"m0 -4l4 7h-8z", 2, "butt"}}};

// By the index of a series without a meaning.
constexpr std::array<std::string_view, 5> kDashes = {"", "9 4", "2 3", "9 3 2 3", "14 4"};
constexpr std::array<SeriesMark, 5> kMarks = {SeriesMark::disc, SeriesMark::square,
                                              SeriesMark::triangle, SeriesMark::cross,
                                              SeriesMark::circle};

SeriesMark mark_of(const Series& series, size_t index) {
  if (series.mark != SeriesMark::automatic) return series.mark;
  return series.meaning ? SeriesMark::disc
                        : kMarks[(index + index / kMarks.size()) % kMarks.size()];
}

std::string stroked(const std::string& kind, double width, std::string_view cap,
                    const std::string& path, std::string_view dashes = "") {
  if (path.empty()) return "";
  return fmt::format(
      "<path class=\"line {}\" style=\"stroke-width:{:g};stroke-linecap:{}{}\" d=\"{}\"/>\n", kind,
      width, cap, dashes.empty() ? "" : fmt::format(";stroke-dasharray:{}", dashes), path);
}

std::string line_path(const Drawing& drawing, const Series& series) {
  std::string path;
  bool is_begun = false;
  for (const auto& [x, y] : series.points) {
    if (std::isnan(x)) {
      is_begun = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", is_begun ? "L" : "M", drawing.at.x(x), drawing.at.y(y));
    is_begun = true;
  }
  return path;
}

// Occupied squares of one unit: marks and boxes in the same square are drawn once.
using Spots = std::set<std::pair<long, long>>;

bool is_new(Spots& spots, double x, double y) {
  return spots.insert({std::lround(x), std::lround(y)}).second;
}

std::string mark_path(const Drawing& drawing, const Series& series, std::string_view shape) {
  Spots spots;
  std::string path;
  for (const auto& [x, y] : series.points) {
    if (std::isnan(x) || !is_new(spots, drawing.at.x(x), drawing.at.y(y))) continue;
    path += fmt::format("M{:.1f} {:.1f}{}", drawing.at.x(x), drawing.at.y(y), shape);
  }
  return path;
}

std::string box_path(const Drawing& drawing, const Series& series) {
  Spots spots;
  std::string path;
  for (size_t i = 0; i + 1 < series.points.size(); i += 2) {
    const double left = drawing.at.x(series.points[i].first);
    const auto [top, bottom] = std::minmax(
        {drawing.at.y(series.points[i].second), drawing.at.y(series.points[i + 1].second)});
    const double width = std::max(1.6, drawing.at.x(series.points[i + 1].first) - left);
    const double height = std::max(2.0, bottom - top);
    if (is_new(spots, left, bottom))
      path += fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h-{:.1f}z", left, bottom - height, width,
                          height, width);
  }
  return path;
}

// The sides of all boxes and, between rows, the parts of their borders that belong to one row.
std::string outline_path(const Drawing& drawing, const Series& series) {
  std::string path;
  std::map<double, std::vector<double>> borders;  // by y: the ends of both rows' boxes
  for (size_t i = 0; i + 1 < series.points.size(); i += 2) {
    const double y = drawing.at.y(series.points[i].second);
    const double end = drawing.at.y(series.points[i + 1].second);
    for (const size_t side : {i, i + 1}) {
      const double x = drawing.at.x(series.points[side].first);
      path += fmt::format("M{:.1f} {:.1f}V{:.1f}", x, y, end);
      borders[y].push_back(x);
      borders[end].push_back(x);
    }
  }
  for (auto& [y, ends] : borders) {
    std::ranges::sort(ends);
    for (size_t i = 0; i + 1 < ends.size(); i += 2)
      if (ends[i] < ends[i + 1])
        path += fmt::format("M{:.1f} {:.1f}H{:.1f}", ends[i], y, ends[i + 1]);
  }
  return path;
}

std::string series_kind(const Series& series, size_t index) {
  return series.meaning ? std::string(color_of(*series.meaning).name)
                        : fmt::format("series-{}", index % series_colors().size());
}

std::string_view dashes_of(const Series& series, size_t index) {
  if (series.meaning == Meaning::all_pairs) return kDashes[2];
  if (series.meaning == Meaning::by_margin) return kDashes[1];
  return series.meaning ? "" : kDashes[index % kDashes.size()];
}

}  // namespace

std::string svg_text(double x, double y, const std::string& anchor, const std::string& text,
                     const std::string& kind) {
  if (text.empty()) return "";
  return fmt::format("<text{} x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n",
                     kind.empty() ? "" : " class=\"" + kind + "\"", x, y, anchor,
                     html_escaped(text));
}

std::string svg_rect(const std::string& kind, double x, double y, double width, double height) {
  return fmt::format(
      "<rect class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n", kind,
      x, y, width, height);
}

std::string series_svg(const Drawing& drawing, size_t index) {
  const Series& series = drawing.chart.series[index];
  const std::string kind = series_kind(series, index);
  const std::string_view dashes = dashes_of(series, index);
  const SeriesMark mark = mark_of(series, index);
  const auto marks = [&](const Series& marked) {
    if (mark == SeriesMark::none) return std::string();
    const MarkShape& shape = kShapes[static_cast<size_t>(mark)];
    return stroked(kind, shape.stroke, shape.cap, mark_path(drawing, marked, shape.path));
  };
  switch (series.style) {
    case SeriesStyle::line: {
      Series end = series;  // dashes repeat, but not with the same mark
      if (series.meaning) end.points.clear();
      if (end.points.size() > 1) end.points = {end.points.back()};
      return stroked(kind, 2.2, "butt", line_path(drawing, series), dashes) + marks(end);
    }
    case SeriesStyle::wide_line:
      return stroked(kind, 7, "round", line_path(drawing, series));
    case SeriesStyle::line_and_points:
      return stroked(kind, 2, "butt", line_path(drawing, series), dashes) + marks(series);
    case SeriesStyle::outline:
      return stroked(kind, 1.5, "square;shape-rendering:crispEdges", outline_path(drawing, series));
    case SeriesStyle::boxes: {
      const std::string path = box_path(drawing, series);
      return path.empty() ? "" : fmt::format("<path class=\"{}\" d=\"{}\"/>\n", kind, path);
    }
    case SeriesStyle::points:
      break;
  }
  return marks(series);
}

std::string sample_svg(const Series& series, size_t index, double x, double y) {
  Chart chart;
  chart.series.resize(index + 1);
  Series& sample = chart.series.back() = series;
  if (series.style == SeriesStyle::boxes || series.style == SeriesStyle::outline)
    sample.points = {{x + 5, y - 6}, {x + 17, y + 6}};
  else if (series.style == SeriesStyle::points)
    sample.points = {{x + 11, y}};
  else
    sample.points = {{x + 2, y}, {x + 18, y}};
  return series_svg({chart, {}}, index);  // the default layout has units of the SVG
}

std::string labels_svg(const Drawing& drawing) {
  std::vector<ChartArea> taken;
  const auto covers = [](const ChartArea& a, const ChartArea& b) {
    return a.left < b.right() + 4 && b.left < a.right() + 4 && a.top < b.bottom() &&
           b.top < a.bottom();
  };
  const auto is_free = [&](const ChartArea& box) {
    return std::ranges::none_of(taken, [&](const auto& other) { return covers(box, other); });
  };
  const auto has_point = [&](const ChartArea& box) {
    return std::ranges::any_of(drawing.chart.series, [&](const Series& series) {
      return std::ranges::any_of(series.points, [&](const auto& point) {
        return covers(box, {drawing.at.x(point.first) - 3, drawing.at.y(point.second) - 3, 6, 6});
      });
    });
  };
  const auto is_in_plot = [&](const ChartArea& box) {
    const ChartArea& area = drawing.at.area;
    return box.left >= area.left && box.right() <= drawing.at.width &&
           box.bottom() <= area.bottom();
  };
  std::string svg;
  for (const Series& series : drawing.chart.series)
    for (size_t i = 0; i < series.labels.size(); ++i) {
      const std::string& label = series.labels[i];
      if (label.empty()) continue;
      const double x = drawing.at.x(series.points[i].first);
      const double y = drawing.at.y(series.points[i].second);
      const double width = text_width(label, 11);
      const double left = x - 8 - width;
      std::vector<std::pair<double, double>> corners = {
          {x + 8, y - 20}, {x + 8, y + 7}, {left, y - 20}, {left, y + 7}};
      const bool is_inside = series.mark == SeriesMark::none;
      if (is_inside) corners = {{x - width / 2, y - 7}};
      for (const auto& corner : corners) {
        const ChartArea box{corner.first, corner.second, width, 13};
        if (!is_free(box) || (!is_inside && (has_point(box) || !is_in_plot(box)))) continue;
        taken.push_back(box);
        svg += is_inside ? svg_text(x, y + 4, "middle", label, "name")
                         : svg_text(box.left, box.top + 11, "start", label, "label");
        break;
      }
    }
  return svg;
}

}  // namespace vpr
