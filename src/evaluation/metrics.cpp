#include "evaluation/metrics.h"

#include "evaluation/average_precision.h"
#include "evaluation/extended_precision.h"
#include "evaluation/full_precision_recall.h"
#include "evaluation/max_f1.h"
#include "evaluation/risk_coverage.h"
#include "evaluation/roc_auc.h"

namespace vpr {

std::span<const CurveMetric> curve_metrics() {
  static constexpr std::array<CurveMetric, 6> kMetrics = {
      {{"average_precision", "AP", "precision at every threshold, weighted by the recall it adds",
        average_precision},
       {"recall_at_100_precision", "R@100P", "recall before the first mistake",
        recall_at_full_precision},
       {"max_f1", "max F1", "largest harmonic mean of precision and recall", max_f1},
       {"extended_precision", "EP", "mean of the best score's precision and R@100P",
        extended_precision},
       {"roc_auc", "ROC AUC", "probability that a correct one scores better than an incorrect one",
        roc_auc},
       {"risk_coverage_area", "AURC",
        "mean share of mistakes over all numbers of accepted ones, small is good",
        risk_coverage_area, true}}};
  return kMetrics;
}

}  // namespace vpr
