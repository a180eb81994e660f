#include "report/svg_charts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "report/metrics_report.h"
#include "report/score_picture.h"
#include "report/svg_text.h"
#include "report/timeline.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 400;
constexpr size_t kMostTruth = 465;  // frames whose ground truth is drawn
constexpr PlotArea kCurveArea = {60, 34, 560, 360};
constexpr double kLineTop = 30;
constexpr double kLineHeight = 300;
constexpr double kBarTop = 344;
constexpr double kBarHeight = 16;
constexpr double kMatrixLeft = 70;
constexpr double kMatrixTop = 54;
constexpr double kLeastMatrix = 600;  // a side of the matrix, at least
constexpr double kMostMatrix = 800;

std::string name_of(Meaning meaning) { return std::string(colour_of(meaning).name); }

std::string line_path(Meaning meaning, const std::vector<std::pair<double, double>>& shares) {
  std::string path;
  for (const auto& [x, y] : shares)
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : " L",
                        kCurveArea.left + kCurveArea.width * x,
                        kCurveArea.bottom() - kCurveArea.height * y);
  if (path.empty()) return "";
  return fmt::format("<path class=\"line {}\" d=\"{}\"/>", name_of(meaning), path);
}

std::string curve_path(const Curve& curve, Meaning meaning) {
  std::vector<std::pair<double, double>> shares;
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    shares.emplace_back(curve.recall(point), Curve::precision(point));
  return line_path(meaning, shares);
}

std::string chart_begin(const std::string& kind, const std::string& label, double width,
                        double height) {
  return fmt::format("<svg class=\"{}\" viewBox=\"0 0 {:g} {:g}\" role=\"img\" aria-label=\"{}\">",
                     kind, width, height, label);
}

// Runs of frames with the same fix.
std::string fix_bar(const std::vector<Fix>& fixes, const TimelineFrame& frame) {
  const double scale = frame.plot_width / std::max<double>(1, static_cast<double>(fixes.size()));
  std::string svg;
  for (size_t begin = 0; begin < fixes.size();) {
    size_t end = begin;
    while (end < fixes.size() && fixes[end] == fixes[begin]) ++end;
    if (fixes[begin] != Fix::none)
      svg += svg_rect(name_of(meaning_of(fixes[begin])),
                      frame.left + scale * static_cast<double>(begin), kBarTop,
                      std::max(0.6, scale * static_cast<double>(end - begin)), kBarHeight);
    begin = end;
  }
  return svg;
}

/// Frames and positions to pixels.
struct Scale {
  PlotArea area;
  double frames;
  double positions;
  double x(double frame) const { return area.left + area.width * frame / frames; }
  double y(double position) const { return area.bottom() - area.height * position / positions; }
};

std::string truth_marks(const std::vector<TruthBox>& boxes, const Scale& scale) {
  SvgMarks marks(name_of(Meaning::truth));
  for (const TruthBox& box : boxes) {
    const double x = scale.x(static_cast<double>(box.begin));
    const double y = scale.y(static_cast<double>(box.high));
    marks.add(x, y, std::max(1.0, scale.x(static_cast<double>(box.end)) - x),
              std::max(2.0, scale.y(static_cast<double>(box.low)) - y));
  }
  return marks.svg();
}

std::string match_marks(const std::vector<TimelineMark>& marks, const Scale& scale) {
  std::string svg;
  for (const Meaning meaning : kMarkOrder) {
    SvgMarks kind(name_of(meaning));
    const double size = is_weak(meaning) ? 5 : 7;
    for (const TimelineMark& mark : marks)
      if (mark.meaning == meaning)
        kind.add(scale.x(static_cast<double>(mark.frame) + 0.5) - size / 2,
                 scale.y(static_cast<double>(mark.position) + 0.5) - size / 2, size, size);
    svg += kind.svg();
  }
  return svg;
}

// Ticks, and the names of bands inside, where there is room for them.
std::string band_axis(const std::vector<FrameBand>& bands, const Scale& scale) {
  std::string svg;
  for (const AxisTick& tick : ticks_of(bands, 8))
    svg += svg_y_tick(scale.area, tick.position / scale.positions, std::to_string(tick.frame));
  double named_at = 1e9;
  for (const FrameBand& band : bands) {
    const double y = scale.y(static_cast<double>(band.at));
    if (band.at > 0)
      svg += fmt::format("<path class=\"border\" d=\"M{:.1f} {:.1f}h{:.1f}\"/>", scale.area.left, y,
                         scale.area.width);
    if (named_at - y < 18) continue;
    svg += svg_text(scale.area.left + 6, y - 6, "start", band.name, "name");
    named_at = y;
  }
  return svg;
}

/// A row of how many best matches a threshold accepts.
struct Accepted {
  double threshold = 0;
  std::array<size_t, 3> counts = {};  // by kAccepted
};
constexpr std::array<Meaning, 3> kAccepted = {Meaning::right, Meaning::wrong, Meaning::unjudged};

std::vector<Accepted> accepted_by_threshold(const Outcomes& outcomes, double divisor) {
  std::vector<const QueryOutcome*> order;
  for (const QueryOutcome& query : outcomes.queries)
    if (query.best && std::isfinite(score_of_key(query.key, outcomes.kind)))
      order.push_back(&query);
  std::stable_sort(order.begin(), order.end(),
                   [](const QueryOutcome* a, const QueryOutcome* b) { return a->key < b->key; });
  std::vector<Accepted> rows;
  std::array<size_t, 3> counts = {};
  for (const QueryOutcome* query : order) {
    ++counts[query->verdict == Verdict::correct ? 0 : query->verdict == Verdict::incorrect ? 1 : 2];
    rows.push_back({score_of_key(query->key, outcomes.kind) / divisor, counts});
  }
  return rows;
}

// As many as have `room` pixels each.
size_t most_ticks(double pixels, double room) {
  return std::max<size_t>(1, static_cast<size_t>(pixels / room));
}

std::string column_axis(const std::vector<FrameBand>& bands, const PlotArea& area) {
  const double length = std::max<double>(1, static_cast<double>(length_of(bands)));
  std::string svg;
  for (const AxisTick& tick : ticks_of(bands, most_ticks(area.width, 60)))
    svg += svg_text(area.left + area.width * tick.position / length, area.bottom() + 20, "middle",
                    std::to_string(tick.frame));
  double named_until = -1e9;
  for (const FrameBand& band : bands) {
    const double x = area.left + area.width * static_cast<double>(band.at) / length;
    if (x < named_until) continue;
    svg += svg_text(x, area.top - 6, "start", band.name, "name");
    named_until = x + 9 * static_cast<double>(band.name.size());
  }
  return svg;
}

std::string grey_scale(const PlotArea& area, const std::pair<double, double>& greys,
                       const std::string& score_words) {
  const double y = area.bottom() + 62;
  return fmt::format(
             "<defs><linearGradient id=\"greys\"><stop stop-color=\"#000\"/><stop offset=\"1\" "
             "stop-color=\"#fff\"/></linearGradient></defs><rect class=\"greys\" "
             "fill=\"url(#greys)\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"12\"/>",
             area.left, y, area.width) +
         svg_text(area.left, y + 30, "start", fmt::format("{:.4g}", greys.first)) +
         svg_text(area.left + area.width / 2, y + 30, "middle", score_words) +
         svg_text(area.right(), y + 30, "end", fmt::format("{:.4g}", greys.second));
}

}  // namespace

std::string curve_svg(const Judgement& judgement) {
  std::string svg = chart_begin("curve", "precision against recall", 650, 450);
  for (int tick = 0; tick <= 5; ++tick) {
    const double share = tick / 5.0;
    svg += svg_x_tick(kCurveArea, share, fmt::format("{:.1f}", share));
    svg += svg_y_tick(kCurveArea, share, fmt::format("{:.1f}", share));
  }
  svg += svg_axis_titles(kCurveArea, "recall", "precision");
  if (judgement.all_pairs) svg += curve_path(judgement.all_pairs->curve, Meaning::all_pairs);
  return svg + curve_path(judgement.single_best, Meaning::best_matches) + "</svg>";
}

std::string threshold_svg(const Judgement& judgement, const ScoreAxis& axis) {
  std::string svg = chart_begin("curve", "best matches accepted by a threshold", 650, 450);
  const std::vector<Accepted> rows = accepted_by_threshold(judgement.outcomes, axis.divisor);
  const double strict = rows.empty() ? 0 : rows.front().threshold;
  const double loose = rows.empty() ? 1 : rows.back().threshold;
  size_t most = 1;
  for (const size_t count : rows.empty() ? std::array<size_t, 3>{} : rows.back().counts)
    most = std::max(most, count);
  const size_t step = round_step(most, 6);
  for (size_t count = 0; count <= most; count += step)
    svg += svg_y_tick(kCurveArea, static_cast<double>(count) / static_cast<double>(most),
                      std::to_string(count));
  for (int tick = 0; tick <= 4; ++tick)
    svg += svg_x_tick(kCurveArea, tick / 4.0,
                      fmt::format("{:.4g}", strict + (loose - strict) * tick / 4.0));
  svg += svg_axis_titles(kCurveArea, "up to " + axis.label, "best matches accepted");
  const size_t thinning = std::max<size_t>(1, rows.size() / kMostPoints);
  for (size_t kind = 0; kind < kAccepted.size(); ++kind) {
    if (rows.empty() || rows.back().counts[kind] == 0) continue;
    std::vector<std::pair<double, double>> shares;
    for (size_t i = 0; i < rows.size(); ++i)
      if (i % thinning == 0 || i + 1 == rows.size())
        shares.emplace_back(loose == strict ? 1 : (rows[i].threshold - strict) / (loose - strict),
                            static_cast<double>(rows[i].counts[kind]) / static_cast<double>(most));
    svg += line_path(kAccepted[kind], shares);
  }
  return svg + "</svg>";
}

std::string timeline_svg(const Judgement& judgement, const GroundTruth& truth,
                         const std::string& reference_word, const TimelineFrame& frame,
                         const Monitor& monitor) {
  const std::vector<FrameBand> bands = frame_bands(judgement.layout);
  const size_t frames = judgement.fixes.size();
  const Scale scale{{frame.left, kLineTop, frame.plot_width, kLineHeight},
                    std::max<double>(1, static_cast<double>(frames)),
                    std::max<double>(1, static_cast<double>(length_of(bands)))};
  std::string svg = chart_begin("timeline", "best match of every query frame", frame.width, 406);
  svg += truth_marks(truth_boxes(judgement, truth, bands, kMostTruth, monitor), scale);
  svg += band_axis(bands, scale);
  svg += match_marks(timeline_marks(judgement, bands), scale);
  svg += fix_bar(judgement.fixes, frame);
  svg += fmt::format(
      "<line id=\"here\" class=\"here\" x1=\"0\" x2=\"0\" y1=\"{}\" y2=\"{}\" "
      "visibility=\"hidden\"/>",
      kLineTop, kBarTop + kBarHeight);
  svg += svg_text(frame.left - 7, kBarTop + 13, "end", "fixes");
  for (const AxisTick& tick : ticks_of({{"", 0, 0, 0, frames}}, 10))
    svg += svg_text(scale.x(tick.position), kBarTop + 34, "middle", std::to_string(tick.frame));
  svg += svg_text(frame.left + frame.plot_width / 2, kBarTop + 56, "middle", "query frame");
  svg += svg_text(frame.left, kLineTop - 10, "start", reference_word);
  return svg + "</svg>";
}

std::string matrix_svg(const Judgement& judgement, const ScorePicture& picture,
                       const std::string& png, const std::string& reference_word,
                       const std::string& score_words) {
  const std::vector<FrameBand> bands = column_bands(judgement.layout);
  const double columns = std::max<double>(1, static_cast<double>(length_of(bands)));
  const std::vector<FrameBand> row_band = row_bands(judgement.layout);
  const double rows = std::max<double>(1, static_cast<double>(length_of(row_band)));
  const double pixel =
      std::clamp(std::max(rows, columns), kLeastMatrix, kMostMatrix) / std::max(rows, columns);
  const PlotArea area{kMatrixLeft, kMatrixTop, columns * pixel, rows * pixel};
  const auto cells = static_cast<double>(picture.cells);
  const double height = area.bottom() + (picture.greys ? 104 : 56);
  // As wide as on the screen, so that a small matrix is not blown up.
  std::string svg = fmt::format(
      "<svg class=\"matrix\" style=\"max-width:{0:.0f}px\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "role=\"img\" aria-label=\"queries against references\">",
      std::max(kLeastMatrix, area.right()) + 30, height);
  svg += fmt::format(
      "<clipPath id=\"area\">{}</clipPath><image clip-path=\"url(#area)\" x=\"{:.1f}\" "
      "y=\"{:.1f}\" "
      "width=\"{:.1f}\" height=\"{:.1f}\" preserveAspectRatio=\"none\" "
      "href=\"data:image/png;base64,{}\"/>",
      svg_rect("frame", area.left, area.top, area.width, area.height), area.left, area.top,
      picture.image.cols * cells * pixel, picture.image.rows * cells * pixel, png);
  svg += svg_rect("frame", area.left, area.top, area.width, area.height);
  for (const AxisTick& tick : ticks_of(row_band, most_ticks(area.height, 40)))
    svg += svg_text(area.left - 7, area.top + area.height * tick.position / rows + 5, "end",
                    std::to_string(tick.frame));
  svg += column_axis(bands, area);
  svg += svg_text(area.left, kMatrixTop - 34, "start", "query frame, downwards");
  svg += svg_text(area.left, area.bottom() + 42, "start", reference_word);
  if (picture.greys) svg += grey_scale(area, *picture.greys, score_words);
  return svg + "</svg>";
}

}  // namespace vpr
