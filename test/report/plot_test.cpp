#include "report/plot.h"

#include <atomic>
#include <cmath>

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "base/error.h"
#include "report/evaluation_plots.h"
#include "report/frame_axis.h"
#include "report/framed_picture.h"
#include "report/palette.h"
#include "report/route_map.h"
#include "report/scores_report.h"
#include "report/sweep_file.h"

using namespace vpr;

namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string script_of(const Plot& plot) { return plot_script({plot}, 1, "out"); }

/// Windows of 3 frames; queries 2 to 9, right, wrong or ignored as the letters say; capital
/// letters are recognised.
Judgement walk(const std::string& letters) {
  Judgement judgement;
  ScoreLayout& layout = judgement.layout;
  layout.window_length = 3;
  layout.scope = {letters.size() + 2, {{"monday", 30, true}, {"friday", 20, true}}};
  layout.columns = {{0, 0, 28}, {1, 28, 18}};
  judgement.fixes.assign(layout.scope.query_frames, Fix::none);
  judgement.outcomes.window_length = 3;
  judgement.outcomes.query_frames = layout.scope.query_frames;
  for (size_t q = 0; q < letters.size(); ++q) {
    const bool is_right = letters[q] == 'r' || letters[q] == 'R';
    QueryOutcome query;
    query.frame = layout.anchor(q);
    query.verdict = is_right ? Verdict::correct : Verdict::incorrect;
    query.best = FrameMatch{is_right ? 0u : 1u, query.frame};
    query.key = score_key(double(q), ScoreOrder::distance);
    judgement.outcomes.queries.push_back(query);
    if (letters[q] == 'R') judgement.fixes[query.frame] = Fix::right;
    if (letters[q] == 'W') judgement.fixes[query.frame] = Fix::wrong;
  }
  judgement.single_best = single_best_curve(judgement.outcomes);
  return judgement;
}

GroundTruth aligned(const Judgement& judgement) {
  GroundTruth truth;
  for (uint32_t frame = 0; frame < judgement.layout.scope.query_frames; ++frame)
    truth.pairs.push_back({{0, frame}});
  return truth;
}

Json report_of(const Judgement& judgement, const GroundTruth& truth) {
  return scores_report_json({"mine", {}, 3, {}}, "it's", judgement, truth, "xxh3:0", {});
}

const PlotLine* find(const Plot& plot, Meaning meaning) {
  for (const PlotLine& line : plot.lines)
    if (line.name == colour_of(meaning).words) return &line;
  return nullptr;
}

}  // namespace

TEST_CASE("frames of several sequences stand one behind the other, with round ticks") {
  const std::vector<FrameBand> bands = frame_bands(walk("rr").layout);
  REQUIRE(bands.size() == 2);
  CHECK(bands[1].name == "friday");
  CHECK(bands[1].at == 30);
  CHECK(length_of(bands) == 50);
  CHECK(position_of(bands, {1, 7}) == 37);
  const std::vector<AxisTick> ticks = ticks_of(bands, 5);
  std::vector<size_t> frames;
  for (const AxisTick& tick : ticks) frames.push_back(tick.frame);
  CHECK(frames == std::vector<size_t>{0, 10, 20, 0, 10});
  CHECK(ticks[3].position == 30.5);
  const std::vector<FrameBand> columns = column_bands(walk("rr").layout);
  CHECK(columns[1].at == 28);
  CHECK(columns[1].first_frame == 2);
  CHECK(position_of(columns, {1, 2}) == 28);
  CHECK(round_step(0, 5) == 1);
  CHECK(round_step(50, 5) == 10);
  CHECK(round_step(51, 5) == 10);
  CHECK(round_step(100, 8) == 20);
  CHECK(ticks_of({}, 5).empty());
}

TEST_CASE("of two ticks that are near each other, a band's first stays") {
  const std::vector<AxisTick> ticks = ticks_of({{"a", 0, 0, 0, 21}, {"b", 1, 21, 0, 20}}, 4);
  std::vector<double> positions;
  for (const AxisTick& tick : ticks) positions.push_back(tick.position);
  CHECK(positions == std::vector<double>{0.5, 10.5, 21.5, 31.5});
}

TEST_CASE("ticks of an axis cost what they show") {
  const std::vector<AxisTick> ticks = ticks_of({{"a", 0, 0, 7, size_t{1} << 60}}, 5);
  REQUIRE(ticks.size() > 3);
  CHECK(ticks[0].frame == 7);
  CHECK(ticks[1].frame == 200000000000000000);
}

TEST_CASE("a timeline has the palette's colours by meaning, and the ground truth") {
  const Judgement judgement = walk("rRwWrRRR");
  const GroundTruth truth = aligned(judgement);
  const Plot plot = timeline_plot(report_of(judgement, truth), judgement, truth);
  for (const Meaning meaning :
       {Meaning::right, Meaning::wrong, Meaning::weak_right, Meaning::weak_wrong, Meaning::truth}) {
    REQUIRE(find(plot, meaning) != nullptr);
    CHECK(find(plot, meaning)->colour == hex_of(meaning));
  }
  CHECK(find(plot, Meaning::unjudged) == nullptr);
  CHECK(find(plot, Meaning::right)->points.size() == 4);
  CHECK(find(plot, Meaning::wrong)->points[0] == std::pair(5.5, 35.5));  // frame 5 of friday
  CHECK(find(plot, Meaning::truth)->points.size() == 20);
  CHECK(find(plot, Meaning::truth)->points[3] == std::pair(2.0, 2.0));
  const std::string script = script_of(plot);
  CHECK(has(script, "set label 'friday' at graph 0.01, first 30"));
  CHECK(has(script, "set xrange [0:10]"));
  CHECK(has(script, "set title 'mine on it''s'"));
  CHECK(has(script, "background '#ffffff'"));
  CHECK(has(script, "set key below"));
  // The same colours where nothing is wrong.
  const Judgement right = walk("RR");
  CHECK(find(timeline_plot(report_of(right, truth), right, truth), Meaning::right)->colour ==
        hex_of(Meaning::right));
}

TEST_CASE("a matrix has axes in frames, a legend and, of scores, a scale") {
  const Judgement judgement = walk("rRwWrRRR");
  const GroundTruth truth = aligned(judgement);
  Plot plot = matrix_plot(report_of(judgement, truth), judgement, truth, nullptr, {});
  REQUIRE(plot.image);
  CHECK(plot.image->rgb.size() == 3 * plot.image->width * plot.image->height);
  CHECK(plot.x_ticks.front().text == "2");  // the first window's anchor
  CHECK(plot.x_bands[1].name == "friday");
  CHECK(find(plot, Meaning::truth) != nullptr);
  const std::string script = script_of(plot);
  CHECK(has(script, "binary array=(46,8)"));
  CHECK(has(script, "set yrange [8:0]"));
  CHECK(has(script, "set output 'out.svg'"));
  CHECK(has(script, "set output 'out.png'"));
  CHECK_FALSE(has(script, "cbrange"));
  plot.image->greys = std::pair(3.0, 7.0);
  CHECK(has(script_of(plot), "set palette gray\nset cbrange [3:7]"));
  plot.image->greys = std::pair(7.0, 3.0);
  CHECK(has(script_of(plot), "set palette gray negative\nset cbrange [3:7]"));
}

TEST_CASE("correct against incorrect starts at zero and names thresholds") {
  Sweep sweep;
  sweep.query_name = "walk";
  for (const double threshold : {0.4, 0.5, 0.6}) {
    SequenceCellCounts cell;
    cell.window_length = 10;
    cell.distance_threshold = threshold;
    cell.counts.hits.correct = cell.counts.places.correct = static_cast<uint64_t>(threshold * 100);
    cell.counts.hits.incorrect = cell.counts.places.incorrect = threshold > 0.55 ? 9 : 0;
    sweep.sequence_cells.push_back(cell);
  }
  SequenceCellCounts automatic;
  automatic.window_length = 10;
  automatic.counts.hits = {45, 3, 0};
  sweep.sequence_cells.insert(sweep.sequence_cells.begin(), automatic);
  const Plot plot = sweep_plot(sweep);
  REQUIRE(plot.lines.size() == 1);
  std::vector<std::string> order;  // a gap has no label
  for (const std::string& label : plot.lines[0].labels) order.push_back(label);
  CHECK(order == std::vector<std::string>{"t_r 0.4", "t_r 0.5", "t_r 0.6", "", "t_r auto"});
  CHECK(std::isnan(plot.lines[0].points[3].first));
  const std::string script = script_of(plot);
  CHECK(has(script, "set xrange [0:1<*]"));
  CHECK(has(script, "\"t_r 0.4\""));
  CHECK(has(script, "\"t_r 0.6\""));
}

TEST_CASE("labels that would cover each other are left out") {
  Plot plot;
  plot.lines.push_back({"a", {{0, 100}, {0, 99}, {50, 100}}});
  plot.lines[0].labels = {"x", "y", "z"};
  thin_labels(plot);
  CHECK(plot.lines[0].labels == std::vector<std::string>{"x", "", "z"});
}

TEST_CASE("a map has a bar of metres, and places only of FAB-MAP") {
  RouteMap map;
  map.train = {{RoutePoint{0, 0, ""}, RoutePoint{40, 0, ""}}};
  map.query = {RoutePoint{0, 1, ""}, RoutePoint{20, 1, ""}, RoutePoint{40, 1, ""}};
  map.places = {{10, 0, ""}};
  MapPanel panel{"p", {Meaning::right, Meaning::missed, Meaning::unmapped}};
  Plot plot = route_plots(map, {panel}).front();
  CHECK(find(plot, Meaning::place) == nullptr);
  CHECK(find(plot, Meaning::train_path)->style == PlotStyle::wide_line);
  CHECK(find(plot, Meaning::train_path)->colour != find(plot, Meaning::unmapped)->colour);
  CHECK(find(plot, Meaning::right)->colour == hex_of(Meaning::right));
  CHECK(has(script_of(plot), "\"10 m\""));
  panel.shows_places = true;
  CHECK(find(route_plots(map, {panel}).front(), Meaning::place) != nullptr);
}

TEST_CASE("frames at which nothing can be recognised are not drawn as missed") {
  Judgement judgement = walk("rRwWrR");  // frames 0 and 1 end no window
  GroundTruth truth = aligned(judgement);
  const size_t frames = judgement.fixes.size();
  for (QueryOutcome& query : judgement.outcomes.queries) query.has_match = true;
  judgement.outcomes.queries[1].has_match = false;
  judgement.outcomes.queries[1].is_unreachable = true;
  const size_t elsewhere = judgement.outcomes.queries[1].frame;
  judgement.fixes.assign(frames, Fix::none);
  judgement.fixes.back() = Fix::right;
  const std::vector<Meaning> meanings = meanings_of(judgement, truth);
  REQUIRE(meanings.size() == frames);
  const size_t first = judgement.outcomes.queries.front().frame;
  for (size_t frame = 0; frame < frames; ++frame) {
    INFO(frame);
    const Meaning expected = frame == frames - 1                   ? Meaning::right
                             : frame < first || frame == elsewhere ? Meaning::unreachable
                                                                   : Meaning::missed;
    CHECK(meanings[frame] == expected);
  }
  truth.pairs.assign(frames, {});
  judgement.outcomes.queries[2].has_match = false;
  CHECK(meanings_of(judgement, truth)[judgement.outcomes.queries[2].frame] == Meaning::unmapped);
}

TEST_CASE("a map can be stopped") {
  RouteMap map;
  map.query = {RoutePoint{0, 1, "a"}, RoutePoint{20, 1, "b"}, RoutePoint{40, 1, "a"}};
  const MapPanel panel{"p", {Meaning::right, Meaning::missed, Meaning::unmapped}};
  CHECK(route_plots(map, {panel}).size() == 2);  // a plot a floor
  const std::atomic<bool> stop{true};
  Monitor monitor;
  monitor.stop = &stop;
  CHECK_THROWS_AS(route_plots(map, {panel}, monitor), Error);
}

TEST_CASE("a framed picture keeps its pixels and has margins on white") {
  const cv::Mat image(600, 600, CV_8UC3, cv::Scalar(1, 2, 3));
  PictureFrame frame{{{"monday", 0, 0, 19, 60}}, {{"", 0, 0, 19, 60}}, 10};
  const cv::Mat plain = framed(image, frame);
  CHECK(plain.rows > 600);
  CHECK(plain.at<cv::Vec3b>(0, plain.cols - 1) == cv::Vec3b(255, 255, 255));
  CHECK(plain.at<cv::Vec3b>(300, 300) == cv::Vec3b(1, 2, 3));
  frame.shown = {Meaning::right};
  frame.greys = std::pair(3.0, 7.0);
  const cv::Mat full = framed(image, frame);
  CHECK(full.rows > plain.rows);
  cv::Mat blue;
  cv::inRange(full, cv::Scalar(bgr_of(Meaning::right)), cv::Scalar(bgr_of(Meaning::right)), blue);
  CHECK(cv::countNonZero(blue) > 100);
}
