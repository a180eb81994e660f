#include "present/chart.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/output.h"
#include "present/html_page.h"

namespace vpr {
namespace {

// Pixels per unit of the SVG, for charts without an image.
constexpr double kZoom = 4.0 / 3;

constexpr int kLeastImage = 600;  // minimum of the longer side of an image, in pixels
constexpr int kLeastSide = 150;   // minimum of the shorter side

struct Drawing {
  const Chart& chart;
  ChartLayout at;
};

// The baseline of the text is at y; anchor is "start", "middle" or "end".
std::string svg_text(double x, double y, const std::string& anchor, const std::string& text,
                     const std::string& kind = "") {
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

constexpr double kBarHeight = 16;
constexpr double kBarGap = 10;  // between the plot and the bar

// With an image, ticks are short marks outside it, else lines across the plot.
std::string ticks_and_labels_svg(const Drawing& drawing) {
  const auto& [chart, at] = drawing;
  const ChartArea& area = at.area;
  const double below = area.bottom() + (chart.runs.empty() ? 0 : kBarGap + kBarHeight);
  std::string svg;
  for (const ChartTick& tick : at.x_ticks) {
    const double x = at.x(tick.at);
    svg += chart.image
               ? fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}v5\"/>", x, area.bottom())
               : fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", x, area.top,
                             area.bottom());
    svg += svg_text(x, below + 18, "middle", tick.text);
  }
  for (const ChartTick& tick : at.y_ticks) {
    const double y = at.y(tick.at);
    svg += chart.image ? fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}h-5\"/>", area.left, y)
                       : fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>",
                                     area.left, y, area.right());
    svg += svg_text(area.left - 8, y + 4.5, "end", tick.text);
  }
  return svg + svg_text(area.left + area.width / 2, below + 40, "middle", chart.x.label) +
         svg_text(area.left, area.top - 10 - at.names_height, "start", chart.y.label);
}

// Names of the y axis's bands are inside the plot, if there is room, names of the x axis's above.
std::string bands_svg(const Drawing& drawing) {
  const ChartArea& area = drawing.at.area;
  std::string svg;
  double named = 1e9;
  for (size_t i = 0; i < drawing.chart.y.bands.size(); ++i) {
    const ChartBand& band = drawing.chart.y.bands[i];
    const double y = drawing.at.y(band.begin);
    if (i > 0)
      svg += fmt::format("<path class=\"border\" d=\"M{:.1f} {:.1f}h{:.1f}\"/>", area.left, y,
                         area.width);
    if (named - y < 18) continue;
    svg += svg_text(area.left + 6, y - 6, "start", band.name, "name");
    named = y;
  }
  named = -1e9;
  for (size_t i = 0; i < drawing.chart.x.bands.size(); ++i) {
    const ChartBand& band = drawing.chart.x.bands[i];
    const double x = drawing.at.x(band.begin);
    if (i > 0)
      svg += fmt::format("<path class=\"border\" d=\"M{:.1f} {:.1f}v{:.1f}\"/>", x, area.top,
                         area.height);
    if (x - named < 15) continue;
    named = x;
    svg += drawing.at.has_steep_names
               ? fmt::format("<g transform=\"translate({:.1f} {:.1f}) rotate(-30)\">{}</g>", x + 5,
                             area.top - 6, svg_text(0, 0, "start", band.name, "name"))
               : svg_text(x, area.top - 7, "start", band.name, "name");
  }
  return svg;
}

std::string runs_svg(const Drawing& drawing) {
  if (drawing.chart.runs.empty()) return "";
  const double top = drawing.at.area.bottom() + kBarGap;
  std::string svg;
  for (const ChartRun& run : drawing.chart.runs) {
    const double left = drawing.at.x(run.begin);
    svg += svg_rect(std::string(color_of(run.meaning).name), left, top,
                    std::max(0.6, drawing.at.x(run.end) - left), kBarHeight);
  }
  return svg + svg_text(drawing.at.area.left - 8, top + 13, "end", drawing.chart.runs_label);
}

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
     {"h0", 6.5, "round"}}};

const MarkShape& shape_of(SeriesMark mark) { return kShapes[static_cast<size_t>(mark)]; }

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
    const double bottom = drawing.at.y(series.points[i].second);
    const double width = std::max(1.0, drawing.at.x(series.points[i + 1].first) - left);
    const double height = std::max(2.0, bottom - drawing.at.y(series.points[i + 1].second));
    if (is_new(spots, left, bottom))
      path += fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h-{:.1f}z", left, bottom - height, width,
                          height, width);
  }
  return path;
}

std::string series_kind(const Series& series, size_t index) {
  return series.meaning ? std::string(color_of(*series.meaning).name)
                        : fmt::format("series-{}", index % series_colors().size());
}

std::string marks_svg(const std::string& kind, SeriesMark mark, const std::string& path) {
  const MarkShape& shape = shape_of(mark);
  return mark == SeriesMark::none ? "" : stroked(kind, shape.stroke, shape.cap, path);
}

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

// The labels of all points, except labels that would cover an earlier one.
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
    const MarkShape& shape = shape_of(series.mark);
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

// The nested element clips the image.
std::string image_svg(const Drawing& drawing) {
  const ChartImage& image = *drawing.chart.image;
  const ChartArea& area = drawing.at.area;
  return fmt::format(
             "<svg x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"><image x=\"0\" "
             "y=\"0\" width=\"{}\" height=\"{}\" "
             "style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/></svg>\n",
             area.left, area.top, area.width, area.height, image.width, image.height,
             base64(std::as_bytes(std::span(image.png)))) +
         svg_rect("frame", area.left, area.top, area.width, area.height);
}

std::string grays_svg(const Drawing& drawing) {
  const ChartImage& image = *drawing.chart.image;
  if (!image.grays) return "";
  const ChartArea& area = drawing.at.area;
  const double y = area.bottom() + 56;
  const double width = std::max(area.width, 400.0);
  return fmt::format(
             "<defs><linearGradient id=\"grays\"><stop stop-color=\"#000\"/><stop offset=\"1\" "
             "stop-color=\"#fff\"/></linearGradient></defs><rect class=\"grays\" "
             "fill=\"url(#grays)\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"12\"/>",
             area.left, y, width) +
         svg_text(area.left, y + 29, "start", fmt::format("{:.6g}", image.grays->first)) +
         svg_text(area.left + width / 2, y + 29, "middle", image.gray_label) +
         svg_text(area.left + width, y + 29, "end", fmt::format("{:.6g}", image.grays->second));
}

std::string body_of(const Drawing& drawing) {
  const Chart& chart = drawing.chart;
  std::string svg;
  if (chart.image) svg += image_svg(drawing);
  const auto is_behind = [](const Series& series) { return series.style == SeriesStyle::boxes; };
  for (size_t s = 0; s < chart.series.size(); ++s)
    if (is_behind(chart.series[s])) svg += series_svg(drawing, s);
  if (!chart.is_plan) svg += ticks_and_labels_svg(drawing) + bands_svg(drawing);
  for (size_t s = 0; s < chart.series.size(); ++s)
    if (!is_behind(chart.series[s])) svg += series_svg(drawing, s);
  svg += labels_svg(drawing) + runs_svg(drawing);
  if (chart.image) svg += grays_svg(drawing);
  return svg;
}

std::string title_svg(const Drawing& drawing) {
  const double room = drawing.at.width - 20;
  const double size =
      std::min(16.0, 16.0 * room / std::max(1.0, text_width(drawing.chart.title, 17)));
  return fmt::format(
      "<text class=\"title\" style=\"font-size:{:.1f}px\" x=\"{:.1f}\" y=\"24\" "
      "text-anchor=\"middle\">{}</text>\n",
      size, drawing.at.width / 2, html_escaped(drawing.chart.title));
}

// As in the page's style sheet, but without variables, which some SVG viewers do not support.
std::string file_style() {
  std::string css =
      "text{font-family:sans-serif;font-size:13px;fill:#1c2430}.title{font-weight:600}"
      ".label{font-size:11px}.name{font-weight:600}.label,.name{paint-order:stroke;stroke:#fff;"
      "stroke-width:3px;stroke-linejoin:round}.axis{stroke:#d5d9e0;fill:none}"
      ".border{fill:none}.frame,.grays{stroke:#5c6675}.frame{fill:none}\n";
  for (const PaletteColor& row : palette())
    css += fmt::format(".{0}{{fill:#{1:06x}}}.line.{0}{{stroke:#{1:06x}}}\n", row.name, row.light);
  for (size_t i = 0; i < series_colors().size(); ++i)
    css += fmt::format(".series-{0}{{fill:{1}}}.line.series-{0}{{stroke:{1}}}\n", i,
                       series_colors()[i]);
  return css + fmt::format(
                   "path.line{{fill:none}}.border{{stroke:{}}}.all-pairs{{"
                   "stroke-dasharray:6 4}}\n",
                   hex_of(Meaning::divider));
}

}  // namespace

Series series_of(Meaning meaning, SeriesStyle style, SeriesMark mark) {
  return {std::string(color_of(meaning).words), {}, style, meaning, mark};
}

void erase_empty_series(Chart& chart) {
  std::erase_if(chart.series, [](const Series& series) { return series.points.empty(); });
}

ChartImage chart_image(const cv::Mat& image, size_t cells) {
  const auto times = [&](int pixels) {
    const int longer = std::max(image.cols, image.rows);
    return std::max((kLeastImage + longer - 1) / longer, (kLeastSide + pixels - 1) / pixels);
  };
  cv::Mat large;
  cv::resize(image, large, {}, times(image.cols), times(image.rows), cv::INTER_NEAREST);
  return {png_of(large), static_cast<size_t>(large.cols), static_cast<size_t>(large.rows),
          static_cast<double>(cells) * image.cols, static_cast<double>(cells) * image.rows};
}

std::string page_svg(const Chart& chart) {
  const Drawing drawing{chart, layout_of(chart, true)};
  std::string svg = fmt::format(
      "<svg class=\"{}\"{} viewBox=\"0 0 {:g} {:g}\" role=\"img\" aria-label=\"{}\">\n", chart.file,
      chart.image ? fmt::format(" style=\"max-width:{:.0f}px\"", drawing.at.width) : "",
      drawing.at.width, std::ceil(drawing.at.height), html_escaped(chart.title));
  svg += body_of(drawing);
  if (!chart.runs_label.empty())
    svg += fmt::format(
        "<line id=\"here\" class=\"here\" x1=\"0\" x2=\"0\" y1=\"{:.1f}\" y2=\"{:.1f}\" "
        "visibility=\"hidden\"/>",
        drawing.at.area.top, drawing.at.area.bottom() + kBarGap + kBarHeight);
  return svg + "</svg>";
}

std::string svg_file(const std::vector<Chart>& charts, size_t columns) {
  assert(!charts.empty() && columns > 0);
  std::string body;
  double width = 0;
  double bottom = 0;
  double top = 0;  // of the row
  double left = 0;
  for (size_t i = 0; i < charts.size(); ++i) {
    if (i % columns == 0) {
      top = bottom;
      left = 0;
    }
    const Drawing drawing{charts[i], layout_of(charts[i], false)};
    body += fmt::format("<g transform=\"translate({:g} {:g})\">\n", left, top) +
            title_svg(drawing) + body_of(drawing) + legend_svg(drawing) + "</g>\n";
    left += drawing.at.width;
    width = std::max(width, left);
    bottom = std::max(bottom, top + drawing.at.height);
  }
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
             "viewBox=\"0 0 {0:.0f} {1:.0f}\">\n<style>{2}</style>\n<rect width=\"100%\" "
             "height=\"100%\" fill=\"#fff\"/>\n",
             std::ceil(width), std::ceil(bottom), file_style()) +
         body + "</svg>\n";
}

std::string chart_png(const std::vector<Chart>& charts, size_t columns) {
  return png_of_svg(svg_file(charts, columns), charts.front().image ? 1 : kZoom);
}

void draw_charts(const std::vector<Chart>& charts, size_t columns, const std::string& file,
                 const std::filesystem::path& folder) {
  write_part(folder / (file + ".svg"), svg_file(charts, columns));
  write_part(folder / (file + ".png"), chart_png(charts, columns));
}

void draw_chart(const Chart& chart, const std::filesystem::path& folder) {
  draw_charts({chart}, 1, chart.file, folder);
}

}  // namespace vpr
