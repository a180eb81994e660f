#include "report/chart_svg.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "report/chart_drawing.h"
#include "report/html_text.h"
#include "report/svg_text.h"

namespace vpr {
namespace {

// A nested element cuts off what reaches over.
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

std::string greys_svg(const Drawing& drawing) {
  const ChartImage& image = *drawing.chart.image;
  if (!image.greys) return "";
  const ChartArea& area = drawing.at.area;
  const double y = area.bottom() + 56;
  const double width = std::max(area.width, 400.0);
  return fmt::format(
             "<defs><linearGradient id=\"greys\"><stop stop-color=\"#000\"/><stop offset=\"1\" "
             "stop-color=\"#fff\"/></linearGradient></defs><rect class=\"greys\" "
             "fill=\"url(#greys)\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"12\"/>",
             area.left, y, width) +
         svg_text(area.left, y + 29, "start", fmt::format("{:.6g}", image.greys->first)) +
         svg_text(area.left + width / 2, y + 29, "middle", image.grey_label) +
         svg_text(area.left + width, y + 29, "end", fmt::format("{:.6g}", image.greys->second));
}

std::string body_of(const Drawing& drawing) {
  const Chart& chart = drawing.chart;
  std::string svg;
  if (chart.image) svg += image_svg(drawing);
  const auto is_behind = [](const Series& series) { return series.style == SeriesStyle::boxes; };
  for (size_t s = 0; s < chart.series.size(); ++s)
    if (is_behind(chart.series[s])) svg += series_svg(drawing, s);
  if (!chart.is_plan) svg += axes_svg(drawing);
  for (size_t s = 0; s < chart.series.size(); ++s)
    if (!is_behind(chart.series[s])) svg += series_svg(drawing, s);
  svg += labels_svg(drawing) + runs_svg(drawing);
  if (chart.image) svg += greys_svg(drawing);
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

// As in the page's style sheet, but without variables, which not every reader of SVG knows.
std::string file_style() {
  std::string css =
      "text{font-family:sans-serif;font-size:13px;fill:#1c2430}.title{font-weight:600}"
      ".label{font-size:11px}.name{font-weight:600}.label,.name{paint-order:stroke;stroke:#fff;"
      "stroke-width:3px;stroke-linejoin:round}.axis{stroke:#d5d9e0;fill:none}"
      ".border{fill:none}.frame,.greys{stroke:#5c6675}.frame{fill:none}\n";
  for (const PaletteColour& row : palette())
    css += fmt::format(".{0}{{fill:#{1:06x}}}.line.{0}{{stroke:#{1:06x}}}\n", row.name, row.light);
  for (size_t i = 0; i < series_colours().size(); ++i)
    css += fmt::format(".series-{0}{{fill:{1}}}.line.series-{0}{{stroke:{1}}}\n", i,
                       series_colours()[i]);
  return css + fmt::format(
                   "path.line{{fill:none}}.border{{stroke:{}}}.all-pairs{{"
                   "stroke-dasharray:6 4}}\n",
                   hex_of(Meaning::divider));
}

}  // namespace

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
        drawing.at.area.top, runs_bottom(drawing.at.area));
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

}  // namespace vpr
