#include "present/chart.h"

#include <set>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "present/charts.h"
#include "support.h"
#include "tune/sweep_report.h"

using namespace vpr;
using test::count_of;
using test::has;
using test::pixels_of;
using test::svg_of;

TEST_CASE("a heat map has a cell for every setting, darker for more frames") {
  Sweep sweep;
  sweep.query.name = "walk";
  for (const double threshold : {0.4, 0.5}) {
    CellCounts cell;
    cell.window = 10;
    cell.threshold = threshold;
    cell.path.correct = threshold > 0.45 ? 100 : 25;
    cell.path.incorrect = threshold > 0.45 ? 4 : 0;
    sweep.cells.push_back(cell);
  }
  const cv::Mat image = pixels_of(heat_map_png({sweep}));
  CHECK(count_of(image, Meaning::correct) > 1000);
  CHECK(count_of(image, Meaning::incorrect) > 1000);
  const cv::Vec3b full = bgr_of(Meaning::correct);  // a quarter of the frames: half the shade
  const cv::Scalar half((255 + full[0]) / 2, (255 + full[1]) / 2, (255 + full[2]) / 2);
  cv::Mat found;
  cv::inRange(image, half - cv::Scalar::all(1), half + cv::Scalar::all(1), found);
  CHECK(cv::countNonZero(found) > 1000);
}

TEST_CASE("counts of a heat map have at most four characters, and cells have room for them") {
  CHECK(short_count(0) == "0");
  CHECK(short_count(999) == "999");
  CHECK(short_count(1000) == "1.0k");
  CHECK(short_count(9940) == "9.9k");
  CHECK(short_count(9960) == "10k");
  CHECK(short_count(131'104) == "131k");
  CHECK(short_count(999'499) == "999k");
  CHECK(short_count(999'500) == "1.0M");
  CHECK(short_count(1'049'767) == "1.0M");
  Sweep sweep;
  for (uint64_t window = 1; window <= 5; ++window)
    for (int t = 0; t < 21; ++t) {
      CellCounts cell;
      cell.window = window;
      cell.threshold = t;
      sweep.cells.push_back(cell);
    }
  const cv::Mat image = pixels_of(heat_map_png({sweep}));
  CHECK(image.cols > 2 * 5 * 100);
  CHECK(image.cols < 2 * 5 * 150);
  CHECK(image.rows > 21 * 22);
}

TEST_CASE("overlapping labels are omitted") {
  Chart chart{"c", "t"};
  chart.series.push_back({"a", {{0, 100}, {0, 99}, {0, 98}, {50, 100}}});
  chart.series[0].labels = {"first", "second", "hidden", "third"};
  const std::string svg = svg_of(chart);
  CHECK(has(svg, ">first<"));
  CHECK(has(svg, ">second<"));  // below its point
  CHECK_FALSE(has(svg, ">hidden<"));
  CHECK(has(svg, ">third<"));
}

TEST_CASE("labels cover neither points nor labels of other series") {
  Chart chart{"c", "t"};
  chart.series.push_back({"a", {{0, 0}, {100, 100}}});
  chart.series.push_back({"b", {{50, 50}, {52, 51}, {52, 49}, {48, 51}, {48, 49}}});
  chart.series[1].labels = {"surrounded", "", "", "free", ""};
  const std::string svg = svg_of(chart);
  CHECK_FALSE(has(svg, ">surrounded<"));
  CHECK(has(svg, ">free<"));
}

TEST_CASE("lines without a meaning differ in dashes and marks, also in legends") {
  Chart chart{"c", "t"};
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    chart.series.push_back({name, {{0, 0}, {1, 1}}});
    chart.series.push_back({name, {{0, 0}, {1, 1}}, SeriesStyle::line});
  }
  std::set<std::string> dashes;
  const std::string legend = legend_html(chart);
  for (size_t at = legend.find("stroke-dasharray:"); at != std::string::npos;
       at = legend.find("stroke-dasharray:", at + 1))
    dashes.insert(legend.substr(at, legend.find('"', at) - at));
  CHECK(dashes.size() == 4);  // and a solid line
}

TEST_CASE("an outline is the border of its boxes' union, row by row") {
  Chart chart{"c", ""};
  chart.x.range = chart.y.range = {0, 4};
  chart.y.range = {4, 0};
  chart.series.push_back({"",
                          {{0, 0}, {2, 1}, {1, 1}, {3, 2}, {0, 3}, {1, 4}},
                          SeriesStyle::outline,
                          Meaning::truth_outline});
  const ChartLayout layout = layout_of(chart, false);
  const auto line = [&](double x, double y, char way, double end) {
    return fmt::format("M{:.1f} {:.1f}{}{:.1f}", layout.x(x), layout.y(y), way,
                       way == 'V' ? layout.y(end) : layout.x(end));
  };
  const std::string svg = svg_of(chart);
  for (const std::string& part :
       {line(0, 0, 'V', 1), line(2, 0, 'V', 1), line(0, 0, 'H', 2), line(0, 1, 'H', 1),
        line(2, 1, 'H', 3), line(1, 2, 'H', 3), line(0, 3, 'H', 1), line(0, 4, 'H', 1)})
    CHECK(has(svg, part));
  CHECK_FALSE(has(svg, line(1, 1, 'H', 2)));  // inside
}

TEST_CASE("on a phone, ticks that would overlap are omitted") {
  Chart chart{"c", "t"};
  chart.series.push_back({"a", {{0, 0}, {20000, 1}}});
  for (int at = 0; at <= 20000; at += 2000)
    chart.x.ticks.push_back({double(at), std::to_string(at)});
  CHECK(layout_of(chart, true).x_ticks.size() == 11);
  chart.width = 360;
  const ChartLayout narrow = layout_of(chart, true);
  CHECK(narrow.x_ticks.size() > 3);
  for (size_t i = 1; i < narrow.x_ticks.size(); ++i)
    CHECK(narrow.x(narrow.x_ticks[i].at) - narrow.x(narrow.x_ticks[i - 1].at) >
          (text_width(narrow.x_ticks[i].text, 13) + text_width(narrow.x_ticks[i - 1].text, 13)) /
              2);
}

TEST_CASE("ranges are those of the values with a small margin") {
  CHECK(range_of({}, {}) == std::pair(0.0, 1.0));
  CHECK(range_of({"", true}, {}) == std::pair(1.0, 10.0));
  CHECK(range_of({"", false, true}, {50, 100}) == std::pair(0.0, 104.0));
  CHECK(range_of({}, {100, 200}).first == Approx(97));
  CHECK(range_of({}, {7, 7}).second > 7);
  CHECK(range_of({"", true}, {3, 700}) == std::pair(2.0, 1000.0));
  CHECK(range_of({"", true}, {0.5, 0.5}) == std::pair(0.5, 1.0));
  ChartAxis fixed;
  fixed.range = {5, 1};
  CHECK(range_of(fixed, {7}) == std::pair(5.0, 1.0));
}

TEST_CASE("ticks are round numbers") {
  const auto texts = [](bool is_log, double from, double to, size_t most) {
    std::string text;
    for (const ChartTick& tick : ticks_of(is_log, {from, to}, most)) text += tick.text + " ";
    return text;
  };
  CHECK(texts(false, 0, 1, 5) == "0 0.2 0.4 0.6 0.8 1 ");
  CHECK(texts(false, 8, 0, 4) == "0 2 4 6 8 ");
  CHECK(texts(false, -0.3, 0.35, 3) == "0 ");
  CHECK(texts(false, -30, 35, 7) == "-30 -20 -10 0 10 20 30 ");
  CHECK(texts(true, 0.5, 200, 9) == "0.5 1 2 5 10 20 50 100 200 ");
  CHECK(texts(true, 0.5, 200, 8) == "1 10 100 ");
  CHECK(texts(true, 2, 5, 1) == "2 5 ");
}

TEST_CASE("names of any length leave room for the plot") {
  Chart chart{"c", "t"};
  chart.series.push_back({"a", {{0, 0}, {1, 1}}});
  chart.y.ticks = {{1, "short"}, {0.5, std::string(20000, 'x')}, {0, "äöü" + std::string(99, 'y')}};
  const ChartLayout layout = layout_of(chart, true);
  CHECK(layout.area.width > 100);
  CHECK(layout.x_ticks.size() < 10);
  CHECK(layout.y_ticks[0].text == "short");
  CHECK(layout.y_ticks[1].text.ends_with("xx…"));
  CHECK(layout.y_ticks[2].text.starts_with("äöüyy"));
  CHECK(text_width(layout.y_ticks[1].text, 13) <= chart.width * 0.6);
  CHECK(text_width(layout.y_ticks[2].text, 13) == text_width(layout.y_ticks[1].text, 13));
}

TEST_CASE("charts are drawn in rows and columns, also empty ones") {
  Chart chart{"c", "first"};
  const auto height = [](const std::vector<Chart>& charts, size_t columns) {
    const cv::Mat image = pixels_of(chart_png(charts, columns));
    CHECK(image.at<cv::Vec3b>(image.rows - 1, image.cols - 1) == cv::Vec3b(255, 255, 255));
    return std::pair(image.cols, image.rows);
  };
  CHECK(height({chart}, 1) == std::pair(1200, 720));
  CHECK(height({chart, chart, chart}, 2) == std::pair(2400, 1440));
  chart.series.push_back({"empty", {}});
  chart.series.push_back({"gap", {kChartGap}});
  chart.y.is_log = true;
  CHECK(height({chart}, 1) == std::pair(1200, 720));
}

TEST_CASE("every style and mark of a series has its color in the image") {
  for (const SeriesStyle style : {SeriesStyle::line, SeriesStyle::wide_line, SeriesStyle::boxes,
                                  SeriesStyle::line_and_points, SeriesStyle::outline}) {
    Chart chart{"c", "t"};
    chart.series = {series_of(Meaning::incorrect, style)};
    chart.series[0].points = {{0, 0}, {1, 1}};
    CHECK(count_of(pixels_of(chart_png({chart})), Meaning::incorrect) > 100);
  }
  for (const SeriesMark mark : {SeriesMark::disc, SeriesMark::dot, SeriesMark::square,
                                SeriesMark::cross, SeriesMark::circle, SeriesMark::triangle}) {
    Chart chart{"c", "t"};
    chart.series = {series_of(Meaning::incorrect, SeriesStyle::points, mark)};
    chart.series[0].name.clear();
    for (int i = 0; i < 50; ++i) chart.series[0].points.emplace_back(i, i);
    chart.series[0].points.push_back(kChartGap);
    CHECK(count_of(pixels_of(chart_png({chart})), Meaning::incorrect) > 50);
  }
}

TEST_CASE("figures for papers have a size and limits, and no title") {
  Chart chart{"precision-recall", "a title"};
  chart.series.push_back({"a", {{0, 1}, {0.5, 0.9}, {1, 0.2}}});
  CHECK(has(svg_of(chart), "a title"));
  const Chart figure = in_figure(chart, {{{127, 63.5}}, {0.25, 1, 0.5, 1}});
  const std::string svg = svg_of(figure);
  CHECK(has(svg, "width=\"480\" height=\"240\""));
  CHECK_FALSE(has(svg, "a title"));
  CHECK(has(svg, ">0.6<"));
  CHECK_FALSE(has(svg, ">0<"));
  const ChartLayout at = layout_of(figure, false);
  CHECK(at.x.from == 0.25);
  CHECK(at.y.from == 0.5);
  CHECK(at.area.top == 8);
  // The line is cut at the limits.
  CHECK(has(svg, fmt::format("<svg x=\"{:.1f}\" y=\"{:.1f}\"", at.area.left, at.area.top)));
  CHECK_FALSE(has(svg_of(chart), "<svg x="));
  CHECK(svg_of(in_figure(chart, {})) == svg_of(chart));
}

TEST_CASE("a small figure has room for its curves below a long legend, and an image its width") {
  Chart chart{"timeline", "a title"};
  for (const std::string name : {"query frame (bar: recognized)", "ground truth (width: tolerance)",
                                 "correct best match", "incorrect best match", "ignored", "path"})
    chart.series.push_back({name, {{0, 0}, {110, 110}}});
  const Chart figure = in_figure(chart, {{{85, 60}}, {}});
  CHECK(has(svg_of(figure), "width=\"321.26\" height=\"22"));
  const ChartLayout at = layout_of(figure, false);
  CHECK(at.area.height > 200);
  CHECK(at.height == Approx(figure.height));
  CHECK(at.y_ticks.size() > 2);
  chart.image = chart_image(cv::Mat(111, 111, CV_8UC1, cv::Scalar(0)), 1);
  chart.x.range = {0, 111};
  chart.y.range = {111, 0};
  CHECK(has(svg_of(in_figure(chart, {{{85, 60}}, {}})), "width=\"321.26\""));
}

TEST_CASE("invalid SVG cannot be drawn, and hostile titles are text") {
  CHECK(test::error_kind([] { png_of_svg("not an SVG", 1); }) == ErrorKind::internal);
  Chart chart{"c", "<script>alert(1)</script> & \"so\" \x01\xff"};
  chart.series.push_back({"<b>", {{1, 1}}});
  CHECK_FALSE(has(svg_of(chart), "<script>"));
  CHECK_FALSE(has(svg_of(chart), "<b>"));
  CHECK_FALSE(chart_png({chart}).empty());
}

TEST_CASE("images are complete, or an error") {
  Chart chart{"line", "t"};
  chart.series.push_back({"a", {{0, 1}, {1, 2}}});
  draw_chart(chart, ".");
  CHECK(test::list_folder(".") == std::vector<std::string>{"line.pdf", "line.png", "line.svg"});
  CHECK(test::read_text("line.svg").ends_with("</svg>\n"));
  const std::string pdf = test::read_text("line.pdf");
  CHECK(pdf.starts_with("%PDF-"));
  CHECK(pdf.ends_with("%%EOF\n"));
  if (!has(pdf, "/ObjStm"))                        // cairo 1.18 compresses objects
    CHECK(has(pdf, "/MediaBox [ 0 0 675 405 ]"));  // 900 x 540 units
  CHECK_FALSE(has(pdf, "CreationDate"));
  CHECK_FALSE(pixels_of(test::read_text("line.png")).empty());
  CHECK(test::error_kind([&] { draw_chart(chart, "none"); }) == ErrorKind::output);
}
