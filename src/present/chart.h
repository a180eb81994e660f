// Colors by meaning, charts as data, their layout, and their output as SVG, PDF and PNG.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cv {
class Mat;
template <typename T, int n>
class Vec;
}  // namespace cv

namespace vpr {

enum class Verdict;

enum class Meaning {
  correct,  ///< recognized, correct by the ground truth
  incorrect,
  unjudged,      ///< recognized, but labeled ignore or without ground truth
  weak_correct,  ///< a best match that is not recognized
  weak_incorrect,
  weak_unjudged,
  truth,
  truth_outline,  ///< on a matrix
  missed,         ///< on a map: not recognized, with a match in the ground truth
  unmapped,       ///< on a map: not recognized, without a match in the ground truth
  train_path,
  place,  ///< of FAB-MAP
  wall,
  divider,  ///< between sequences
  best_matches,
  all_pairs,
  by_margin,
  required_margin
};

/// An entry of the palette; colors are 0xrrggbb for light and dark pages.
struct PaletteColor {
  Meaning meaning = Meaning::correct;
  std::string_view name;   ///< of the CSS variable and class
  std::string_view words;  ///< in a legend
  uint32_t light = 0;
  uint32_t dark = 0;
};

/// One entry per Meaning, in its order. Colors of one image are distinguishable for people with
/// any color vision deficiency.
std::span<const PaletteColor> palette();

const PaletteColor& color_of(Meaning meaning);

/// Blue, green and red for light pages, as in OpenCV's pixels.
cv::Vec<uint8_t, 3> bgr_of(Meaning meaning);

/// `verdict` must not be none.
Meaning meaning_of(Verdict verdict);

/// Colors of curves without a meaning, "#rrggbb" for light pages.
std::span<const std::string_view> series_colors();

/// The palette and the colors of curves as CSS variables, for light and dark pages.
std::string palette_css();

/// Each pair of points of `boxes` and `outline` is the least and
/// the greatest corner of a box. `boxes` fills them. `outline` draws the border of their union, row
/// by row: boxes are one row high, row after row, and from left to right.
enum class SeriesStyle { line_and_points, line, wide_line, points, boxes, outline };

/// automatic: a different one for each series of a chart. none: the label replaces the mark.
enum class SeriesMark { disc, dot, square, cross, circle, triangle, automatic, none };

/// A point that interrupts a line.
inline constexpr std::pair<double, double> kChartGap = {std::numeric_limits<double>::quiet_NaN(),
                                                        std::numeric_limits<double>::quiet_NaN()};

/// One entry of the legend. Lines without a meaning differ in their dashes and the marks at their
/// ends.
struct Series {
  std::string name;  ///< empty: not in the legend
  std::vector<std::pair<double, double>> points;
  SeriesStyle style = SeriesStyle::line_and_points;
  std::optional<Meaning> meaning = {};  ///< sets the color; none: the next of series_colors
  SeriesMark mark = SeriesMark::automatic;
  std::vector<std::string> labels = {};  ///< next to the points, in their order
};

/// A series with the color and, in the legend, the words of a meaning.
Series series_of(Meaning meaning, SeriesStyle style, SeriesMark mark = SeriesMark::disc);

struct ChartTick {
  double at = 0;
  std::string text;
};

struct ChartAxis {
  std::string label;
  bool is_log = false;
  bool from_zero = false;                               ///< an automatic linear range starts at 0
  std::optional<std::pair<double, double>> range = {};  ///< from, to; from may be the larger
  std::vector<ChartTick> ticks = {};                    ///< empty: automatic; overlapping ones go
  bool has_text_inside = false;                         ///< tick texts above their positions, left
  std::vector<ChartTick> bands = {};  ///< parts of the axis, from `at` on, with lines between them
};

/// A gray image under the series; dark pages invert it. Its first pixel is at the zero of both
/// axes. Pixels outside the ranges are cut off.
struct ChartImage {
  std::string png;   ///< the bytes of a PNG file
  size_t width = 1;  ///< in pixels; a pixel is at most a unit of the SVG
  size_t height = 1;
  double columns = 1;  ///< its size in units of the axes
  double rows = 1;
  std::optional<std::pair<double, double>> grays = {};  ///< values of black and white
  std::string gray_label = {};
};

/// An image (gray, or BGR with alpha, 8 bits) with pixels of `cells` x `cells` units of the axes,
/// enlarged by an integer factor so that its pixels are visible.
ChartImage chart_image(const cv::Mat& image, size_t cells);

/// A part of the x axis, drawn in the bar below the plot.
struct ChartStretch {
  double begin = 0;
  double end = 0;
  Meaning meaning = Meaning::correct;
};

/// Empty parts are not drawn.
struct Chart {
  std::string file;  ///< name without extension; class of the SVG in a page
  std::string title;
  ChartAxis x = {};
  ChartAxis y = {.label = {}, .from_zero = true};
  std::vector<Series> series = {};
  bool is_plan = false;                  ///< equal scales, no axes
  std::optional<ChartImage> image = {};  ///< needs ranges of both axes; x starts at 0
  std::vector<ChartStretch> runs = {};
  bool has_cursor = false;  ///< a line of class `here` in a page, which a script moves
  double right = 0;         ///< least room on the right of the plot, as for names of bands
  double width = 900;       ///< in units of the SVG; automatic for charts with an image
  double height = 540;
  double scale = 1;  ///< pixels per unit, in a file
};

void erase_empty_series(Chart& chart);

/// Adds an entry of the legend for the lines between bands of an axis, if there are any.
void name_borders(Chart& chart);

/// SVG elements for an HTML page, without title and legend: one that is readable on a phone and,
/// for a wider chart, one for wide screens; the style sheet shows one of them. Their classes are
/// those of the style sheet, including the palette. Marks at the same position are drawn once,
/// which limits the size for any number of points. Page scripts read the scales of the axes from
/// `data-x` and `data-y` (from, to, begin and end) and move the lines of class `here`.
std::string page_svg(const Chart& chart);

/// The legend of a chart in a page, with samples of its lines, marks and runs.
std::string legend_html(const Chart& chart);

/// A white SVG file with titles and legends: the charts row by row, `columns` per row. `charts`
/// must not be empty. Strings are escaped.
std::string svg_file(const std::vector<Chart>& charts, size_t columns = 1);

/// The same as the bytes of a PNG file.
std::string chart_png(const std::vector<Chart>& charts, size_t columns = 1);

/// Writes <file>.svg, <file>.pdf and <file>.png into the folder of an output (Output::temporary).
/// Throws Error(output).
void draw_chart(const Chart& chart, const std::filesystem::path& folder);
void draw_charts(const std::vector<Chart>& charts, size_t columns, const std::string& file,
                 const std::filesystem::path& folder);

/// Figures for a paper. `size_mm`: width and height, without a title, because papers have captions;
/// images keep their aspect ratio, and lanes their height.
struct FigureSettings {
  std::optional<std::pair<double, double>> size_mm;
  std::vector<double> limits;  ///< recall from, to, precision from, to; empty: 0 to 1
};

/// The chart with these settings. Limits belong to charts of precision and recall.
Chart in_figure(Chart chart, const FigureSettings& figure);

/// The file of charts of precision and recall.
inline constexpr std::string_view kPrecisionRecall = "precision-recall";

/// From values on an axis to units of the SVG.
struct AxisScale {
  double from = 0;  ///< the value at `begin`
  double to = 1;
  bool is_log = false;
  double begin = 0;
  double end = 1;

  double operator()(double value) const;
};

struct ChartArea {
  double left = 0;
  double top = 0;
  double width = 0;
  double height = 0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

struct LegendEntry {
  size_t series = 0;
  double x = 0;
  double y = 0;
};

/// In units of the SVG.
struct ChartLayout {
  double width = 0;  ///< of the whole
  double height = 0;
  ChartArea area;
  AxisScale x;
  AxisScale y;
  std::vector<ChartTick> x_ticks;
  std::vector<ChartTick> y_ticks;
  std::vector<LegendEntry> legend;
  double names_height = 0;       ///< of the names of the x axis's bands, above the plot
  double names_width = 0;        ///< of the names of the y axis's bands, right of the plot
  bool has_steep_names = false;  ///< rotated, because they would overlap
};

/// The approximate width of a text with letters of `size` units, in units of the SVG.
double text_width(const std::string& text, double size);

/// The text, truncated with an ellipsis if it is wider than `width`.
std::string shortened(const std::string& text, double width);

/// The axis's own range or, if it has none, one that shows all finite `values` with a margin; for
/// logarithmic axes between values of 1, 2 and 5 times a power of ten. Without values, it is 0 to 1
/// or 1 to 10.
std::pair<double, double> range_of(const ChartAxis& axis, const std::vector<double>& values);

/// At most about `most` ticks, 1, 2 or 5 times a power of ten apart; for logarithmic axes at 1, 2
/// and 5 times powers of ten, or only at powers of ten.
std::vector<ChartTick> ticks_of(bool is_log, const std::pair<double, double>& range, size_t most);

/// The smallest of 1, 2, 5, 10, 20, ... that divides `length` into at most `most` parts; `most` is
/// at least 1.
size_t round_step(size_t length, size_t most);

/// `for_page`: without title and legend.
ChartLayout layout_of(const Chart& chart, bool for_page);

/// The bytes of a PNG file. `image`: gray, BGR or BGR with alpha, 8 bits.
std::string png_of(const cv::Mat& image);

/// The bytes of a PNG file with an SVG file, rendered by librsvg on white with `zoom` pixels per
/// unit. The SVG cannot open other files. Throws Error(internal) if the text is not an SVG, or too
/// large.
std::string png_of_svg(const std::string& svg, double zoom);
/// The same as the bytes of a PDF file of vectors with embedded fonts, without a date.
std::string pdf_of_svg(const std::string& svg);

}  // namespace vpr
