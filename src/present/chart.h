// A chart as plain data: what pages, plots, maps, matrices, sweeps and benchmarks draw.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "present/palette.h"

namespace cv {
class Mat;
}

namespace vpr {

/// A bar is a line with ends; of boxes, every two points are opposite corners of a filled one.
enum class SeriesStyle { line_and_points, line, wide_line, bar, points, boxes };

/// A point without a mark has its label in its place.
enum class SeriesMark { disc, dot, square, cross, circle, none };

/// A point that interrupts a line.
inline constexpr std::pair<double, double> kChartGap = {std::numeric_limits<double>::quiet_NaN(),
                                                        std::numeric_limits<double>::quiet_NaN()};

/// What stands in the legend as one entry.
struct Series {
  std::string name;  ///< empty: not in the legend
  std::vector<std::pair<double, double>> points;
  SeriesStyle style = SeriesStyle::line_and_points;
  std::optional<Meaning> meaning = {};  ///< whose color it has; none: the next of series_colors
  SeriesMark mark = SeriesMark::disc;
  std::vector<std::string> labels = {};  ///< beside the points, in their order
};

/// A series that has the color and, in the legend, the words of a meaning.
Series series_of(Meaning meaning, SeriesStyle style, SeriesMark mark = SeriesMark::disc);

/// A mark on an axis.
struct ChartTick {
  double at = 0;
  std::string text;
};

/// A stretch of an axis from `begin` to the next band, divided from the one before by a line.
struct ChartBand {
  double begin = 0;
  std::string name;
};

/// One axis: what it counts, and what stands along it.
struct ChartAxis {
  std::string label;
  bool is_log = false;
  bool from_zero = false;  ///< a chosen range starts at 0, unless it is logarithmic
  std::optional<std::pair<double, double>> range = {};  ///< from, to; from may be the larger
  std::vector<ChartTick> ticks = {};                    ///< none: chosen
  std::vector<ChartBand> bands = {};
};

/// Pixels behind the series, from the axes' zero to the right and downwards; the last ones may
/// reach over the ranges' ends, where they are cut off.
struct ChartImage {
  std::string png;   ///< the bytes of a PNG file
  size_t width = 1;  ///< its pixels, each a unit of the SVG
  size_t height = 1;
  double columns = 1;  ///< what it covers on the axes
  double rows = 1;
  std::optional<std::pair<double, double>> grays = {};  ///< the values of black and of white
  std::string gray_label = {};
};

/// An image (gray or BGR, 8 bits) whose pixels are `cells` units of the axes a side, enlarged by
/// whole numbers so that it can be looked at.
ChartImage chart_image(const cv::Mat& image, size_t cells);

/// A stretch of the x axis in the bar below the plot.
struct ChartRun {
  double begin = 0;
  double end = 0;
  Meaning meaning = Meaning::right;
};

/// A chart as data. Parts that are empty are not drawn.
struct Chart {
  std::string file;  ///< name without extension, and in a page the SVG's class
  std::string title;
  ChartAxis x = {};
  ChartAxis y = {.label = {}, .from_zero = true};
  std::vector<Series> series = {};
  bool is_plan = false;                  ///< a meter is as long on both axes, which are not drawn
  std::optional<ChartImage> image = {};  ///< both axes have ranges, and x's starts at 0
  std::vector<ChartRun> runs = {};
  std::string runs_label = {};
  double width = 900;  ///< of the whole, in the units of its SVG; charts with an image: chosen
  double height = 540;
};

/// An SVG element for an HTML page, without title and legend, which the page has; its classes are
/// those of the page's style sheet, the palette's among them. Marks of a series that fall on one
/// spot are drawn once, so that the size is bounded for any number of points. An id `here` marks a
/// line that the page's script moves over a chart with runs.
std::string page_svg(const Chart& chart);

/// A whole SVG file, white, with titles and legends: the charts row by row, `columns` in each.
/// There is at least one chart. Texts are escaped.
std::string svg_file(const std::vector<Chart>& charts, size_t columns = 1);

/// Charts in one picture, row by row, `columns` in each, as the bytes of a PNG file on white. There
/// is at least one.
std::string chart_png(const std::vector<Chart>& charts, size_t columns = 1);

/// Writes <file>.svg and <file>.png into the folder of an output (Output::temporary). Throws
/// Error(output).
void draw_chart(const Chart& chart, const std::filesystem::path& folder);
void draw_charts(const std::vector<Chart>& charts, size_t columns, const std::string& file,
                 const std::filesystem::path& folder);

}  // namespace vpr
