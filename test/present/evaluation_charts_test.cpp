#include "present/evaluation_charts.h"

#include <atomic>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "evaluate/report.h"
#include "judgments.h"
#include "loops/loops_report.h"
#include "present/chart.h"
#include "present/charts.h"
#include "present/matrix_chart.h"
#include "support.h"
#include "tune/sweep_report.h"

using namespace vpr;
using test::has;
using test::pixels_of;
using test::svg_of;

namespace {

Judgment walk(const std::string& letters) {
  return test::judgment_of(letters, 3, {{{"monday", 30}}, {{"friday", 20}}});
}

GroundTruth aligned(const Judgment& judgment) {
  GroundTruth truth;
  for (uint32_t frame = 0; frame < judgment.layout.scope.query.frames; ++frame)
    truth.pairs.push_back({{0, frame}});
  return truth;
}

Report report_of(const Judgment& judgment, const GroundTruth& truth) {
  Evaluation evaluation;
  evaluation.truth = truth;
  evaluation.judgment = judgment;
  evaluation.judgment.layout.scope.query.name = "it's";
  evaluation.scores = {"mine", {}, 3, {}};
  return report_of(evaluation, {});
}

const Series* find(const Chart& chart, Meaning meaning) {
  for (const Series& series : chart.series)
    if (series.meaning == meaning && series.name == color_of(meaning).words) return &series;
  return nullptr;
}

}  // namespace

TEST_CASE("frames of several sequences follow each other, with round ticks") {
  const std::vector<FrameBand> bands = frame_bands(walk("cc").layout);
  REQUIRE(bands.size() == 2);
  CHECK(bands[1].name == "friday");
  CHECK(bands[1].at == 30);
  CHECK(length_of(bands) == 50);
  CHECK(position_of(bands, {1, 7}) == 37);
  const std::vector<ChartTick> ticks = ticks_of(bands, 5);
  std::vector<std::string> frames;
  for (const ChartTick& tick : ticks) frames.push_back(tick.text);
  CHECK(frames == std::vector<std::string>{"0", "10", "20", "0", "10"});
  CHECK(ticks[3].at == 30.5);
  const std::vector<FrameBand> columns = column_bands(walk("cc").layout);
  CHECK(columns[1].at == 28);
  CHECK(columns[1].first == 2);
  CHECK(position_of(columns, {1, 2}) == 28);
  CHECK(round_step(0, 5) == 1);
  CHECK(round_step(50, 5) == 10);
  CHECK(round_step(51, 5) == 10);
  CHECK(round_step(100, 8) == 20);
  CHECK(ticks_of(std::vector<FrameBand>{}, 5).empty());
}

TEST_CASE("if two ticks are close, the first one of a band stays") {
  const std::vector<ChartTick> ticks = ticks_of({{"a", 0, 0, 0, 21}, {"b", 1, 21, 0, 20}}, 4);
  std::vector<double> positions;
  for (const ChartTick& tick : ticks) positions.push_back(tick.at);
  CHECK(positions == std::vector<double>{0.5, 10.5, 21.5, 31.5});
}

TEST_CASE("the cost of an axis depends on its visible ticks") {
  const std::vector<ChartTick> ticks = ticks_of({{"a", 0, 0, 7, size_t{1} << 60}}, 5);
  REQUIRE(ticks.size() > 3);
  CHECK(ticks[0].text == "7");
  CHECK(ticks[1].text == "200000000000000000");
}

TEST_CASE("a timeline uses the palette's colors by meaning, and shows the ground truth") {
  const Judgment judgment = walk("cCwWcCCC");
  const GroundTruth truth = aligned(judgment);
  const Chart chart = timeline_chart(report_of(judgment, truth), judgment, truth);
  for (const Meaning meaning : {Meaning::correct, Meaning::incorrect, Meaning::weak_correct,
                                Meaning::weak_incorrect, Meaning::truth})
    REQUIRE(find(chart, meaning) != nullptr);
  CHECK(find(chart, Meaning::unjudged) == nullptr);
  CHECK(find(chart, Meaning::correct)->points.size() == 4);
  CHECK(find(chart, Meaning::incorrect)->points[0] == std::pair(5.5, 35.5));  // frame 5 of friday
  CHECK(find(chart, Meaning::truth)->points.size() == 20);
  CHECK(find(chart, Meaning::truth)->points[3] == std::pair(2.0, 2.0));
  CHECK(chart.y.bands[1].text == "friday");
  CHECK(chart.y.bands[1].at == 30);
  CHECK(chart.x.range == std::pair(0.0, 10.0));
  // Frame 3 is correct, frame 5 incorrect, and 7 to 9 are correct again.
  std::vector<std::pair<double, double>> runs;
  for (const ChartStretch& run : chart.runs) runs.emplace_back(run.begin, run.end);
  CHECK(runs == std::vector<std::pair<double, double>>{{3, 4}, {5, 6}, {7, 10}});
  CHECK(chart.runs[1].meaning == Meaning::incorrect);
  const std::string svg = svg_of(chart);
  CHECK(has(svg, ">mine on it&#39;s</text>"));
  CHECK(has(svg, ">friday</text>"));
  CHECK(has(svg, ">recognized, incorrect</text>"));  // in the legend
  // A page has its own title, legend and colors.
  const std::string page = page_svg(chart);
  CHECK(has(page, "<svg class=\"timeline wide\""));
  CHECK(has(page, "<svg class=\"timeline narrow\""));
  CHECK_FALSE(has(page, ">recognized, incorrect</text>"));
  CHECK_FALSE(has(page, "<style>"));
  CHECK(has(page, "class=\"here\""));
  CHECK(has(legend_html(chart), "recognized, incorrect"));
}

TEST_CASE("recall over the tolerance counts matches that are correct at each tolerance") {
  Judgment judgment = walk("cccc");
  GroundTruth truth = aligned(judgment);
  judgment.outcomes.queries[3].best->reference += 4;
  const Chart chart = tolerance_chart(report_of(judgment, truth), judgment, truth);
  std::vector<double> shares;
  for (const auto& [tolerance, share] : chart.series.at(0).points) {
    CHECK(tolerance == double(shares.size()));
    shares.push_back(share);
  }
  REQUIRE(shares.size() == 11);
  const double frame = 1 / double(judgment.single_best.positives);
  for (size_t t = 0; t < 11; ++t) CHECK(shares[t] == Approx((t < 4 ? 3 : 4) * frame));
  truth.is_known = false;
  CHECK(tolerance_chart(report_of(judgment, truth), judgment, truth).series.empty());
}

TEST_CASE("curves are steps, so that nothing is interpolated") {
  Curve curve;
  curve.positives = 4;
  curve.points = {{1, 1, 0, 0}, {2, 1, 0, 1}, {3, 2, 1, 1}};  // precisions 1, 1/2, 2/3
  using Points = std::vector<std::pair<double, double>>;
  CHECK(curve_points(curve) ==
        Points{{0, 1}, {0.25, 1}, {0.25, 0.5}, {0.25, 2.0 / 3}, {0.5, 2.0 / 3}});
}

TEST_CASE("frames off are the distance to the closest frame of the same place") {
  GroundTruth truth;
  truth.pairs = {{{0, 4, PlaceLabel::same, 2}, {0, 9}, {1, 3}}, {{0, 7, PlaceLabel::ignore}}, {}};
  truth.tolerance_frames = 5;  // without effect
  const auto off = [&](size_t frame, uint32_t sequence, size_t reference) {
    QueryOutcome query;
    query.frame = frame;
    query.best = {sequence, reference};
    return frames_off(truth, query);
  };
  CHECK(off(0, 0, 1) == -3);
  CHECK(off(0, 0, 4) == 0);
  CHECK(off(0, 0, 6) == 0);
  CHECK(off(0, 0, 8) == -1);
  CHECK(off(0, 0, 12) == 3);
  CHECK(off(0, 1, 12) == 9);
  CHECK(off(0, 2, 3) == std::nullopt);
  CHECK(off(1, 0, 7) == std::nullopt);  // ignored
  CHECK(off(2, 0, 7) == std::nullopt);
  CHECK(frames_off(truth, {}) == std::nullopt);  // no best match
}

TEST_CASE("lines between training sequences are in the legend") {
  const Judgment judgment = walk("CwCW");
  const GroundTruth truth = aligned(judgment);
  const Chart chart = timeline_chart(report_of(judgment, truth), judgment, truth);
  CHECK(has(legend_html(chart), "border of sequences"));
  CHECK(has(svg_file({chart}), ">border of sequences</text>"));
  const Judgment one = test::judgment_of("CwCW", 3, {{{"monday", 30}}});
  CHECK_FALSE(has(legend_html(timeline_chart(report_of(one, truth), one, truth)), "border"));
}

TEST_CASE("a chart of frames off has the recognitions, unless none is off") {
  const Judgment judgment = walk("CwCW");
  GroundTruth truth = aligned(judgment);
  CHECK(frames_off_chart(report_of(judgment, truth), judgment, truth).series.empty());
  for (uint32_t frame = 0; frame < truth.pairs.size(); ++frame)
    truth.pairs[frame].push_back({1, frame + 2});
  const Chart chart = frames_off_chart(report_of(judgment, truth), judgment, truth);
  REQUIRE(chart.series.size() == 2);
  using Points = std::vector<std::pair<double, double>>;
  CHECK(find(chart, Meaning::correct)->points == Points{{2.5, 0}, {4.5, 0}});
  CHECK(find(chart, Meaning::incorrect)->points == Points{{5.5, -2}});
  CHECK(chart.y.range == std::pair(-2.0, 2.0));
}

TEST_CASE("a matrix has axes in frames, a legend and, for scores, a scale") {
  const Judgment judgment = walk("cCwWcCCC");
  const GroundTruth truth = aligned(judgment);
  Chart chart = matrix_chart(judgment, truth, PixelGrid(judgment.layout, 100), {}, "training frame",
                             {"distance"}, {});
  CHECK(chart.x.ticks.front().text == "2");  // the first window's anchor
  CHECK(chart.x.bands[1].text == "friday");
  CHECK(chart.y.range == std::pair(8.0, 0.0));
  CHECK(chart.image->columns == 46);
  CHECK(chart.image->width == 46 * 14);  // pixels are enlarged by integers,
  CHECK(chart.image->height == 8 * 19);  // so that both sides are visible
  CHECK(find(chart, Meaning::truth_outline) != nullptr);
  CHECK_FALSE(has(svg_of(chart), "distance"));
  chart.image->grays = std::pair(3.0, 7.0);
  chart.image->gray_label = "distance";
  CHECK(has(svg_of(chart), ">distance</text>"));
  CHECK_FALSE(has(page_svg(chart), ">distance</text>"));  // in the page's legend
  CHECK(has(legend_html(chart), "distance"));
  CHECK(has(svg_of(chart), ">7</text>"));
}

TEST_CASE("a matrix shows scores and ground truth, with recognitions on top") {
  Judgment judgment = walk("cccccccc");
  judgment.layout.columns = {{0, 0, 28}};
  judgment.layout.scope.sequences.resize(1);
  judgment.recognized = {{2, {0, 2}}, {3, {0, 7}}};  // right, and wrong
  const GroundTruth truth = aligned(judgment);
  RowPixels pixels(judgment.layout, 2000);
  std::vector<uint32_t> row(27);
  for (uint32_t x = 0; x < 27; ++x) row[x] = 1000 + x;
  for (size_t window = 0; window < 8; ++window) pixels({window, 0, 0, row});
  const std::vector<double> scores = pixels.scores(1000);
  CHECK(scores[0] == 0);
  CHECK(scores[26] == 26);
  CHECK(std::isnan(scores[27]));  // no row arrived
  const Chart chart =
      matrix_chart(judgment, truth, pixels.grid(), scores, "training frame", {"z", 2}, {});
  const cv::Mat drawn = pixels_of(chart_png({chart}));
  const ChartLayout layout = layout_of(chart, false);
  const auto at = [&](int x, int y) {  // the middle of a cell
    return drawn.at<cv::Vec3b>(static_cast<int>(layout.y(y + 0.5)),
                               static_cast<int>(layout.x(x + 0.5)));
  };
  CHECK(at(0, 0) == bgr_of(Meaning::correct));
  CHECK(at(5, 1) == bgr_of(Meaning::incorrect));
  CHECK(at(3, 3)[0] == at(3, 3)[2]);      // the score is visible inside the outline,
  CHECK(at(3, 3) == at(3, 7));            // as outside it
  CHECK(at(0, 7) == cv::Vec3b(0, 0, 0));  // the smallest distance is black
  CHECK(at(26, 0) == cv::Vec3b(255, 255, 255));
  CHECK(at(20, 0)[0] - at(10, 0)[0] == Approx(at(11, 0)[0] - at(1, 0)[0]).margin(1));  // linear
  CHECK(at(27, 0)[0] != at(27, 0)[2]);  // no score has a separate color
  CHECK(test::count_of(drawn, Meaning::truth_outline) > 100);
  CHECK(chart.image->grays == std::pair(0.0, 26 / 2.0));  // in the unit; 1 % are clipped
  CHECK(has(chart.image->gray_label, "the worst 1 % are clipped"));
  REQUIRE(chart.series.size() == 3);  // the outline below recognized cells
  CHECK(chart.series[0].meaning == Meaning::truth_outline);
}

TEST_CASE("charts and pages show scores per frame, in plain words") {
  const SequenceQuerySettings settings;
  const SequenceQuerySettings scored{Threshold{{.score = Score::zscore}}};
  const auto unit = [](const QuerySettings& of_query, size_t window_length) {
    const ScoreUnit found = score_unit(of_query, window_length);
    return std::pair(found.words, found.divisor);
  };
  CHECK(unit(settings, 10) == std::pair(std::string("mean distance"), 10.0));
  CHECK(unit(settings, 1) == std::pair(std::string("distance"), 1.0));
  CHECK(unit(scored, 10) == std::pair(std::string("mean z-score"), 10240.0));
  CHECK(unit(SequenceQuerySettings{Filter{}}, 1) ==
        std::pair(std::string("path score in deviations"), 1024.0));
  CHECK(unit(FabmapQuerySettings{}, 1) == std::pair(std::string("probability"), 1.0));
}

TEST_CASE("the outline of a ground truth leaves room in an image with small pixels") {
  Judgment judgment = walk("cccccccc");
  judgment.layout.scope.sequences = {{{"a", 1000}, true}};
  judgment.layout.columns = {{0, 0, 998}};
  const GroundTruth truth = aligned(judgment);
  const Chart chart =
      matrix_chart(judgment, truth, PixelGrid(judgment.layout, 1000), {}, "training frame", {}, {});
  REQUIRE(chart.series.size() == 1);
  CHECK(chart.series[0].points[4].first == 0);  // cell 2, three cells before it, cut at 0
  CHECK(chart.series[0].points[5].first == 6);
}

TEST_CASE("a pixel shows the closest of its cells, for any partition of rows") {
  ScoreLayout layout;
  layout.scope = {{"", 6}, {{{"a", 4}, true}, {{"b", 5}, true}}};
  layout.columns = {{0, 0, 4}, {1, 4, 5}};
  RowPixels pixels(layout, 3);  // pixels of 3 x 3 cells
  REQUIRE(pixels.grid().cells == 3);
  pixels({0, 0, 1, std::vector<uint32_t>{9, 8, 7}});
  pixels({2, 0, 0, std::vector<uint32_t>{6}});
  pixels({5, 1, 0, std::vector<uint32_t>{5, 4, 3, 2, 1}});
  const std::vector<double> scores = pixels.scores(0);
  REQUIRE(scores.size() == 6);
  CHECK(scores[0] == 6);
  CHECK(scores[1] == 7);
  CHECK(std::isnan(scores[2]));
  CHECK(std::isnan(scores[3]));
  CHECK(scores[4] == 4);
  CHECK(scores[5] == 1);
}

TEST_CASE("the chart of correct against incorrect is logarithmic, with 0, and names thresholds") {
  Sweep sweep;
  sweep.query.name = "walk";
  for (const double threshold : {0.4, 0.5, 0.6}) {
    CellCounts cell;
    cell.window = 10;
    cell.threshold = threshold;
    cell.counts.recognitions.correct = static_cast<uint64_t>(threshold * 100);
    cell.counts.recognitions.incorrect = threshold > 0.55 ? 9 : 0;
    sweep.cells.push_back(cell);
  }
  CellCounts automatic;
  automatic.window = 10;
  automatic.counts.recognitions = {45, 3, 0};
  sweep.cells.insert(sweep.cells.begin(), automatic);
  const Chart chart = sweep_chart(sweep);
  REQUIRE(chart.series.size() == 1);
  std::vector<std::string> order;  // a gap has no label
  for (const std::string& label : chart.series[0].labels) order.push_back(label);
  CHECK(order == std::vector<std::string>{"t_r 0.4", "t_r 0.5", "t_r 0.6", "", "t_r auto"});
  CHECK(std::isnan(chart.series[0].points[3].first));
  CHECK(chart.x.is_log);
  CHECK(chart.x.ticks.front().text == "0");
  CHECK(chart.series[0].points[0].first == chart.x.ticks.front().at);
  CHECK(chart.series[0].points[2] == std::pair(9.0, 60.0));
  CHECK(layout_of(chart, false).y.from == 0);
  const std::string svg = svg_of(chart);
  CHECK(has(svg, ">t_r 0.4</text>"));
  CHECK(has(svg, ">t_r 0.6</text>"));
}

TEST_CASE("a map has a scale bar in meters, and places only for FAB-MAP") {
  RouteMap map;
  map.train = {{RoutePoint{0, 0, ""}, RoutePoint{40, 0, ""}}};
  map.query = {RoutePoint{0, 1, ""}, RoutePoint{20, 1, ""}, RoutePoint{40, 1, ""}};
  map.places = {{10, 0, ""}};
  MapPanel panel{"p", {Meaning::correct, Meaning::missed, Meaning::unmapped}};
  const Chart chart = route_charts(map, {panel}).front();
  CHECK(find(chart, Meaning::place) == nullptr);
  CHECK(find(chart, Meaning::train_path)->style == SeriesStyle::wide_line);
  CHECK(find(chart, Meaning::unmapped)->points.size() == 1);
  CHECK(find(chart, Meaning::correct)->points.size() == 1);
  CHECK(has(svg_of(chart), ">10 m</text>"));
  const ChartLayout layout = layout_of(chart, false);  // a meter has the same length on both axes
  CHECK(layout.x(10) - layout.x(0) == Approx(layout.y(0) - layout.y(10)));
  panel.shows_places = true;
  CHECK(find(route_charts(map, {panel}).front(), Meaning::place) != nullptr);
}

TEST_CASE("frames without a match are not drawn as missed") {
  Judgment judgment = walk("cCwWcC");
  GroundTruth truth = aligned(judgment);
  truth.pairs[3].clear();
  judgment.verdicts.assign(judgment.verdicts.size(), Verdict::none);
  judgment.verdicts.back() = Verdict::correct;
  const std::vector<Meaning> meanings = meanings_of(judgment, truth);
  REQUIRE(meanings.size() == judgment.verdicts.size());
  CHECK(meanings[0] == Meaning::missed);  // no window ends there, which is the method's choice
  CHECK(meanings[3] == Meaning::unmapped);
  CHECK(meanings[4] == Meaning::missed);
  CHECK(meanings.back() == Meaning::correct);
}

TEST_CASE("a map can be stopped") {
  RouteMap map;
  map.query = {RoutePoint{0, 1, "a"}, RoutePoint{20, 1, "b"}, RoutePoint{40, 1, "a"}};
  const MapPanel panel{"p", {Meaning::correct, Meaning::missed, Meaning::unmapped}};
  CHECK(route_charts(map, {panel}).size() == 2);  // one chart per floor
  const std::atomic<bool> stop{true};
  Monitor monitor;
  monitor.stop = &stop;
  CHECK_THROWS_AS(route_charts(map, {panel}, monitor), Error);
}

TEST_CASE("risk against coverage, and accepted matches by threshold, equal those counted by hand") {
  Judgment judgment = walk("cCwc");
  const Report report = report_of(judgment, aligned(judgment));
  const Chart chart = risk_chart(report, judgment);
  REQUIRE(chart.series.size() == 1);
  CHECK(chart.series[0].points ==
        std::vector<std::pair<double, double>>{{0.25, 0}, {0.5, 0}, {1, 0.25}});
  const auto steps = threshold_steps(report, judgment, 100);
  REQUIRE(steps.size() == 4);
  CHECK(steps[1].accepted == std::array<size_t, 3>{2, 0, 0});
  CHECK(steps[2].threshold == 2);
  CHECK(steps[3].accepted == std::array<size_t, 3>{3, 1, 0});
  // Equal scores are accepted together.
  judgment.outcomes.at_window(2).key = judgment.outcomes.at_window(1).key;
  CHECK(threshold_steps(report, judgment, 100)[1].accepted == std::array<size_t, 3>{2, 1, 0});
  const auto thinned = threshold_steps(report, judgment, 1);
  CHECK(thinned.back().accepted == std::array<size_t, 3>{3, 1, 0});
}

TEST_CASE("a map with very many loops draws some and reports so") {
  LoopsEvaluation evaluation;
  for (int frame = 0; frame < 10'000; ++frame)
    evaluation.trajectory.poses.push_back(Pose{{0.01 * frame, 0.0001 * frame, 0}, {}, {}});
  evaluation.judgment.has_loop.resize(10'000);
  evaluation.judgment.is_found.resize(10'000);
  const auto wrong_lines = [&](size_t loops) {
    evaluation.judgment.loops.clear();
    for (size_t i = 0; i < loops; ++i) {
      JudgedLoop judged;
      judged.loop.query = 9'999 - i;
      evaluation.judgment.loops.push_back(judged);
    }
    for (const Series& series : loops_map_chart(evaluation).series)
      if (series.name.starts_with("incorrect loop"))
        return std::pair(series.name, series.points.size());
    return std::pair(std::string(), size_t{0});
  };
  CHECK(wrong_lines(2000) == std::pair(std::string("incorrect loop"), size_t{3 * 2000}));
  CHECK(wrong_lines(5000) ==
        std::pair(std::string("incorrect loop (2000 of 5000)"), size_t{3 * 2000}));
}
