// Line plots, drawn by gnuplot where it is installed.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace vpr {

enum class PlotStyle { line_and_points, line, points };

enum class PlotMark { disc, dot, square, cross };

/// Interrupts a line.
inline constexpr std::pair<double, double> kPlotGap = {std::numeric_limits<double>::quiet_NaN(),
                                                       std::numeric_limits<double>::quiet_NaN()};

struct PlotLine {
  std::string name;  ///< empty: not in the legend
  std::vector<std::pair<double, double>> points;
  PlotStyle style = PlotStyle::line_and_points;
  std::string colour = {};  ///< "#rrggbb"; empty: chosen
  PlotMark mark = PlotMark::disc;
};

struct Plot {
  std::string file;  ///< name without extension
  std::string title;
  std::string x_label;
  std::string y_label;
  bool is_log_x = false;
  bool is_log_y = false;
  std::vector<PlotLine> lines;
  bool is_unit_square = false;  ///< both axes from 0 to 1
  bool is_plan = false;         ///< one metre is as long on both axes, the legend below
};

/// Whether gnuplot can be called.
bool can_draw_plots();

/// Writes <file>.svg and <file>.png into `folder`, which exists. Throws Error(output) if gnuplot
/// fails.
void draw_plot(const Plot& plot, const std::filesystem::path& folder);

/// Several plots in one picture called `file`, row by row; there is at least one. Throws like
/// draw_plot.
void draw_plots(const std::vector<Plot>& plots, size_t columns, const std::string& file,
                const std::filesystem::path& folder);

/// Whether a folder holds nothing but such files.
bool is_plot_folder(const std::filesystem::path& folder);

}  // namespace vpr
