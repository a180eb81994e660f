// Every metric compared with cases computed by hand, closed forms, and reference implementations.
#include "evaluate/metrics.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "evaluate/outcomes.h"
#include "judgments.h"

using namespace vpr;
using test::outcomes_of;

namespace {

struct Scored {
  double distance;
  bool is_correct;
};

Curve curve_from(const std::vector<Scored>& scored, uint64_t positives,
                 ScoreOrder kind = ScoreOrder::distance) {
  std::vector<ScoredItem> items;
  for (const Scored& item : scored)
    items.push_back({score_key(item.distance, kind), item.is_correct});
  sort_items(items);
  return curve_of(items, positives, kind);
}

/// Precision and recall by definition, at each existing value.
struct CurveThreshold {
  double distance = 0;
  double correct = 0;
  double accepted = 0;
};
std::vector<CurveThreshold> all_thresholds(const std::vector<Scored>& scored) {
  std::vector<double> values;
  for (const Scored& item : scored) values.push_back(item.distance);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  std::vector<CurveThreshold> thresholds;
  for (const double value : values) {
    CurveThreshold& at = thresholds.emplace_back(CurveThreshold{value});
    for (const Scored& item : scored) {
      if (item.distance > value) continue;
      ++at.accepted;
      at.correct += item.is_correct;
    }
  }
  return thresholds;
}

double reference_auc(const std::vector<Scored>& scored) {
  double better = 0;
  double pairs = 0;
  for (const Scored& a : scored) {
    for (const Scored& b : scored) {
      if (!a.is_correct || b.is_correct) continue;
      ++pairs;
      better += a.distance < b.distance ? 1 : a.distance == b.distance ? 0.5 : 0;
    }
  }
  return better / pairs;
}

// Correct, correct, incorrect, correct, incorrect, in this order; four positives.
const std::vector<Scored> kFive = {{1, true}, {2, true}, {3, false}, {4, true}, {5, false}};

}  // namespace

TEST_CASE("metrics of five matches equal values computed by hand") {
  const Curve curve = curve_from(kFive, 4);
  // Precisions at the three correct ones: 1/1, 2/2, 3/4, each with 1/4 of the recall.
  CHECK(*average_precision(curve).value == Approx((1.0 + 1.0 + 0.75) / 4));
  CHECK(recall_at_full_precision(curve).value == 0.5);
  CHECK(recall_at_full_precision(curve).threshold == 2);
  // F1 = 2 correct / (accepted + 4): 2/5, 4/6, 4/7, 6/8, 6/9.
  CHECK(*max_f1(curve).value == Approx(0.75));
  CHECK(max_f1(curve).threshold == 4);
  CHECK(*extended_precision(curve).value == Approx((1 + 0.5) / 2));
  // In order: (1,3) (1,5) (2,3) (2,5) (4,5), not (4,3): 5 of 6.
  CHECK(*roc_auc(curve).value == Approx(5.0 / 6));
}

TEST_CASE("a similarity is a negated distance") {
  std::vector<Scored> turned = kFive;
  for (Scored& item : turned) item.distance = -item.distance;
  const Curve curve = curve_from(turned, 4, ScoreOrder::similarity);
  for (const Metric& metric : curve_metrics())
    CHECK(metric.of_curve(curve).value == metric.of_curve(curve_from(kFive, 4)).value);
  CHECK(recall_at_full_precision(curve).threshold == -2);
}

TEST_CASE("ties are accepted together") {
  // A correct and an incorrect one share the best score: no threshold separates them.
  const Curve curve = curve_from({{1, true}, {1, false}, {2, true}}, 2);
  CHECK(curve.points.size() == 2);
  CHECK(*average_precision(curve).value == Approx(0.5 * 0.5 + 0.5 * 2 / 3));
  CHECK(recall_at_full_precision(curve).value == 0);
  CHECK_FALSE(recall_at_full_precision(curve).threshold);
  CHECK(*max_f1(curve).value == Approx(2 * 2.0 / (3 + 2)));
  CHECK(*extended_precision(curve).value == Approx(0.25));
  CHECK(*roc_auc(curve).value == Approx((0.5 + 0) / 2));
}

TEST_CASE("a perfect order has perfect metrics, its reverse the worst ones") {
  std::vector<Scored> perfect;
  for (int i = 0; i < 30; ++i) perfect.push_back({double(i), i < 10});
  const Curve best = curve_from(perfect, 10);
  CHECK(average_precision(best).value == 1);
  CHECK(recall_at_full_precision(best).value == 1);
  CHECK(max_f1(best).value == 1);
  CHECK(extended_precision(best).value == 1);
  CHECK(roc_auc(best).value == 1);
  for (Scored& item : perfect) item.distance = -item.distance;
  const Curve worst = curve_from(perfect, 10);
  // The k-th correct one comes after 20 incorrect ones: precision k / (20 + k).
  double sum = 0;
  for (int k = 1; k <= 10; ++k) sum += k / (20.0 + k);
  CHECK(*average_precision(worst).value == Approx(sum / 10));
  CHECK(recall_at_full_precision(worst).value == 0);
  CHECK(*max_f1(worst).value == Approx(2 * 10.0 / (30 + 10)));
  CHECK(extended_precision(worst).value == 0);
  CHECK(roc_auc(worst).value == 0);
}

TEST_CASE("equal scores: precision is the share of correct ones, ROC AUC is one half") {
  std::vector<Scored> equal;
  for (int i = 0; i < 40; ++i) equal.push_back({7, i < 10});
  const Curve curve = curve_from(equal, 10);
  CHECK(curve.points.size() == 1);
  CHECK(average_precision(curve).value == 0.25);
  CHECK(roc_auc(curve).value == 0.5);
  CHECK(*max_f1(curve).value == Approx(2 * 10.0 / (40 + 10)));
  CHECK(*extended_precision(curve).value == Approx(0.125));
}

TEST_CASE("undefined metrics have no value") {
  const Curve nothing_to_find = curve_from({{1, false}, {2, false}}, 0);
  for (const Metric& metric : curve_metrics()) CHECK_FALSE(metric.of_curve(nothing_to_find).value);
  const Curve no_scores = curve_from({}, 3);
  CHECK(average_precision(no_scores).value == 0);
  CHECK(recall_at_full_precision(no_scores).value == 0);
  CHECK(max_f1(no_scores).value == 0);
  CHECK(extended_precision(no_scores).value == 0);
  CHECK_FALSE(roc_auc(no_scores).value);
  CHECK_FALSE(roc_auc(curve_from({{1, true}}, 1)).value);
  CHECK(average_precision(curve_from({{1, true}}, 1)).value == 1);
}

TEST_CASE("matches that are never found limit recall") {
  const Curve curve = curve_from({{1, true}, {2, true}}, 8);
  CHECK(average_precision(curve).value == 0.25);
  CHECK(recall_at_full_precision(curve).value == 0.25);
  CHECK(*max_f1(curve).value == Approx(2 * 2.0 / (2 + 8)));
}

TEST_CASE("metrics equal their definitions on random scores with ties") {
  RandomEngine engine(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<Scored> scored;
    const uint64_t count = 1 + uniform_below(engine, 60);
    const uint64_t values = 1 + uniform_below(engine, 40);
    uint64_t correct = 0;
    for (uint64_t i = 0; i < count; ++i) {
      const bool is_correct = uniform_below(engine, 3) == 0;
      correct += is_correct;
      scored.push_back({double(uniform_below(engine, values)) - 10, is_correct});
    }
    const uint64_t positives = correct + uniform_below(engine, 4);
    if (positives == 0) continue;
    const auto find = static_cast<double>(positives);
    double ap = 0, full = 0, f1 = 0, before = 0;
    bool is_clean = true;
    const auto thresholds = all_thresholds(scored);
    for (const CurveThreshold& at : thresholds) {
      const double precision = at.correct / at.accepted;
      const double recall = at.correct / find;
      ap += (recall - before) * precision;
      is_clean = is_clean && at.correct == at.accepted;
      if (is_clean) full = recall;
      if (precision + recall > 0) f1 = std::max(f1, 2 * precision * recall / (precision + recall));
      before = recall;
    }
    const Curve curve = curve_from(scored, positives);
    REQUIRE(*average_precision(curve).value == Approx(ap));
    REQUIRE(*recall_at_full_precision(curve).value == Approx(full));
    REQUIRE(*max_f1(curve).value == Approx(f1));
    REQUIRE(*extended_precision(curve).value ==
            Approx((thresholds[0].correct / thresholds[0].accepted + full) / 2));
    if (correct > 0 && correct < count)
      REQUIRE(*roc_auc(curve).value == Approx(reference_auc(scored)));
  }
}

TEST_CASE("weights count an item repeatedly, and 0 omits it") {
  std::vector<ScoredItem> weighted = {{1, true, 2}, {2, false, 0}, {3, true, 1}, {4, false, 3}};
  std::vector<ScoredItem> repeated = {{1, true},  {1, true},  {3, true},
                                      {4, false}, {4, false}, {4, false}};
  CHECK(curve_of(weighted, 3, ScoreOrder::distance) == curve_of(repeated, 3, ScoreOrder::distance));
}

TEST_CASE("keys sort scores best first and can be converted back") {
  const std::vector<double> rising = {-INFINITY, -3, -1e-300, 0, 1e-300, 0.5, 3, INFINITY};
  for (const ScoreOrder kind : {ScoreOrder::distance, ScoreOrder::similarity}) {
    for (size_t i = 0; i < rising.size(); ++i) {
      CHECK(score_of_key(score_key(rising[i], kind), kind) == rising[i]);
      CHECK(score_key(rising[i], kind) < kNoScore);
      if (i == 0) continue;
      const bool is_rising = score_key(rising[i - 1], kind) < score_key(rising[i], kind);
      CHECK(is_rising == (kind == ScoreOrder::distance));
    }
    CHECK(score_key(-0.0, kind) == score_key(0.0, kind));
    CHECK(score_key(NAN, kind) == kNoScore);
    CHECK(score_key(-NAN, kind) == kNoScore);
  }
}

namespace {

/// The mean risk by definition, over random orders of ties.
double reference_risk(std::vector<Scored> scored, size_t orders) {
  RandomEngine engine(5);
  double sum = 0;
  for (size_t order = 0; order < orders; ++order) {
    std::vector<size_t> at(scored.size());
    for (size_t i = 0; i < at.size(); ++i) at[i] = i;
    for (size_t i = at.size(); i > 1; --i) std::swap(at[i - 1], at[uniform_below(engine, i)]);
    std::stable_sort(at.begin(), at.end(),
                     [&](size_t a, size_t b) { return scored[a].distance < scored[b].distance; });
    double wrong = 0;
    for (size_t i = 0; i < at.size(); ++i) {
      wrong += scored[at[i]].is_correct ? 0 : 1;
      sum += wrong / double(i + 1) / double(at.size());
    }
  }
  return sum / double(orders);
}

}  // namespace

TEST_CASE(
    "the area under risk and coverage equals the value computed by hand, with expected ties") {
  // Risks 0/1, 0/2, 1/3, 1/4, 2/5.
  CHECK(*risk_coverage_area(curve_from(kFive, 4)).value ==
        Approx((0 + 0 + 1 / 3.0 + 1 / 4.0 + 2 / 5.0) / 5));
  // A correct and an incorrect one tie: 0 or 1 with the first, 1/2 with both; then 1/3.
  CHECK(*risk_coverage_area(curve_from({{1, true}, {1, false}, {2, true}}, 2)).value ==
        Approx((0.5 + 0.5 + 1 / 3.0) / 3));
  CHECK(risk_coverage_area(curve_from({{1, true}, {2, true}}, 9)).value == 0);
  CHECK(risk_coverage_area(curve_from({{1, false}, {2, false}}, 9)).value == 1);
  CHECK_FALSE(risk_coverage_area(curve_from({}, 3)).value);
  // Recall over the correct items: of 4 positives 2 have a score, at precisions 1 and 2/3.
  const auto of_correct = find_metric("average_precision_of_correct").of_curve;
  CHECK(*of_correct(curve_from({{1, true}, {2, false}, {3, true}}, 4)).value ==
        Approx((1 + 2 / 3.0) / 2));
  CHECK_FALSE(of_correct(curve_from({{1, false}}, 4)).value);
  RandomEngine engine(3);
  std::vector<Scored> many;
  for (size_t i = 0; i < 40; ++i)
    many.push_back({double(uniform_below(engine, 8)), uniform_below(engine, 3) > 0});
  CHECK(*risk_coverage_area(curve_from(many, 40)).value ==
        Approx(reference_risk(many, 20000)).margin(0.002));
  const auto points = risk_coverage_points(curve_from(kFive, 4));
  REQUIRE(points.size() == 4);  // no threshold at a single incorrect one, except the last
  CHECK(points[1] == std::pair(0.4, 0.0));
  CHECK(points[2] == std::pair(0.8, 0.25));
  CHECK(points[3].first == 1);
}

TEST_CASE("the recall achievement rate equals the value counted by hand") {
  // Parts of four frames: 3/4, 1/2 (of two with a match), none with a match, 1.
  const Outcomes outcomes = outcomes_of("cccwcunnnnnncccc");
  const auto recalls = local_recalls(outcomes, 4);
  REQUIRE(recalls.size() == 4);
  CHECK(recalls[0] == 0.75);
  CHECK(recalls[1] == 0.5);
  CHECK_FALSE(recalls[2]);
  CHECK(recalls[3] == 1);
  CHECK(*recall_achievement(recalls, 0.5) == 1);
  CHECK(*recall_achievement(recalls, 0.75) == Approx(2 / 3.0));
  CHECK(*recall_achievement(recalls, 1) == Approx(1 / 3.0));
  // Seven frames are two parts, of three and of four; frames before the first window count.
  const auto uneven = local_recalls(outcomes_of("uuwcccc"), 4);
  REQUIRE(uneven.size() == 2);
  CHECK(uneven[0] == 0);
  CHECK(uneven[1] == 1);
  CHECK(local_recalls(outcomes_of("cw"), 100).size() == 1);
  CHECK_FALSE(recall_achievement(local_recalls(outcomes_of("nn"), 1), 0.5));
}

TEST_CASE("precision@K and mAP@K equal values computed by hand") {
  Outcomes outcomes = outcomes_of("cwn");
  outcomes.has_ranks = true;
  outcomes.queries[0].correct_ranks = {1, 3, 4};
  outcomes.queries[0].correct_count = 3;
  outcomes.queries[1].correct_ranks = {2};
  outcomes.queries[1].correct_count = 8;
  const auto precision_at = [&](size_t k) {
    return rank_value(metric_at("precision_at", k), outcomes);
  };
  const auto map_at = [&](size_t k) { return rank_value(metric_at("map_at", k), outcomes); };
  CHECK(*precision_at(1) == Approx((1 + 0) / 2.0));
  CHECK(*precision_at(3) == Approx((2 / 3.0 + 1 / 3.0) / 2));
  CHECK(*precision_at(10) == Approx((3 / 10.0 + 1 / 10.0) / 2));
  CHECK(*map_at(1) == Approx(0.5));
  // (1/1 + 2/3) / min(3, 3) and (1/2) / min(3, 8).
  CHECK(*map_at(3) == Approx((5 / 9.0 + 1 / 6.0) / 2));
  CHECK(*map_at(5) == Approx(((1 + 2 / 3.0 + 3 / 4.0) / 3 + 0.5 / 5) / 2));
  CHECK_FALSE(precision_at(kMaxRank + 1));
  outcomes.has_ranks = false;
  CHECK_FALSE(precision_at(1));
}
