#include "report/plot.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

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

std::string data_block(const PlotLine& line, size_t index) {
  std::string block = fmt::format("$line{} << END\n", index);
  for (const auto& [x, y] : line.points) block += fmt::format("{} {}\n", x, y);
  return block + "END\n";
}

const char* style_of(PlotStyle style) {
  switch (style) {
    case PlotStyle::line_and_points:
      return "linespoints lw 2 pt 7 ps 0.6";
    case PlotStyle::line:
      return "lines lw 2";
    case PlotStyle::points:
      return "points pt 7 ps 0.3";
  }
  return "lines";
}

std::string script_of(const Plot& plot, const fs::path& folder) {
  std::string script;
  for (size_t i = 0; i < plot.lines.size(); ++i) script += data_block(plot.lines[i], i);
  script += fmt::format(
      "set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} "
      "noenhanced\n",
      quoted(plot.title), quoted(plot.x_label), quoted(plot.y_label));
  script +=
      "set grid lc rgb '#dddddd'\nset key outside right top noenhanced\nset border 3\n"
      "set tics nomirror\nset offsets graph 0.02, graph 0.02, 0, 0\n";
  if (plot.is_log_x) script += "set logscale x\n";
  if (plot.is_log_y) script += "set logscale y\n";
  if (plot.is_unit_square)
    script += "set xrange [0:1]\nset yrange [0:1]\nset offsets 0, 0, 0, 0\n";
  else if (!plot.is_log_y)
    script += "set yrange [0:*]\n";
  std::string draw = "plot ";
  for (size_t i = 0; i < plot.lines.size(); ++i)
    draw += fmt::format("{}$line{} using 1:2 with {} title {}", i == 0 ? "" : ", ", i,
                        style_of(plot.lines[i].style), quoted(plot.lines[i].name));
  for (const auto& [terminal, extension] :
       {std::pair("svg size 900,540 font 'Helvetica,13'", "svg"),
        std::pair("pngcairo size 1200,720 font 'Helvetica,13'", "png")})
    script += fmt::format("set terminal {}\nset output {}\n{}\nunset output\n", terminal,
                          quoted((folder / (plot.file + "." + extension)).string()), draw);
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
  const std::string script = script_of(plot, folder);
  std::FILE* pipe = ::popen("gnuplot 2>/dev/null", "w");
  const bool written =
      pipe != nullptr && std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
  const int status = pipe == nullptr ? -1 : ::pclose(pipe);
  std::error_code error;
  const bool there = fs::file_size(folder / (plot.file + ".svg"), error) > 0 && !error &&
                     fs::file_size(folder / (plot.file + ".png"), error) > 0 && !error;
  if (!written || status != 0 || !there)
    throw Error(ErrorKind::output,
                fmt::format("{}: gnuplot could not draw the plot", (folder / plot.file).string()));
}

bool is_plot_folder(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() != ".svg" && entry.path().extension() != ".png") return false;
  return true;
}

}  // namespace vpr
