// Charts as SVG: the one body that draws pages' charts and picture files alike.
#pragma once

#include <string>
#include <vector>

#include "report/chart.h"

namespace vpr {

/// An element for an HTML page, without a title and a legend, which are the page's; its classes are
/// those of the page's style sheet, the palette's among them. Marks of a series that fall on one
/// spot are one, so that its size is bounded for any number of points. An id `here` marks a line
/// that the page's script moves over a chart with runs.
std::string page_svg(const Chart& chart);

/// A whole SVG file, white, with titles and legends: the charts row by row, `columns` in each.
/// There is at least one chart. What texts hold is escaped.
std::string svg_file(const std::vector<Chart>& charts, size_t columns = 1);

}  // namespace vpr
