#include "report/svg_text.h"

#include <cmath>

#include <fmt/format.h>

#include "report/html_text.h"

namespace vpr {

std::string svg_text(double x, double y, const std::string& anchor, const std::string& text,
                     const std::string& kind) {
  return fmt::format("<text{} x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>",
                     kind.empty() ? "" : " class=\"" + kind + "\"", x, y, anchor,
                     html_escaped(text));
}

std::string svg_rect(const std::string& kind, double x, double y, double width, double height) {
  return fmt::format(
      "<rect class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>", kind, x,
      y, width, height);
}

void SvgMarks::add(double x, double y, double width, double height) {
  if (!seen_.insert({std::lround(x), std::lround(y)}).second) return;
  path_ += fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h-{:.1f}z", x, y, width, height, width);
}

std::string SvgMarks::svg() const {
  return path_.empty() ? "" : fmt::format("<path class=\"{}\" d=\"{}\"/>\n", kind_, path_);
}

std::string svg_x_tick(const PlotArea& area, double share, const std::string& label) {
  const double x = area.left + area.width * share;
  return fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", x, area.top,
                     area.bottom()) +
         svg_text(x, area.bottom() + 20, "middle", label);
}

std::string svg_y_tick(const PlotArea& area, double share, const std::string& label) {
  const double y = area.bottom() - area.height * share;
  return fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>", area.left, y,
                     area.right()) +
         svg_text(area.left - 7, y + 5, "end", label);
}

std::string svg_axis_titles(const PlotArea& area, const std::string& x, const std::string& y) {
  return svg_text(area.left + area.width / 2, area.bottom() + 42, "middle", x) +
         svg_text(area.left, area.top - 10, "start", y);
}

}  // namespace vpr
