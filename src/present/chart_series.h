// The series of a chart as SVG, for chart.cpp.
#pragma once

#include <string>

#include "present/chart.h"

namespace vpr {

struct Drawing {
  const Chart& chart;
  ChartLayout at;
};

/// The baseline of the text is at y; `anchor` is "start", "middle" or "end".
std::string svg_text(double x, double y, const std::string& anchor, const std::string& text,
                     const std::string& kind = "");
std::string svg_rect(const std::string& kind, double x, double y, double width, double height);

std::string series_svg(const Drawing& drawing, size_t series);

/// The sample of a series in a legend: 22 units wide, centered at y. Dashes and marks depend on the
/// index in the chart.
std::string sample_svg(const Series& series, size_t index, double x, double y);

/// The labels of all points, except labels that would cover another label or a point.
std::string labels_svg(const Drawing& drawing);

}  // namespace vpr
