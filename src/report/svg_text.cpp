#include "report/svg_text.h"

#include <cmath>

#include <fmt/format.h>

#include "report/html_text.h"

namespace vpr {

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

bool SpotSet::add(double x, double y) {
  return seen_.insert({std::lround(x), std::lround(y)}).second;
}

}  // namespace vpr
