// Line plots, drawn by gnuplot where it is installed.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace vpr {

enum class PlotStyle { line_and_points, line, points };

struct PlotLine {
  std::string name;
  std::vector<std::pair<double, double>> points;
  PlotStyle style = PlotStyle::line_and_points;
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
};

/// Whether gnuplot can be called.
bool can_draw_plots();

/// Writes <file>.svg and <file>.png into `folder`, which exists. Throws Error(output) if gnuplot
/// fails.
void draw_plot(const Plot& plot, const std::filesystem::path& folder);

/// Whether a folder holds nothing but such files.
bool is_plot_folder(const std::filesystem::path& folder);

}  // namespace vpr
