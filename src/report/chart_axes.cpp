#include <algorithm>

#include <fmt/format.h>

#include "report/chart_drawing.h"
#include "report/svg_text.h"

namespace vpr {
namespace {

constexpr double kBarHeight = 16;
constexpr double kBarGap = 10;  // between the plot and the bar

std::string x_ticks_svg(const Drawing& drawing) {
  const ChartArea& area = drawing.at.area;
  const double top = area.bottom() + (drawing.chart.runs.empty() ? 0 : kBarGap + kBarHeight);
  std::string svg;
  for (const ChartTick& tick : drawing.at.x_ticks) {
    const double x = drawing.at.x(tick.at);
    svg += drawing.chart.image
               ? fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}v5\"/>", x, area.bottom())
               : fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", x, area.top,
                             area.bottom());
    svg += svg_text(x, top + 18, "middle", tick.text);
  }
  return svg;
}

std::string y_ticks_svg(const Drawing& drawing) {
  const ChartArea& area = drawing.at.area;
  std::string svg;
  for (const ChartTick& tick : drawing.at.y_ticks) {
    const double y = drawing.at.y(tick.at);
    svg += drawing.chart.image
               ? fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}h-5\"/>", area.left, y)
               : fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>", area.left, y,
                             area.right());
    svg += svg_text(area.left - 8, y + 4.5, "end", tick.text);
  }
  return svg;
}

// Names of the y axis's bands stand inside, where there is room; those of the x axis's above.
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

std::string labels_of_axes(const Drawing& drawing) {
  const ChartArea& area = drawing.at.area;
  const double below = drawing.chart.runs.empty() ? 0 : kBarGap + kBarHeight;
  return svg_text(area.left + area.width / 2, area.bottom() + below + 40, "middle",
                  drawing.chart.x.label) +
         svg_text(area.left, area.top - 10 - drawing.at.names_height, "start",
                  drawing.chart.y.label);
}

}  // namespace

std::string axes_svg(const Drawing& drawing) {
  return x_ticks_svg(drawing) + y_ticks_svg(drawing) + labels_of_axes(drawing) + bands_svg(drawing);
}

std::string runs_svg(const Drawing& drawing) {
  const double top = drawing.at.area.bottom() + kBarGap;
  std::string svg;
  for (const ChartRun& run : drawing.chart.runs) {
    const double left = drawing.at.x(run.begin);
    svg += svg_rect(std::string(colour_of(run.meaning).name), left, top,
                    std::max(0.6, drawing.at.x(run.end) - left), kBarHeight);
  }
  if (drawing.chart.runs.empty()) return "";
  return svg + svg_text(drawing.at.area.left - 8, top + 13, "end", drawing.chart.runs_label);
}

double runs_bottom(const ChartArea& area) { return area.bottom() + kBarGap + kBarHeight; }

}  // namespace vpr
