#include "report/chart.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "base/output.h"
#include "report/chart_svg.h"
#include "report/png_file.h"
#include "report/svg_raster.h"

namespace vpr {
namespace {

// Letters and lines are drawn finer than their units. Pixels of a matrix are not: each is whole.
constexpr double kZoom = 4.0 / 3;

constexpr int kLeastImage = 600;  // the longer side of an image, at least
constexpr int kLeastSide = 150;   // the shorter one

}  // namespace

Series series_of(Meaning meaning, SeriesStyle style, SeriesMark mark) {
  return {std::string(colour_of(meaning).words), {}, style, meaning, mark};
}

ChartImage chart_image(const cv::Mat& image, size_t cells) {
  const auto times = [&](int pixels) {
    const int longer = std::max(image.cols, image.rows);
    return std::max((kLeastImage + longer - 1) / longer, (kLeastSide + pixels - 1) / pixels);
  };
  cv::Mat large;
  cv::resize(image, large, {}, times(image.cols), times(image.rows), cv::INTER_NEAREST);
  return {png_of(large), static_cast<size_t>(large.cols), static_cast<size_t>(large.rows),
          static_cast<double>(cells) * image.cols, static_cast<double>(cells) * image.rows};
}

std::string chart_png(const std::vector<Chart>& charts, size_t columns) {
  return png_of_svg(svg_file(charts, columns), charts.front().image ? 1 : kZoom);
}

void draw_charts(const std::vector<Chart>& charts, size_t columns, const std::string& file,
                 const std::filesystem::path& folder) {
  write_part(folder / (file + ".svg"), svg_file(charts, columns));
  write_part(folder / (file + ".png"), chart_png(charts, columns));
}

void draw_chart(const Chart& chart, const std::filesystem::path& folder) {
  draw_charts({chart}, 1, chart.file, folder);
}

}  // namespace vpr
