// Where a chart's parts stand: its axes' ranges and ticks, and the rectangle that they frame.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "present/chart.h"

namespace vpr {

/// From values on an axis to units of the SVG.
struct AxisScale {
  double from = 0;  ///< the value at `begin`
  double to = 1;
  bool is_log = false;
  double begin = 0;
  double end = 1;

  double operator()(double value) const;
};

/// The rectangle that a chart plots into.
struct ChartArea {
  double left = 0;
  double top = 0;
  double width = 0;
  double height = 0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

/// One entry of the legend: where it starts, and how wide it is.
struct LegendEntry {
  size_t series = 0;
  double x = 0;
  double y = 0;
};

/// The layout of one chart, in units of the SVG.
struct ChartLayout {
  double width = 0;  ///< of the whole
  double height = 0;
  ChartArea area;
  AxisScale x;
  AxisScale y;
  std::vector<ChartTick> x_ticks;
  std::vector<ChartTick> y_ticks;
  std::vector<LegendEntry> legend;
  double names_height = 0;       ///< of the names of the x axis's bands, above the plot
  bool has_steep_names = false;  ///< they would run into each other
};

/// About how wide a text is, in units of the SVG, in letters `size` units high.
double text_width(const std::string& text, double size);

/// The range of an axis that shows `values` (those that are not finite aside), from a little below
/// the smallest to a little above the largest or, where it is logarithmic, whole steps of 1, 2, 5.
/// Without values it is from 0 to 1, or from 1 to 10. The axis's own range goes first.
std::pair<double, double> range_of(const ChartAxis& axis, const std::vector<double>& values);

/// At most about `most` ticks from one end of a range to the other, 1, 2 or 5 times a power of ten
/// apart; of a logarithmic one, at 1, 2 and 5 times powers of ten, or at those powers alone.
std::vector<ChartTick> ticks_of(bool is_log, const std::pair<double, double>& range, size_t most);

/// The smallest of 1, 2, 5, 10, 20, ... that divides `length` into at most `most` parts; most is at
/// least 1.
size_t round_step(size_t length, size_t most);

/// `for_page`: neither a title nor a legend.
ChartLayout layout_of(const Chart& chart, bool for_page);

}  // namespace vpr
