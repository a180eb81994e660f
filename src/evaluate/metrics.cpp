#include "evaluate/metrics.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "base/statistics.h"

namespace vpr {
namespace {

double recall_of(const QueryOutcome& query, size_t k) {
  return query.verdict == Verdict::correct || (query.rank && *query.rank <= k) ? 1 : 0;
}

double precision_of(const QueryOutcome& query, size_t k) {
  const auto correct = std::ranges::count_if(query.correct_ranks, [&](auto r) { return r <= k; });
  return static_cast<double>(correct) / static_cast<double>(k);
}

// AP@K: the sum of precision@i over the ranks i <= K of correct references, divided by min(K,
// correct references of the query).
double average_precision_of(const QueryOutcome& query, size_t k) {
  double sum = 0;
  size_t correct = 0;
  for (const uint8_t rank : query.correct_ranks)
    if (rank <= k) sum += static_cast<double>(++correct) / static_cast<double>(rank);
  return sum / static_cast<double>(std::min<size_t>(k, std::max<size_t>(1, query.correct_count)));
}

// AP over the correct items that have a score, instead of all positives.
MetricValue average_precision_of_correct(const Curve& curve) {
  if (!curve.is_measurable() || curve.points.empty() || curve.points.back().correct == 0) return {};
  const double scale =
      static_cast<double>(curve.positives) / static_cast<double>(curve.points.back().correct);
  return {*average_precision(curve).value * scale, {}};
}

constexpr Metric of_curve(std::string_view key, std::string_view symbol, std::string_view meaning,
                          MetricValue (*compute)(const Curve&), bool is_low_good = false) {
  return {.key = key,
          .symbol = symbol,
          .meaning = meaning,
          .is_low_good = is_low_good,
          .of_curve = compute};
}

constexpr Metric of_counts(std::string_view key, JudgedBy needs, std::string_view symbol,
                           ValueOf<Counts> value) {
  return {.key = key, .symbol = symbol, .digits = 0, .needs = needs, .of_counts = value};
}

constexpr Metric of_best_match(std::string_view key, ValueOf<BestMatchCounts> value,
                               std::string_view symbol = {}) {
  return {.key = key, .symbol = symbol, .digits = 0, .of_best_match = value};
}

// Without a symbol in JSON only.
constexpr Metric of_path(std::string_view key, JudgedBy needs, ValueOf<Localization> value,
                         std::string_view symbol = {}, std::string_view meaning = {},
                         bool is_low_good = true, int digits = 0) {
  return {.key = key,
          .symbol = symbol,
          .meaning = meaning,
          .is_low_good = is_low_good,
          .digits = digits,
          .needs = needs,
          .of_path = value};
}

constexpr Metric described(Metric metric, std::string_view about) {
  metric.about = about;
  return metric;
}

constexpr Metric brief(Metric metric) {
  metric.detail = TableDetail::brief;
  return metric;
}

constexpr Metric full(Metric metric) {
  metric.detail = TableDetail::full;
  return metric;
}

constexpr Metric kMetrics[] = {
    brief({.key = "recall_at",
           .symbol = "R@",
           .meaning = "share of queries with a correct reference among the K best",
           .title = "Recall@K",
           .is_share = true,
           .of_query = recall_of}),
    // Manning, Raghavan and Schuetze 2008, chapter 8.
    {.key = "precision_at",
     .symbol = "P@",
     .meaning = "share of correct references among the K best",
     .title = "Precision@K",
     .needs_all_ranks = true,
     .of_query = precision_of},
    // Weyand et al. 2020.
    {.key = "map_at",
     .symbol = "mAP@",
     .meaning = "mean precision at the correct references among the K best",
     .title = "mAP@K",
     .needs_all_ranks = true,
     .of_query = average_precision_of},
    brief(of_curve("average_precision", "AP",
                   "precision at every threshold, weighted by the recall it adds",
                   average_precision)),
    brief(of_curve("recall_at_100_precision", "R@100P", "recall before the first mistake",
                   recall_at_full_precision)),
    full(of_curve("max_f1", "max F1", "largest harmonic mean of precision and recall", max_f1)),
    of_curve("extended_precision", "EP", "mean of the best score's precision and R@100P",
             extended_precision),
    of_curve("roc_auc", "ROC AUC",
             "probability that a correct match scores better than an incorrect one", roc_auc),
    of_curve("risk_coverage_area", "AURC",
             "mean share of mistakes over all numbers of accepted matches; lower is better",
             risk_coverage_area, true),
    of_curve("average_precision_of_correct", "AP of correct",
             "AP with recall over the correct best matches, as scikit-learn normalizes",
             average_precision_of_correct),
    {.key = "recall_achievement",
     .symbol = "RAR ",
     .meaning = "share of stretches of the path with R@1 of r or more",
     .of_stretches = recall_achievement},
    described(of_path("frames", JudgedBy::nothing, &Localization::frames), "frames of the path"),
    described(of_path("recognized", JudgedBy::nothing, &Localization::recognized),
              "frames with a recognition, whatever its label"),
    described(of_path("recognized_share", JudgedBy::nothing, &Localization::recognized_share),
              "recognized / frames"),
    described(
        of_path("frames_with_match", JudgedBy::ground_truth, &Localization::frames_with_match),
        "frames of the path with a match in the ground truth"),
    brief(of_path("correct", JudgedBy::places, &Localization::correct, "correct",
                  "frames of the path with a correct recognition", false)),
    brief(of_path("incorrect", JudgedBy::places, &Localization::incorrect, "incorrect",
                  "frames of the path with an incorrect recognition")),
    brief(described(of_counts("pairs", JudgedBy::nothing, "pairs", &Counts::recognitions),
                    "accepted pairs, each judged by itself")),
    described(of_path("off_map", JudgedBy::ground_truth, &Localization::off_map),
              "incorrect frames without a match in the ground truth"),
    full({.key = "share",
          .symbol = "share",
          .meaning = "share of the frames with a match that are recognized correctly",
          .is_share = true,
          .needs = JudgedBy::places,
          .of_path = &Localization::share}),
    full(of_path("longest_gap_frames", JudgedBy::places, &Localization::longest_gap_frames,
                 "longest gap", "most consecutive frames without a correct recognition")),
    of_path("longest_gap_m", JudgedBy::places, &Localization::longest_gap_m, "longest gap m",
            "longest distance without a correct recognition, in meters", true, 2),
    brief(of_path("first_recognition_frames", JudgedBy::places,
                  &Localization::first_recognition_frames, "first",
                  "frames before the decision on the first correct recognition")),
    of_path("first_recognition_m", JudgedBy::places, &Localization::first_recognition_m, "first m",
            "distance before the decision on the first correct recognition, in meters", true, 2),
    described(of_counts("distinct", JudgedBy::places, "distinct", &Counts::distinct),
              "places recognized correctly at least once"),
    described(of_counts("pairs_by_cluster", JudgedBy::places, "pairs by place",
                        &Counts::recognitions_by_place),
              "accepted pairs by the verdict on their cluster; absent for FAB-MAP"),
    described(of_counts("clusters", JudgedBy::nothing, "places", &Counts::clusters),
              "clusters of recognitions"),
    described(of_counts("mixed_clusters", JudgedBy::ground_truth, "of these mixed",
                        &Counts::mixed_clusters),
              "correct places with incorrect recognitions: a place is judged by its mean"),
    described(of_best_match("best_match.frames", &BestMatchCounts::frames, "of frames"),
              "query frames with a match in the ground truth"),
    described(
        of_best_match("best_match.correct", &BestMatchCounts::correct, "best matches correct"),
        "frames whose best match is correct"),
    described(of_best_match("best_match.incorrect", &BestMatchCounts::incorrect),
              "frames whose best match is incorrect"),
    described(of_best_match("best_match.ignored", &BestMatchCounts::ignored),
              "frames whose best match is labeled ignore"),
    described(of_best_match("best_match.no_answer", &BestMatchCounts::no_answer),
              "frames with a match in the ground truth, without a best match"),
    described(of_best_match("best_match.without_match", &BestMatchCounts::without_match),
              "other frames"),
    {.key = "best_match.rate",
     .symbol = "%",
     .about = "correct / frames",
     .is_percent = true,
     .digits = 1,
     .of_best_match = &BestMatchCounts::rate}};

constexpr std::array<std::pair<std::string_view, uint64_t LabelCounts::*>, 3> kVerdicts = {
    {{"correct", &LabelCounts::correct},
     {"incorrect", &LabelCounts::incorrect},
     {"ignored", &LabelCounts::ignored}}};

uint32_t weight_of(const QueryOutcome& query, std::span<const uint32_t> weights) {
  return weights.empty() ? 1 : weights[query.frame];
}

// The rows for which this holds, which are consecutive.
template <class Condition>
std::span<const Metric> rows_with(const Condition& has) {
  const auto* first = std::ranges::find_if(kMetrics, has);
  return {first, std::find_if_not(first, std::end(kMetrics), has)};
}

}  // namespace

void sort_items(std::vector<ScoredItem>& items) { std::ranges::sort(items, {}, &ScoredItem::key); }

Curve curve_of(std::span<const ScoredItem> items, uint64_t positives, ScoreOrder kind) {
  Curve curve{kind, positives, {}};
  CurvePoint last;
  bool is_kept = true;
  for (size_t i = 0; i < items.size() && items[i].key != kNoScore;) {
    CurvePoint point{items[i].key, last.correct, last.incorrect, last.incorrect};
    for (; i < items.size() && items[i].key == point.key; ++i)
      (items[i].is_correct ? point.correct : point.incorrect) += items[i].weight;
    if (point.correct == last.correct && point.incorrect == last.incorrect) continue;
    is_kept = curve.points.empty() || point.correct > last.correct;
    if (is_kept) curve.points.push_back(point);
    last = point;
  }
  if (!is_kept) curve.points.push_back(last);
  return curve;
}

Curve single_best_curve(const Outcomes& outcomes, std::span<const uint32_t> weights) {
  std::vector<ScoredItem> items;
  uint64_t positives = 0;
  for (const QueryOutcome& query : outcomes.queries) {
    const uint32_t weight = weight_of(query, weights);
    if (query.has_match) positives += weight;
    if (is_judged(query))
      items.push_back(
          {confidence_key(query, outcomes.confidence), query.verdict == Verdict::correct, weight});
  }
  sort_items(items);
  Curve curve = curve_of(items, positives, confidence_order(outcomes));
  curve.has_scores = outcomes.has_scores;
  if (!curve.has_scores) curve.points.clear();
  return curve;
}

MetricValue average_precision(const Curve& curve) {
  if (!curve.is_measurable()) return {};
  double sum = 0;
  uint64_t before = 0;
  for (const CurvePoint& point : curve.points) {
    sum += static_cast<double>(point.correct - before) * Curve::precision(point);
    before = point.correct;
  }
  return {sum / static_cast<double>(curve.positives), {}};
}

MetricValue recall_at_full_precision(const Curve& curve) {
  if (!curve.is_measurable()) return {};
  MetricValue best{0, {}};
  for (const CurvePoint& point : curve.points) {
    if (point.incorrect > 0) break;
    best = {curve.recall(point), curve.threshold(point)};
  }
  return best;
}

MetricValue extended_precision(const Curve& curve) {
  if (!curve.is_measurable()) return {};
  if (curve.points.empty()) return {0, {}};
  const double at_least_recall = Curve::precision(curve.points.front());
  return {(at_least_recall + *recall_at_full_precision(curve).value) / 2, {}};
}

MetricValue max_f1(const Curve& curve) {
  if (!curve.is_measurable()) return {};
  MetricValue best{0, {}};
  for (const CurvePoint& point : curve.points) {
    const uint64_t accepted = point.correct + point.incorrect;
    const double f1 =
        2 * static_cast<double>(point.correct) / static_cast<double>(accepted + curve.positives);
    if (f1 > *best.value) best = {f1, curve.threshold(point)};
  }
  return best;
}

MetricValue roc_auc(const Curve& curve) {
  if (curve.points.empty()) return {};
  const auto incorrect = static_cast<double>(curve.points.back().incorrect);
  const auto correct = static_cast<double>(curve.points.back().correct);
  if (incorrect == 0 || correct == 0) return {};
  double better = 0;  // pairs (correct, incorrect) that are in order
  uint64_t before = 0;
  for (const CurvePoint& point : curve.points) {
    const auto entering = static_cast<double>(point.correct - before);
    const auto tied = static_cast<double>(point.incorrect - point.incorrect_before);
    const double worse = incorrect - static_cast<double>(point.incorrect);
    better += entering * (worse + tied / 2);
    before = point.correct;
  }
  return {better / (correct * incorrect), {}};
}

MetricValue risk_coverage_area(const Curve& curve) {
  if (!curve.is_measurable()) return {};
  double sum = 0;
  uint64_t accepted = 0;
  uint64_t mistakes = 0;
  uint64_t correct = 0;
  // Accepts items, `incorrect` ones among them, in random order.
  const auto accept = [&](uint64_t items, uint64_t incorrect) {
    const double share = static_cast<double>(incorrect) / static_cast<double>(items);
    for (uint64_t step = 1; step <= items; ++step)
      sum += (static_cast<double>(mistakes) + share * static_cast<double>(step)) /
             static_cast<double>(accepted + step);
    accepted += items;
    mistakes += incorrect;
  };
  for (const CurvePoint& point : curve.points) {
    const uint64_t before = point.incorrect_before - mistakes;
    accept(before, before);
    const uint64_t tied = point.incorrect - point.incorrect_before;
    accept(point.correct - correct + tied, tied);
    correct = point.correct;
  }
  return {share_of(sum, accepted), {}};
}

std::vector<std::pair<double, double>> risk_coverage_points(const Curve& curve) {
  std::vector<std::pair<double, double>> points;
  if (curve.points.empty()) return points;
  const auto all = static_cast<double>(curve.points.back().correct + curve.points.back().incorrect);
  for (const CurvePoint& point : curve.points)
    points.emplace_back(static_cast<double>(point.correct + point.incorrect) / all,
                        1 - Curve::precision(point));
  return points;
}

std::vector<std::optional<double>> local_recalls(const Outcomes& outcomes, size_t stretch_frames) {
  const size_t frames = outcomes.queries.size();
  const size_t count = std::max<size_t>(1, (frames + stretch_frames / 2) / stretch_frames);
  std::vector<double> found(count);
  std::vector<size_t> judged(count);
  for (const QueryOutcome& query : outcomes.queries) {
    if (!query.has_match) continue;
    // The stretch s holds frames from floor(s * frames / count) on.
    const size_t stretch = ((query.frame + 1) * count - 1) / frames;
    ++judged[stretch];
    found[stretch] += recall_of(query, 1);
  }
  std::vector<std::optional<double>> recalls;
  for (size_t s = 0; s < count; ++s) recalls.push_back(share_of(found[s], judged[s]));
  return recalls;
}

std::optional<double> recall_achievement(const std::vector<std::optional<double>>& recalls,
                                         double target) {
  size_t known = 0;
  size_t achieved = 0;
  for (const auto& recall : recalls) {
    if (!recall) continue;
    ++known;
    achieved += *recall >= target;
  }
  return share_of(achieved, known);
}

std::optional<double> Localization::share() const { return share_of(correct, frames_with_match); }

std::optional<double> Localization::recognized_share() const {
  return share_of(recognized, frames);
}

Localization localize(std::span<const Verdict> verdicts, std::span<const double> traveled_m,
                      std::span<const std::optional<uint32_t>> decided) {
  assert(traveled_m.empty() || traveled_m.size() == verdicts.size());
  Localization found;
  found.frames = verdicts.size();
  found.recognized = static_cast<size_t>(
      std::ranges::count_if(verdicts, [](auto one) { return one != Verdict::none; }));
  found.incorrect =
      static_cast<size_t>(std::count(verdicts.begin(), verdicts.end(), Verdict::incorrect));
  const bool has_meters = !traveled_m.empty();
  uint64_t gap_frames = 0;
  double gap_m = 0;
  size_t gap_begin = 0;  // first frame after the last correct recognition
  double last_correct_m = has_meters ? traveled_m.front() : 0;
  const auto end_gap = [&](size_t end, double here_m) {
    gap_frames = std::max<uint64_t>(gap_frames, end - gap_begin);
    if (has_meters) gap_m = std::max(gap_m, here_m - last_correct_m);
  };
  for (size_t frame = 0; frame < verdicts.size(); ++frame) {
    if (verdicts[frame] != Verdict::correct) continue;
    const double here_m = has_meters ? traveled_m[frame] : 0;
    if (found.correct == 0) {
      const size_t known = decided.empty() ? frame : decided[frame].value();
      found.first_recognition_frames = known;
      if (has_meters) found.first_recognition_m = traveled_m[known] - traveled_m.front();
    }
    ++found.correct;
    end_gap(frame, here_m);
    gap_begin = frame + 1;
    last_correct_m = here_m;
  }
  end_gap(verdicts.size(), has_meters ? traveled_m.back() : 0);
  found.longest_gap_frames = gap_frames;
  if (has_meters) found.longest_gap_m = gap_m;
  return found;
}

std::span<const Metric> metrics() { return kMetrics; }

std::span<const Metric> curve_metrics() {
  return rows_with([](const Metric& metric) { return metric.of_curve != nullptr; });
}

std::span<const Metric> rank_metrics() {
  return rows_with([](const Metric& metric) { return metric.of_query != nullptr; });
}

const Metric& find_metric(std::string_view key) {
  const auto found = std::ranges::find(kMetrics, key, &Metric::key);
  assert(found != std::end(kMetrics));
  return *found;
}

bool Metric::has_verdicts() const {
  return of_counts && (std::holds_alternative<LabelCounts Counts::*>(*of_counts) ||
                       std::holds_alternative<std::optional<LabelCounts> Counts::*>(*of_counts));
}

bool Metric::is_known_at(const Outcomes& outcomes, size_t k) const {
  if (k > outcomes.known_ranks) return false;
  return needs_all_ranks ? outcomes.has_ranks && k <= kMaxRank : outcomes.has_ranks || k == 1;
}

MetricAt metric_at(std::string_view key, size_t k) {
  const size_t dot = key.rfind('.');
  const auto* counts = std::ranges::find(kMetrics, key.substr(0, dot), &Metric::key);
  if (dot == std::string_view::npos || counts == std::end(kMetrics)) return {&find_metric(key), k};
  const auto* verdict =
      std::ranges::find(kVerdicts, key.substr(dot + 1), [](const auto& one) { return one.first; });
  assert(verdict != kVerdicts.end());
  return {counts, 0, verdict->second};
}

std::string MetricAt::key() const {
  return k == 0 ? std::string(metric->key) : fmt::format("{}_{}", metric->key, k);
}

std::string MetricAt::symbol() const {
  for (const auto& [name, counted] : kVerdicts)
    if (counted == verdict) return fmt::format("{} {}", metric->symbol, name);
  return k == 0 ? std::string(metric->symbol) : fmt::format("{}{}", metric->symbol, k);
}

std::optional<double> rank_value(const MetricAt& metric, const Outcomes& outcomes,
                                 std::span<const uint32_t> weights) {
  if (!metric.metric->is_known_at(outcomes, metric.k)) return std::nullopt;
  double sum = 0;
  uint64_t frames = 0;
  for (const QueryOutcome& query : outcomes.queries) {
    if (!query.has_match) continue;
    const uint32_t weight = weight_of(query, weights);
    frames += weight;
    sum += weight * metric.metric->of_query(query, metric.k);
  }
  return share_of(sum, frames);
}

std::optional<double> recall_at(const Outcomes& outcomes, size_t k) {
  return rank_value(metric_at("recall_at", k), outcomes);
}

}  // namespace vpr
