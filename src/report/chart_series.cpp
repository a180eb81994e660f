#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/chart_drawing.h"
#include "report/svg_text.h"

namespace vpr {
namespace {

// How a mark is a stroked path from its middle, and how wide the stroke is.
struct MarkShape {
  std::string_view path;
  double stroke;
  std::string_view cap;
};

MarkShape shape_of(SeriesMark mark) {
  constexpr std::string_view kSpot = "h0";
  switch (mark) {
    case SeriesMark::dot:
      return {kSpot, 4.5, "round"};
    case SeriesMark::square:
      return {"m-4 0h8", 8, "butt"};
    case SeriesMark::cross:
      return {"m-3.5 -3.5l7 7m0 -7l-7 7", 2, "butt"};
    case SeriesMark::circle:
      return {"m-2.5 0a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0", 1.5, "butt"};
    case SeriesMark::disc:
    case SeriesMark::none:
      break;
  }
  return {kSpot, 6.5, "round"};
}

std::string stroked(const std::string& kind, double width, std::string_view cap,
                    const std::string& path) {
  if (path.empty()) return "";
  return fmt::format(
      "<path class=\"line {}\" style=\"stroke-width:{:g};stroke-linecap:{}\" d=\"{}\"/>\n", kind,
      width, cap, path);
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

std::string mark_path(const Drawing& drawing, const Series& series, std::string_view shape) {
  SpotSet spots;
  std::string path;
  for (const auto& [x, y] : series.points) {
    if (std::isnan(x) || !spots.add(drawing.at.x(x), drawing.at.y(y))) continue;
    path += fmt::format("M{:.1f} {:.1f}{}", drawing.at.x(x), drawing.at.y(y), shape);
  }
  return path;
}

std::string box_path(const Drawing& drawing, const Series& series) {
  SpotSet spots;
  std::string path;
  for (size_t i = 0; i + 1 < series.points.size(); i += 2) {
    const double left = drawing.at.x(series.points[i].first);
    const double bottom = drawing.at.y(series.points[i].second);
    const double width = std::max(1.0, drawing.at.x(series.points[i + 1].first) - left);
    const double height = std::max(2.0, bottom - drawing.at.y(series.points[i + 1].second));
    if (spots.add(left, bottom))
      path += fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h-{:.1f}z", left, bottom - height, width,
                          height, width);
  }
  return path;
}

std::string series_kind(const Series& series, size_t index) {
  return series.meaning ? std::string(colour_of(*series.meaning).name)
                        : fmt::format("series-{}", index % series_colours().size());
}

// `path` of the marks of a series, in the layout or in a legend.
std::string marks_svg(const std::string& kind, SeriesMark mark, const std::string& path) {
  const MarkShape shape = shape_of(mark);
  return mark == SeriesMark::none ? "" : stroked(kind, shape.stroke, shape.cap, path);
}

}  // namespace

std::string series_svg(const Drawing& drawing, size_t index) {
  const Series& series = drawing.chart.series[index];
  const std::string kind = series_kind(series, index);
  const auto marks = [&](SeriesMark mark) {
    return marks_svg(kind, mark, mark_path(drawing, series, shape_of(mark).path));
  };
  switch (series.style) {
    case SeriesStyle::line:
      return stroked(kind, 2.2, "butt", line_path(drawing, series));
    case SeriesStyle::wide_line:
      return stroked(kind, 7, "round", line_path(drawing, series));
    case SeriesStyle::line_and_points:
      return stroked(kind, 2, "butt", line_path(drawing, series)) + marks(SeriesMark::disc);
    case SeriesStyle::bar:
      return stroked(kind, 2.5, "butt", line_path(drawing, series)) +
             stroked(kind, 2.5, "butt", mark_path(drawing, series, "m0 -4v8"));
    case SeriesStyle::boxes: {
      const std::string path = box_path(drawing, series);
      return path.empty() ? "" : fmt::format("<path class=\"{}\" d=\"{}\"/>\n", kind, path);
    }
    case SeriesStyle::points:
      break;
  }
  return marks(series.mark);
}

std::string labels_svg(const Drawing& drawing) {
  std::vector<ChartArea> taken;
  std::string svg;
  for (const Series& series : drawing.chart.series)
    for (size_t i = 0; i < series.labels.size(); ++i) {
      const std::string& label = series.labels[i];
      if (label.empty()) continue;
      const bool is_inside = series.mark == SeriesMark::none;
      const double x = drawing.at.x(series.points[i].first) + (is_inside ? 0 : 7);
      const double y = drawing.at.y(series.points[i].second) + (is_inside ? 4 : -7);
      const double width = text_width(label, 11);
      const bool is_covered = std::any_of(taken.begin(), taken.end(), [&](const ChartArea& other) {
        return x < other.right() + 4 && other.left < x + width + 4 && std::abs(y - other.top) < 13;
      });
      if (is_covered) continue;
      taken.push_back({x, y, width, 13});
      const bool is_left = !is_inside && x + width > drawing.at.width;
      svg += svg_text(is_left ? x - 14 : x, y,
                      is_inside ? "middle"
                      : is_left ? "end"
                                : "start",
                      label, is_inside ? "name" : "label");
    }
  return svg;
}

std::string legend_svg(const Drawing& drawing) {
  std::string svg;
  for (const LegendEntry& entry : drawing.at.legend) {
    const Series& series = drawing.chart.series[entry.series];
    const std::string kind = series_kind(series, entry.series);
    const double y = entry.y - 4.5;
    const std::string line = fmt::format("M{:.1f} {:.1f}h22", entry.x, y);
    const MarkShape shape = shape_of(series.mark);
    const std::string mark = fmt::format("M{:.1f} {:.1f}{}", entry.x + 11, y, shape.path);
    if (series.style == SeriesStyle::boxes)
      svg += svg_rect(kind, entry.x + 5, y - 6, 12, 12);
    else if (series.style == SeriesStyle::points)
      svg += marks_svg(kind, series.mark, mark);
    else
      svg += stroked(kind, series.style == SeriesStyle::wide_line ? 7 : 2.2, "butt", line);
    if (series.style == SeriesStyle::line_and_points) svg += marks_svg(kind, series.mark, mark);
    svg += svg_text(entry.x + 28, entry.y, "start", series.name);
  }
  return svg;
}

}  // namespace vpr
