// The parts of a chart as elements of an SVG, in the chart's layout. A part that the chart lacks is
// an empty text.
#pragma once

#include <string>

#include "report/chart.h"
#include "report/chart_layout.h"

namespace vpr {

/// A chart and where its parts stand.
struct Drawing {
  const Chart& chart;
  ChartLayout at;
};

/// The lines, marks or boxes of one series. Marks and boxes that would cover each other are drawn
/// once.
std::string series_svg(const Drawing& drawing, size_t index);

/// The labels of points of all series. Those that would stand on one before them are left out.
std::string labels_svg(const Drawing& drawing);

/// A symbol and a name for every entry of the layout's legend.
std::string legend_svg(const Drawing& drawing);

/// Ticks, labels and bands of both axes.
std::string axes_svg(const Drawing& drawing);

/// The bar of runs below the plot.
std::string runs_svg(const Drawing& drawing);

/// The lower end of that bar, in units of the SVG.
double runs_bottom(const ChartArea& area);

}  // namespace vpr
