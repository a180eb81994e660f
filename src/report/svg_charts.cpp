#include "report/svg_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "report/html_text.h"
#include "report/metrics_report.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 400;
constexpr double kCurveLeft = 60;
constexpr double kCurveTop = 15;
constexpr double kCurveWidth = 560;
constexpr double kCurveHeight = 380;
constexpr double kLineTop = 10;
constexpr double kLineHeight = 300;
constexpr double kBarTop = 322;
constexpr double kBarHeight = 16;
constexpr double kTruthStep = 2;  // marks of the ground truth are this far apart

std::string text_at(double x, double y, const std::string& anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x, y, anchor,
                     html_escaped(text));
}

std::string curve_path(const Curve& curve, const std::string& kind) {
  std::string path;
  const auto add = [&](double recall, double precision) {
    path +=
        fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : " L", kCurveLeft + kCurveWidth * recall,
                    kCurveTop + kCurveHeight * (1 - precision));
  };
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    add(curve.recall(point), Curve::precision(point));
  if (path.empty()) return "";
  return fmt::format("<path class=\"line {}\" d=\"{}\"/>", kind, path);
}

/// Small squares of one class, no two on the same spot.
class Marks {
 public:
  Marks(std::string kind, double size) : kind_(std::move(kind)), size_(size) {}
  void add(double x, double y) {
    if (!seen_.insert({std::lround(x), std::lround(y)}).second) return;
    path_ +=
        fmt::format("M{:.1f} {:.1f}h{}v{}h-{}z", x - size_ / 2, y - size_ / 2, size_, size_, size_);
  }
  std::string svg() const {
    return path_.empty() ? "" : fmt::format("<path class=\"{}\" d=\"{}\"/>\n", kind_, path_);
  }

 private:
  std::string kind_;
  double size_;
  std::set<std::pair<long, long>> seen_;
  std::string path_;
};

/// Frames and columns to pixels.
struct Scale {
  double left, width, frames, columns;
  double x(size_t frame) const {
    return left + width * (static_cast<double>(frame) + 0.5) / frames;
  }
  double y(size_t column) const {
    return kLineTop + kLineHeight * (1 - (static_cast<double>(column) + 0.5) / columns);
  }
};

size_t column_of(const ScoreLayout& layout, const FrameMatch& match) {
  for (const ScoreLayout::Columns& columns : layout.columns)
    if (columns.sequence == match.sequence)
      return columns.first + match.reference + 1 - layout.window_length;
  return 0;
}

std::string truth_marks(const Judgement& judgement, const GroundTruth& truth, const Scale& scale) {
  Marks marks("truth", 4);
  std::vector<PlaceLabel> labels;
  double last_x = -1e9;
  for (size_t row = 0; row < row_count(judgement.layout); ++row) {
    const double x = scale.x(judgement.layout.anchor(row));
    if (x - last_x < kTruthStep) continue;
    last_x = x;
    label_row(truth, judgement.layout, row, labels);
    for (size_t c = 0; c < labels.size(); ++c)
      if (labels[c] == PlaceLabel::same) marks.add(x, scale.y(c));
  }
  return marks.svg();
}

std::string match_marks(const Judgement& judgement, const Scale& scale) {
  // Weak ones first: what is recognised covers them.
  std::array<Marks, 4> marks = {Marks("weak-wrong", 3), Marks("weak-right", 3), Marks("wrong", 5),
                                Marks("right", 5)};
  for (const QueryOutcome& query : judgement.outcomes.queries) {
    if (!query.best || query.verdict == Verdict::ignored) continue;
    const bool is_right = query.verdict == Verdict::correct;
    marks[(is_recognised(judgement, query) ? 2 : 0) + (is_right ? 1 : 0)].add(
        scale.x(query.frame), scale.y(column_of(judgement.layout, *query.best)));
  }
  std::string svg;
  for (const Marks& kind : marks) svg += kind.svg();
  return svg;
}

// Runs of frames with the same fix.
std::string fix_bar(const Judgement& judgement, const Scale& scale) {
  const auto& fixes = judgement.fixes;
  std::string svg;
  for (size_t begin = 0; begin < fixes.size();) {
    size_t end = begin;
    while (end < fixes.size() && fixes[end] == fixes[begin]) ++end;
    if (fixes[begin] != Fix::none)
      svg += fmt::format(
          "<rect class=\"{}\" x=\"{:.2f}\" y=\"{}\" width=\"{:.2f}\" height=\"{}\"/>",
          fixes[begin] == Fix::right ? "right" : "wrong",
          scale.left + scale.width * static_cast<double>(begin) / scale.frames, kBarTop,
          std::max(0.6, scale.width * static_cast<double>(end - begin) / scale.frames), kBarHeight);
    begin = end;
  }
  return svg;
}

}  // namespace

std::string curve_svg(const Judgement& judgement) {
  std::string svg =
      "<svg class=\"curve\" viewBox=\"0 0 640 460\" role=\"img\" aria-label=\"precision against "
      "recall\">";
  for (int tick = 0; tick <= 5; ++tick) {
    const double share = tick / 5.0;
    const double x = kCurveLeft + kCurveWidth * share;
    const double y = kCurveTop + kCurveHeight * (1 - share);
    svg +=
        fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}V{:.1f}M{:.1f} {:.1f}H{:.1f}\"/>", x,
                    kCurveTop, kCurveTop + kCurveHeight, kCurveLeft, y, kCurveLeft + kCurveWidth);
    svg += text_at(x, kCurveTop + kCurveHeight + 18, "middle", fmt::format("{:.1f}", share));
    svg += text_at(kCurveLeft - 8, y + 4, "end", fmt::format("{:.1f}", share));
  }
  svg += text_at(kCurveLeft + kCurveWidth / 2, kCurveTop + kCurveHeight + 38, "middle", "recall");
  svg += fmt::format(
      "<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\">precision"
      "</text>",
      kCurveTop + kCurveHeight / 2);
  if (judgement.all_pairs) svg += curve_path(judgement.all_pairs->curve, "pairs");
  svg += curve_path(judgement.single_best, "single");
  const double y = kCurveTop + kCurveHeight + 56;
  svg += fmt::format("<path class=\"line single\" d=\"M{0} {1}h30\"/>", kCurveLeft, y - 4);
  svg += text_at(kCurveLeft + 38, y, "start", "best matches");
  if (judgement.all_pairs) {
    svg += fmt::format("<path class=\"line pairs\" d=\"M{0} {1}h30\"/>", kCurveLeft + 220, y - 4);
    svg += text_at(kCurveLeft + 258, y, "start", "all pairs");
  }
  return svg + "</svg>";
}

std::string timeline_svg(const Judgement& judgement, const GroundTruth& truth,
                         const TimelineFrame& frame) {
  const size_t columns = column_count(judgement.layout);
  const size_t frames = judgement.fixes.size();
  const Scale scale{frame.left, frame.plot_width, std::max<double>(1, double(frames)),
                    std::max<double>(1, double(columns))};
  std::string svg = fmt::format(
      "<svg class=\"timeline\" viewBox=\"0 0 {} 380\" role=\"img\" aria-label=\"best match of "
      "every "
      "query frame\">",
      frame.width);
  svg += fmt::format("<path class=\"axis\" d=\"M{} {}V{}H{}\"/>", frame.left, kLineTop,
                     kLineTop + kLineHeight, frame.left + frame.plot_width);
  for (const ScoreLayout::Columns& sequence : judgement.layout.columns)
    if (sequence.first > 0)
      svg += fmt::format("<path class=\"axis\" d=\"M{} {:.1f}h{}\"/>", frame.left,
                         kLineTop + kLineHeight * (1 - double(sequence.first) / scale.columns),
                         frame.plot_width);
  svg += truth_marks(judgement, truth, scale) + match_marks(judgement, scale);
  svg += fix_bar(judgement, scale);
  svg += fmt::format(
      "<line id=\"here\" class=\"here\" x1=\"0\" x2=\"0\" y1=\"{}\" y2=\"{}\" "
      "visibility=\"hidden\"/>",
      kLineTop, kBarTop + kBarHeight);
  svg += text_at(frame.left - 6, kBarTop + 13, "end", "fixes");
  svg += text_at(frame.left, 358, "start", "0");
  svg += text_at(frame.left + frame.plot_width, 358, "end",
                 fmt::format("{}", frames == 0 ? 0 : frames - 1));
  svg += text_at(frame.left + frame.plot_width / 2, 358, "middle", "query frame");
  svg += fmt::format(
      "<text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">reference</text>",
      kLineTop + kLineHeight / 2);
  svg += text_at(frame.left - 6, kLineTop + kLineHeight, "end", "0");
  svg += text_at(frame.left - 6, kLineTop + 10, "end",
                 fmt::format("{}", columns == 0 ? 0 : columns - 1));
  return svg + "</svg>";
}

}  // namespace vpr
