#include "present/chart.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/output.h"
#include "base/text.h"
#include "present/chart_series.h"

namespace vpr {
namespace {

// Pixels per unit of the SVG, for charts without an image.
constexpr double kZoom = 4.0 / 3;

constexpr int kLeastImage = 600;  // minimum of the longer side of an image, in pixels
constexpr int kLeastSide = 150;   // minimum of the shorter side

constexpr double kPhone = 360;  // width of charts for phones, in units
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
    if (chart.y.has_text_inside) {
      svg += fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}h{:.1f}\"/>", area.left, y,
                         area.width) +
             svg_text(area.left, y - 5, "start", tick.text);
      continue;
    }
    svg += chart.image ? fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}h-5\"/>", area.left, y)
                       : fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>",
                                     area.left, y, area.right());
    svg += svg_text(area.left - 8, y + 4.5, "end", tick.text);
  }
  return svg + svg_text(area.left + area.width / 2, below + 40, "middle", chart.x.label) +
         svg_text(area.left, area.top - 10 - at.names_height, "start", chart.y.label);
}

// Names of the y axis's bands are right of the plot, names of the x axis's above.
std::string bands_svg(const Drawing& drawing) {
  const ChartArea& area = drawing.at.area;
  std::string svg;
  double named = 1e9;
  const auto& bands = drawing.chart.y.bands;
  for (size_t i = 0; i < bands.size(); ++i) {
    const ChartTick& band = bands[i];
    const double y = drawing.at.y(band.at);
    if (i > 0)
      svg += fmt::format("<path class=\"border\" d=\"M{:.1f} {:.1f}h{:.1f}\"/>", area.left, y,
                         area.width);
    const double end = i + 1 < bands.size() ? drawing.at.y(bands[i + 1].at) : area.top;
    const double middle = (y + end) / 2;
    if (named - middle < 16) continue;
    svg += svg_text(area.right() + 6, middle + 4.5, "start",
                    shortened(band.text, drawing.at.names_width), "name");
    named = middle;
  }
  named = -1e9;
  for (size_t i = 0; i < drawing.chart.x.bands.size(); ++i) {
    const ChartTick& band = drawing.chart.x.bands[i];
    const double x = drawing.at.x(band.at);
    if (i > 0)
      svg += fmt::format("<path class=\"border\" d=\"M{:.1f} {:.1f}v{:.1f}\"/>", x, area.top,
                         area.height);
    if (x - named < 15) continue;
    named = x;
    svg += drawing.at.has_steep_names
               ? fmt::format("<g transform=\"translate({:.1f} {:.1f}) rotate(-30)\">{}</g>", x + 5,
                             area.top - 6, svg_text(0, 0, "start", band.text, "name"))
               : svg_text(x, area.top - 7, "start", band.text, "name");
  }
  return svg;
}

std::string runs_svg(const Drawing& drawing) {
  if (drawing.chart.runs.empty()) return "";
  const double top = drawing.at.area.bottom() + kBarGap;
  std::string svg;
  for (const ChartStretch& run : drawing.chart.runs) {
    const double left = drawing.at.x(run.begin);
    svg += svg_rect(std::string(color_of(run.meaning).name), left, top,
                    std::max(0.6, drawing.at.x(run.end) - left), kBarHeight);
  }
  return svg;
}

std::string legend_svg(const Drawing& drawing) {
  std::string svg;
  for (const LegendEntry& entry : drawing.at.legend) {
    const Series& series = drawing.chart.series[entry.series];
    svg += sample_svg(series, entry.series, entry.x, entry.y - 4.5) +
           svg_text(entry.x + 28, entry.y, "start", series.name);
  }
  return svg;
}

// The nested element cuts pixels outside the ranges. `uses_other`: draws the image of a page's
// first SVG with this chart again.
std::string image_svg(const Drawing& drawing, bool uses_other) {
  const Chart& chart = drawing.chart;
  const ChartImage& image = *chart.image;
  const ChartArea& area = drawing.at.area;
  const auto pixels = [](const ChartAxis& axis, size_t size, double units) {
    return static_cast<double>(size) / units * std::abs(axis.range->second - axis.range->first);
  };
  const std::string content =
      uses_other ? "<use href=\"#pixels\"/>"
                 : fmt::format(
                       "<image id=\"pixels\" width=\"{}\" height=\"{}\" "
                       "style=\"image-rendering:pixelated\" "
                       "href=\"data:image/png;base64,{}\"/>",
                       image.width, image.height, base64(std::as_bytes(std::span(image.png))));
  return svg_rect("no-score", area.left, area.top, area.width, area.height) +
         fmt::format(
             "<g class=\"pixels\"><svg x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
             "height=\"{:.1f}\" "
             "viewBox=\"0 0 {:g} {:g}\" preserveAspectRatio=\"none\">{}</svg></g>\n",
             area.left, area.top, area.width, area.height,
             pixels(chart.x, image.width, image.columns), pixels(chart.y, image.height, image.rows),
             content) +
         svg_rect("frame", area.left, area.top, area.width, area.height);
}

std::string grays_svg(const Drawing& drawing, bool for_page, std::string_view id) {
  const ChartImage& image = *drawing.chart.image;
  if (!image.grays) return "";
  const ChartArea& area = drawing.at.area;
  const double y = area.bottom() + 56;
  const double width = std::max(area.width, std::min(400.0, drawing.at.width - area.left - 24));
  std::string svg = fmt::format(
      "<defs><linearGradient id=\"{0}\"><stop stop-color=\"#000\"/><stop offset=\"1\" "
      "stop-color=\"#fff\"/></linearGradient></defs><rect class=\"grays\" fill=\"url(#{0})\" "
      "x=\"{1:.1f}\" y=\"{2:.1f}\" width=\"{3:.1f}\" height=\"12\"/>",
      id, area.left, y, width);
  svg += svg_text(area.left, y + 28, "start", fmt::format("{:.4g}", image.grays->first)) +
         svg_text(area.left + width, y + 28, "end", fmt::format("{:.4g}", image.grays->second));
  return for_page ? svg : svg + svg_text(area.left, y + 46, "start", image.gray_label);
}

// The nested element cuts what limits of the axes exclude.
std::string cut_series_svg(const Drawing& drawing, size_t series) {
  const auto is_outside = [&](const auto& point) {
    const auto exceeds = [](const AxisScale& axis, double value) {
      return value < std::min(axis.from, axis.to) || value > std::max(axis.from, axis.to);
    };
    return exceeds(drawing.at.x, point.first) || exceeds(drawing.at.y, point.second);
  };
  const std::string svg = series_svg(drawing, series);
  if (std::ranges::none_of(drawing.chart.series[series].points, is_outside)) return svg;
  const ChartArea& area = drawing.at.area;
  return fmt::format(
      "<svg x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" viewBox=\"{0:.1f} "
      "{1:.1f} {2:.1f} {3:.1f}\">{4}</svg>\n",
      area.left, area.top, area.width, area.height, svg);
}

std::string body_of(const Drawing& drawing, bool for_page = false, bool uses_other = false) {
  const Chart& chart = drawing.chart;
  std::string svg;
  if (chart.image) svg += image_svg(drawing, uses_other);
  if (!chart.is_plan) svg += ticks_and_labels_svg(drawing) + bands_svg(drawing);
  for (const bool behind : {true, false})
    for (size_t s = 0; s < chart.series.size(); ++s)
      if ((chart.series[s].style == SeriesStyle::boxes) == behind)
        svg += cut_series_svg(drawing, s);
  svg += labels_svg(drawing) + runs_svg(drawing);
  if (chart.image) svg += grays_svg(drawing, for_page, uses_other ? "grays-again" : "grays");
  return svg;
}

std::string title_svg(const Drawing& drawing) {
  if (drawing.chart.title.empty()) return "";
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
      ".border{fill:none}.frame,.grays{stroke:#5c6675}.frame{fill:none}.no-score{fill:#d7e1eb}\n";
  for (const PaletteColor& row : palette())
    css += fmt::format(".{0}{{fill:#{1:06x}}}.line.{0}{{stroke:#{1:06x}}}\n", row.name, row.light);
  for (size_t i = 0; i < series_colors().size(); ++i)
    css += fmt::format(".series-{0}{{fill:{1}}}.line.series-{0}{{stroke:{1}}}\n", i,
                       series_colors()[i]);
  return css + fmt::format("path.line{{fill:none}}.border{{stroke:#{:06x}}}\n",
                           color_of(Meaning::divider).light);
}

std::string page_svg(const Chart& chart, std::string_view screen) {
  const Drawing drawing{chart, layout_of(chart, true)};
  const ChartLayout& at = drawing.at;
  const auto scale = [](const AxisScale& axis) {
    return fmt::format("{} {} {:.1f} {:.1f}", axis.from, axis.to, axis.begin, axis.end);
  };
  std::string svg = fmt::format(
      "<svg class=\"{} {}\" style=\"max-width:{:.0f}px\" viewBox=\"0 0 {:g} {:g}\" data-x=\"{}\" "
      "data-y=\"{}\" role=\"img\" aria-label=\"{}\">\n",
      chart.file, screen, at.width * 1.2, at.width, std::ceil(at.height), scale(at.x), scale(at.y),
      html_escaped(chart.title));
  svg += body_of(drawing, true, screen == "narrow");
  if (chart.has_cursor)
    svg += fmt::format(
        "<line class=\"here\" x1=\"0\" x2=\"0\" y1=\"{:.1f}\" y2=\"{:.1f}\" "
        "visibility=\"hidden\"/>",
        at.area.top, at.area.bottom() + (chart.runs.empty() ? 0 : kBarGap + kBarHeight));
  return svg + "</svg>";
}

}  // namespace

Series series_of(Meaning meaning, SeriesStyle style, SeriesMark mark) {
  return {std::string(color_of(meaning).words), {}, style, meaning, mark};
}

Chart in_figure(Chart chart, const FigureSettings& figure) {
  constexpr double kPixelsPerMm = 96 / 25.4;
  constexpr double kLeastWidth = 480;  // in units, for axes, legend and curves
  constexpr double kLeastHeight = 340;
  if (const auto& at = figure.limits; !at.empty() && chart.file.starts_with(kPrecisionRecall)) {
    chart.x.range = {at[0], at[1]};
    chart.y.range = {at[2], at[3]};
  }
  if (!figure.size_mm) return chart;
  chart.title.clear();
  const double width = figure.size_mm->first * kPixelsPerMm;
  const double height = figure.size_mm->second * kPixelsPerMm;
  if (chart.image) {
    chart.scale = width / layout_of(chart, false).width;
    return chart;
  }
  const double enlarged = std::max({1.0, kLeastWidth / width, kLeastHeight / height});
  chart.width = std::round(width * enlarged);
  if (!chart.y.has_text_inside) chart.height = std::round(height * enlarged);
  chart.scale = width / chart.width;
  return chart;
}

void erase_empty_series(Chart& chart) {
  std::erase_if(chart.series, [](const Series& series) { return series.points.empty(); });
}

void name_borders(Chart& chart) {
  if (chart.x.bands.size() > 1 || chart.y.bands.size() > 1)
    chart.series.push_back(series_of(Meaning::divider, SeriesStyle::line));
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
  if (chart.width <= kPhone) return page_svg(chart, "any");
  Chart narrow = chart;
  narrow.width = kPhone;
  if (!chart.y.has_text_inside) narrow.height = std::min(chart.height, 320.0);
  return page_svg(chart, "wide") + page_svg(narrow, "narrow");
}

std::string legend_html(const Chart& chart) {
  std::string html;
  const auto add = [&](const Series& series, size_t index) {
    html += "<span class=\"entry\"><svg class=\"key\" viewBox=\"0 0 22 14\">" +
            sample_svg(series, index, 0, 7) + "</svg>" + html_escaped(series.name) + "</span> ";
  };
  for (size_t s = 0; s < chart.series.size(); ++s)
    if (!chart.series[s].name.empty()) add(chart.series[s], s);
  std::set<Meaning> runs;
  for (const ChartStretch& run : chart.runs) runs.insert(run.meaning);
  for (const Meaning meaning : runs)
    if (std::ranges::find(chart.series, meaning, &Series::meaning) == chart.series.end())
      add(series_of(meaning, SeriesStyle::boxes), 0);
  if (chart.image && chart.image->grays)
    html += "<span class=\"entry\">" + html_escaped(chart.image->gray_label) + "</span>";
  return html;
}

std::string svg_file(const std::vector<Chart>& charts, size_t columns) {
  assert(!charts.empty() && columns > 0);
  const double scale = charts.front().scale;
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
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.6g}\" height=\"{:.6g}\" "
             "viewBox=\"0 0 {:.0f} {:.0f}\">\n<style>{}</style>\n<rect width=\"100%\" "
             "height=\"100%\" fill=\"#fff\"/>\n",
             std::ceil(width) * scale, std::ceil(bottom) * scale, std::ceil(width),
             std::ceil(bottom), file_style()) +
         body + "</svg>\n";
}

std::string chart_png(const std::vector<Chart>& charts, size_t columns) {
  return png_of_svg(svg_file(charts, columns),
                    (charts.front().image ? 1 : kZoom) / charts.front().scale);
}

void draw_charts(const std::vector<Chart>& charts, size_t columns, const std::string& file,
                 const std::filesystem::path& folder) {
  const std::string svg = svg_file(charts, columns);
  write_part(folder / (file + ".svg"), svg);
  write_part(folder / (file + ".pdf"), pdf_of_svg(svg));
  write_part(folder / (file + ".png"), chart_png(charts, columns));
}

void draw_chart(const Chart& chart, const std::filesystem::path& folder) {
  draw_charts({chart}, 1, chart.file, folder);
}

}  // namespace vpr
