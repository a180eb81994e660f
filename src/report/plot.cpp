#include "report/plot.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "report/gnuplot.h"
#include "report/palette.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

// In single quotes gnuplot takes everything as it is, but for the quote, which is doubled.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += c == '\n' ? ' ' : c;
  }
  return result + "'";
}

std::string data_block(const PlotLine& line, const std::string& name) {
  std::string block = fmt::format("${} << END\n", name);
  const auto& points = line.points;
  if (line.style == PlotStyle::boxes) {
    for (size_t i = 0; i + 1 < points.size(); i += 2) {
      const auto& [x0, y0] = points[i];
      const auto& [x1, y1] = points[i + 1];
      block += fmt::format("{} {} {} {} {} {}\n", (x0 + x1) / 2, (y0 + y1) / 2, x0, x1, y0, y1);
    }
  } else {
    for (const auto& [x, y] : points)
      block += std::isnan(x) ? std::string("\n") : fmt::format("{} {}\n", x, y);
  }
  return block + "END\n";
}

std::string label_block(const PlotLine& line, const std::string& name) {
  std::string block = fmt::format("${} << END\n", name);
  for (size_t i = 0; i < line.labels.size(); ++i)
    if (!line.labels[i].empty())
      block += fmt::format("{} {} \"{}\"\n", line.points[i].first, line.points[i].second,
                           line.labels[i]);
  return block + "END\n";
}

std::string style_of(const PlotLine& line) {
  constexpr std::array<int, 5> kPointTypes = {7, 7, 5, 2, 6};  // gnuplot's, by PlotMark
  constexpr std::array<double, 5> kPointSizes = {0.8, 0.6, 1.2, 1.1, 0.7};
  const auto mark = static_cast<size_t>(line.mark);
  const std::string colour = line.colour.empty() ? "" : fmt::format(" lc rgb '{}'", line.colour);
  switch (line.style) {
    case PlotStyle::line_and_points:
      return "linespoints lw 2 pt 7 ps 0.7" + colour;
    case PlotStyle::line:
      return "lines lw 2" + colour;
    case PlotStyle::wide_line:
      return "lines lw 7" + colour;
    case PlotStyle::bar:
      return "linespoints lw 3 pt 1 ps 0.8" + colour;
    case PlotStyle::boxes:
      return "boxxyerror fs solid noborder" + colour;
    case PlotStyle::points:
      break;
  }
  return fmt::format("points pt {} ps {} lw 2{}", kPointTypes[mark], kPointSizes[mark], colour);
}

std::string ticks_text(const std::string& axis, const std::vector<PlotTick>& ticks) {
  if (ticks.empty()) return "";
  std::string list;
  for (const PlotTick& tick : ticks)
    list += fmt::format("{}{} {}", list.empty() ? "" : ", ", quoted(tick.text), tick.at);
  return fmt::format("set {}tics ({})\n", axis, list);
}

// Names stand inside, at the begin of their band; those of the x axis above it.
std::string bands_text(const Plot& plot) {
  std::string script;
  const std::string colour = hex_of(Meaning::divider);
  for (size_t i = 0; i < plot.y_bands.size(); ++i) {
    const PlotBand& band = plot.y_bands[i];
    script += fmt::format(
        "set label {} at graph 0.01, first {} offset 0, 0.6 left front noenhanced "
        "font ',11'\n",
        quoted(band.name), band.begin);
    if (i > 0)
      script += fmt::format(
          "set arrow from graph 0, first {0} to graph 1, first {0} nohead lc rgb '{1}'\n",
          band.begin, colour);
  }
  for (size_t i = 0; i < plot.x_bands.size(); ++i) {
    const PlotBand& band = plot.x_bands[i];
    script += fmt::format(
        "set label {} at first {}, graph 1 offset 0, 0.6 left {}noenhanced font ',11'\n",
        quoted(band.name), band.begin, plot.x_bands.size() > 3 ? "rotate by 30 " : "");
    if (i > 0)
      script += fmt::format(
          "set arrow from first {0}, graph 0 to first {0}, graph 1 nohead front lc rgb '{1}'\n",
          band.begin, colour);
  }
  return script;
}

std::string image_settings(const PlotImage& image) {
  const double aspect = image.rows / std::max(1.0, image.columns);
  std::string script = fmt::format("set xrange [0:{}]\nset yrange [{}:0]\nset tmargin 6\n",
                                   std::max(1.0, image.columns), std::max(1.0, image.rows));
  if (aspect > 0.2 && aspect < 5) script += "set size ratio -1\n";
  if (!image.greys) return script;
  const auto [black, white] = *image.greys;
  script += fmt::format("set palette gray{}\nset cbrange [{}:{}]\nset cblabel {} noenhanced\n",
                        black > white ? " negative" : "", std::min(black, white),
                        std::max(black, white), quoted(image.grey_label));
  return script;
}

std::string settings_of(const Plot& plot) {
  std::string script = fmt::format(
      "unset label\nunset arrow\nset title {} noenhanced{}\nset xlabel {} noenhanced\n"
      "set ylabel {} noenhanced\nset key below center horizontal reverse Left noenhanced samplen "
      "2\n",
      quoted(plot.title), plot.x_bands.empty() ? "" : " offset 0, 2", quoted(plot.x_label),
      quoted(plot.y_label));
  if (plot.is_plan)
    return script +
           "unset border\nunset tics\nset size ratio -1\n"
           "set offsets graph 0.03, graph 0.03, graph 0.03, graph 0.03\n";
  script +=
      "set key height 1\nset grid lc rgb '#dddddd'\nset border 3\nset tics nomirror\n"
      "set offsets graph 0.02, graph 0.02, 0, 0\n";
  if (plot.is_log_x) script += "set logscale x\n";
  if (plot.is_log_y) script += "set logscale y\n";
  if (plot.is_unit_square)
    script += "set xrange [0:1]\nset yrange [0:1]\nset offsets 0, 0, 0, 0\n";
  else if (!plot.is_log_y)
    script += plot.y_end ? fmt::format("set yrange [0:{}]\n", *plot.y_end) : "set yrange [0:*]\n";
  if (plot.x_end)
    script += fmt::format("set xrange [0:{}]\nset offsets 0, 0, 0, 0\n", *plot.x_end);
  else if (plot.starts_at_zero)
    script += "set xrange [0:1<*]\nset offsets 0, graph 0.05, graph 0.05, 0\n";
  if (plot.image) script += image_settings(*plot.image);
  return script + ticks_text("x", plot.x_ticks) + ticks_text("y", plot.y_ticks) + bands_text(plot);
}

std::string block_name(size_t plot, size_t line) { return fmt::format("line{}_{}", plot, line); }

std::string drawing_of(const Plot& plot, size_t index) {
  std::vector<std::string> parts;
  if (plot.image) {
    parts.push_back(fmt::format(
        "'-' binary array=({0},{1}) dx={2} dy={2} origin=({3},{3}) format='%uchar' "
        "using 1:2:3 with rgbimage notitle",
        plot.image->width, plot.image->height, plot.image->units, plot.image->units / 2));
    if (plot.image->greys)  // for its scale
      parts.emplace_back("'+' using (NaN):(NaN):(NaN) with points palette notitle");
  }
  for (size_t i = 0; i < plot.lines.size(); ++i) {
    const PlotLine& line = plot.lines[i];
    const std::string block = "$" + block_name(index, i);
    const bool is_box = line.style == PlotStyle::boxes;
    parts.push_back(fmt::format(
        "{} with {} {}",
        line.points.empty() ? "NaN" : block + " using " + (is_box ? "1:2:3:4:5:6" : "1:2"),
        style_of(line), line.name.empty() ? "notitle" : "title " + quoted(line.name)));
    if (!line.labels.empty())
      parts.push_back(
          block +
          "_labels using 1:2:3 with labels left offset 0.5, 0.5 font ',10' notitle noenhanced");
  }
  std::string draw = fmt::format("plot {}\n", fmt::join(parts, ", "));
  if (plot.image) draw.append(plot.image->rgb.begin(), plot.image->rgb.end());
  return draw;
}

struct PictureSize {
  size_t width;
  size_t height;
};

// Of the PNG; plans are about as high as wide, pictures as high as theirs.
PictureSize size_of(const Plot& plot) {
  if (plot.is_plan) return {900, 720};
  if (!plot.image) return {1200, 720};
  const double aspect = plot.image->rows / std::max(1.0, plot.image->columns);
  return {1100, 200 + static_cast<size_t>(900 * std::clamp(aspect, 0.3, 1.2))};
}

std::string series_text() {
  std::string script;
  size_t number = 0;
  for (const std::string_view colour : series_colours())
    script += fmt::format("set linetype {} lc rgb '{}'\n", ++number, colour);
  return script + fmt::format("set linetype cycle {}\n", number);
}

}  // namespace

std::string plot_script(const std::vector<Plot>& plots, size_t columns, const fs::path& stem) {
  assert(!plots.empty());
  std::string script = series_text();
  for (size_t p = 0; p < plots.size(); ++p)
    for (size_t i = 0; i < plots[p].lines.size(); ++i) {
      const PlotLine& line = plots[p].lines[i];
      script += data_block(line, block_name(p, i));
      if (!line.labels.empty()) script += label_block(line, block_name(p, i) + "_labels");
    }
  const size_t rows = (plots.size() + columns - 1) / columns;
  const PictureSize size = size_of(plots.front());
  for (const auto& [terminal, extension, quarters] :
       {std::tuple("svg", "svg", 3), std::tuple("pngcairo", "png", 4)}) {
    script += fmt::format(
        "set terminal {} size {},{} font 'Helvetica,13' background '#ffffff'\nset output {}\n",
        terminal, size.width * quarters / 4 * columns, size.height * quarters / 4 * rows,
        quoted(stem.string() + "." + extension));
    if (plots.size() > 1) script += fmt::format("set multiplot layout {},{}\n", rows, columns);
    for (size_t p = 0; p < plots.size(); ++p)
      script += settings_of(plots[p]) + drawing_of(plots[p], p);
    script += plots.size() > 1 ? "unset multiplot\nunset output\n" : "unset output\n";
  }
  return script;
}

void thin_labels(Plot& plot) {
  constexpr double kWidth = 0.09;  // of a label, as a share of the plot
  constexpr double kHeight = 0.04;
  double most_x = 1;
  double most_y = 1;
  for (const PlotLine& line : plot.lines)
    for (const auto& [x, y] : line.points) {
      most_x = std::max(most_x, x);
      most_y = std::max(most_y, y);
    }
  std::vector<std::pair<double, double>> taken;
  for (PlotLine& line : plot.lines)
    for (size_t i = 0; i < line.labels.size(); ++i) {
      const auto& point = line.points[i];
      if (line.labels[i].empty()) continue;
      const bool is_covered = std::any_of(taken.begin(), taken.end(), [&](const auto& other) {
        return std::abs(other.first - point.first) < kWidth * most_x &&
               std::abs(other.second - point.second) < kHeight * most_y;
      });
      if (is_covered)
        line.labels[i].clear();
      else
        taken.push_back(point);
    }
}

bool can_draw_plots() {
  const char* path = std::getenv("PATH");
  if (path == nullptr) return false;
  std::string folders = path;
  for (size_t begin = 0; begin <= folders.size();) {
    const size_t end = std::min(folders.find(':', begin), folders.size());
    std::error_code error;
    if (fs::is_regular_file(fs::path(folders.substr(begin, end - begin)) / "gnuplot", error))
      return true;
    begin = end + 1;
  }
  return false;
}

void draw_plot(const Plot& plot, const fs::path& folder) {
  draw_plots({plot}, 1, plot.file, folder);
}

void draw_plots(const std::vector<Plot>& plots, size_t columns, const std::string& file,
                const fs::path& folder) {
  assert(!plots.empty());
  bool is_drawn = run_gnuplot(plot_script(plots, columns, file), folder);
  for (const char* extension : {".svg", ".png"})
    is_drawn = is_drawn && is_whole_picture(folder / (file + extension));
  if (!is_drawn)
    throw Error(ErrorKind::output,
                fmt::format("{0}.svg and {0}.png: gnuplot could not draw them to their end; is the "
                            "disk full?",
                            file));
}

}  // namespace vpr
