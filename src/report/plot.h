// Plots, drawn by gnuplot where it is installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace vpr {

/// bar: a line with ends; boxes: every two points are opposite corners of a filled box.
enum class PlotStyle { line_and_points, line, wide_line, bar, points, boxes };

enum class PlotMark { disc, dot, square, cross, circle };

/// Interrupts a line.
inline constexpr std::pair<double, double> kPlotGap = {std::numeric_limits<double>::quiet_NaN(),
                                                       std::numeric_limits<double>::quiet_NaN()};

struct PlotLine {
  std::string name;  ///< empty: not in the legend
  std::vector<std::pair<double, double>> points;
  PlotStyle style = PlotStyle::line_and_points;
  std::string colour = {};  ///< "#rrggbb" of the palette; empty: the next of the series
  PlotMark mark = PlotMark::disc;
  std::vector<std::string> labels = {};  ///< beside the points, in their order
};

struct PlotTick {
  double at = 0;
  std::string text;
};

/// A stretch of an axis from `begin` to the next band, divided from the one before by a line.
struct PlotBand {
  double begin = 0;
  std::string name;
};

/// Pixels behind the lines, from the corner above on the left, which is (0, 0).
struct PlotImage {
  size_t width = 0;
  size_t height = 0;
  double units = 1;  ///< a pixel's side on the axes
  std::vector<uint8_t> rgb = {};
  double columns = 0;  ///< the axes end here; the last pixels may reach over it
  double rows = 0;
  std::optional<std::pair<double, double>> greys = {};  ///< the values of black and white
  std::string grey_label = {};
};

struct Plot {
  std::string file;  ///< name without extension
  std::string title;
  std::string x_label;
  std::string y_label;
  bool is_log_x = false;
  bool is_log_y = false;
  std::vector<PlotLine> lines = {};
  bool is_unit_square = false;         ///< both axes from 0 to 1
  bool is_plan = false;                ///< one metre is as long on both axes, which are not drawn
  bool starts_at_zero = false;         ///< the x axis; the y axis does unless it is logarithmic
  std::vector<PlotTick> x_ticks = {};  ///< none: chosen
  std::vector<PlotTick> y_ticks = {};
  std::vector<PlotBand> x_bands = {};
  std::vector<PlotBand> y_bands = {};
  std::optional<double> x_end = {};  ///< none: chosen
  std::optional<double> y_end = {};
  std::optional<PlotImage> image = {};  ///< the y axis goes down
};

/// Empties labels that would stand on one before them.
void thin_labels(Plot& plot);

/// Whether gnuplot can be called.
bool can_draw_plots();

/// What gnuplot is told to write <stem>.svg and <stem>.png with; pictures are binary.
std::string plot_script(const std::vector<Plot>& plots, size_t columns,
                        const std::filesystem::path& stem);

/// Writes <file>.svg and <file>.png into `folder`, which exists. Throws Error(output) if gnuplot
/// fails.
void draw_plot(const Plot& plot, const std::filesystem::path& folder);

/// Several plots in one picture called `file`, row by row; there is at least one. Throws like
/// draw_plot.
void draw_plots(const std::vector<Plot>& plots, size_t columns, const std::string& file,
                const std::filesystem::path& folder);

}  // namespace vpr
