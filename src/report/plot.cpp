#include "report/plot.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <tuple>

#include <fmt/format.h>
#include <sys/wait.h>

#include "base/error.h"

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
  for (const auto& [x, y] : line.points)
    block += std::isnan(x) ? std::string("\n") : fmt::format("{} {}\n", x, y);
  return block + "END\n";
}

std::string style_of(const PlotLine& line) {
  constexpr std::array<int, 4> kPointTypes = {7, 7, 5, 2};  // gnuplot's, by PlotMark
  constexpr std::array<double, 4> kPointSizes = {0.7, 0.4, 1.2, 0.9};
  const auto mark = static_cast<size_t>(line.mark);
  const std::string colour = line.colour.empty() ? "" : fmt::format(" lc rgb '{}'", line.colour);
  switch (line.style) {
    case PlotStyle::line_and_points:
      return "linespoints lw 2 pt 7 ps 0.6" + colour;
    case PlotStyle::line:
      return "lines lw 2" + colour;
    case PlotStyle::points:
      break;
  }
  const double size = line.colour.empty() ? 0.3 : kPointSizes[mark];
  return fmt::format("points pt {} ps {}{}", kPointTypes[mark], size, colour);
}

std::string settings_of(const Plot& plot) {
  std::string script =
      fmt::format("set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} noenhanced\n",
                  quoted(plot.title), quoted(plot.x_label), quoted(plot.y_label));
  if (plot.is_plan)
    return script +
           "unset border\nunset tics\nset size ratio -1\nset key below noenhanced\n"
           "set offsets graph 0.03, graph 0.03, graph 0.03, graph 0.03\n";
  script +=
      "set grid lc rgb '#dddddd'\nset key outside right top noenhanced\nset border 3\n"
      "set tics nomirror\nset offsets graph 0.02, graph 0.02, 0, 0\n";
  if (plot.is_log_x) script += "set logscale x\n";
  if (plot.is_log_y) script += "set logscale y\n";
  if (plot.is_unit_square)
    script += "set xrange [0:1]\nset yrange [0:1]\nset offsets 0, 0, 0, 0\n";
  else if (!plot.is_log_y)
    script += "set yrange [0:*]\n";
  return script;
}

std::string block_name(size_t plot, size_t line) { return fmt::format("line{}_{}", plot, line); }

std::string drawing_of(const Plot& plot, size_t index) {
  std::string draw = "plot ";
  for (size_t i = 0; i < plot.lines.size(); ++i) {
    const PlotLine& line = plot.lines[i];
    draw +=
        fmt::format("{}${} using 1:2 with {} {}", i == 0 ? "" : ", ", block_name(index, i),
                    style_of(line), line.name.empty() ? "notitle" : "title " + quoted(line.name));
  }
  return draw + "\n";
}

std::string script_of(const std::vector<Plot>& plots, size_t columns, const fs::path& stem) {
  std::string script;
  for (size_t p = 0; p < plots.size(); ++p)
    for (size_t i = 0; i < plots[p].lines.size(); ++i)
      script += data_block(plots[p].lines[i], block_name(p, i));
  const size_t rows = (plots.size() + columns - 1) / columns;
  const size_t quarters = plots.front().is_plan ? 3 : 4;  // plans are about as high as wide
  for (const auto& [terminal, extension, width, height] :
       {std::tuple("svg", "svg", 900, 540), std::tuple("pngcairo", "png", 1200, 720)}) {
    script += fmt::format("set terminal {} size {},{} font 'Helvetica,13'\nset output {}\n",
                          terminal, width * quarters / 4 * columns, height * rows,
                          quoted(stem.string() + "." + extension));
    if (plots.size() > 1) script += fmt::format("set multiplot layout {},{}\n", rows, columns);
    for (size_t p = 0; p < plots.size(); ++p)
      script += settings_of(plots[p]) + drawing_of(plots[p], p);
    script += plots.size() > 1 ? "unset multiplot\nunset output\n" : "unset output\n";
  }
  return script;
}

}  // namespace

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
  const fs::path stem = folder / file;
  const std::string script = script_of(plots, columns, stem);
  std::FILE* pipe = ::popen("gnuplot 2>/dev/null", "w");
  const bool written =
      pipe != nullptr && std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
  const int status = pipe == nullptr ? -1 : ::pclose(pipe);
  std::error_code error;
  const bool there = fs::file_size(stem.string() + ".svg", error) > 0 && !error &&
                     fs::file_size(stem.string() + ".png", error) > 0 && !error;
  if (!written || status != 0 || !there)
    throw Error(ErrorKind::output,
                fmt::format("{}: gnuplot could not draw the plot", stem.string()));
}

bool is_plot_folder(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() != ".svg" && entry.path().extension() != ".png") return false;
  return true;
}

}  // namespace vpr
