// The keys of counts and curves in reports and other files.
#pragma once

#include "base/json.h"
#include "evaluate/report.h"

namespace vpr {

VPR_FIELDS(LabelCounts, (correct, "Same place."), (incorrect, "Different places."),
           (ignored, "Neither."))

/// The rows of the table of metrics that a struct has, if the source of verdicts determines them.
template <class S, class Visitor>
void visit_metrics(S& from, std::optional<ValueOf<S>> Metric::*of, JudgedBy judge,
                   Visitor&& visit) {
  for (const Metric& metric : metrics()) {
    if (!(metric.*of) || judge > metric.needs) continue;
    const std::string_view key = metric.key.substr(metric.key.find('.') + 1);
    const std::string_view text = metric.description();
    const MayBeMissing hint{!metric.of_best_match && metric.needs != JudgedBy::nothing};
    const auto visit_member = [&](auto member) {
      if constexpr (std::is_member_function_pointer_v<decltype(member)>)
        visit(key, Derived{(from.*member)()}, text, hint);
      else if constexpr (std::is_same_v<S, Counts> &&
                         detail::kIsOptional<std::remove_cvref_t<decltype(from.*member)>>)
        visit(key, IfSet{from.*member}, text);  // a result without places
      else
        visit(key, from.*member, text, hint);
    };
    std::visit(visit_member, *(metric.*of));
  }
}
template <class Visitor>
void visit_fields(Counts& counts, Visitor&& visit) {
  visit_metrics(counts, &Metric::of_counts, JudgedBy::ground_truth, visit);
}
template <class Visitor>
void visit_fields(BestMatchCounts& counts, Visitor&& visit) {
  visit_metrics(counts, &Metric::of_best_match, JudgedBy::ground_truth, visit);
}

template <class Visitor>
void visit_fields(CurveNumbers& numbers, Visitor&& visit) {
  visit("positives", numbers.positives, "The denominator of recall.");
  for (size_t m = 0; m < numbers.values.size(); ++m)
    visit(curve_metrics()[m].key, numbers.values[m].value, curve_metrics()[m].meaning);
  visit("thresholds", NestedObject{[&](auto& inner) {
          for (size_t m = 0; m < numbers.values.size(); ++m)
            inner(curve_metrics()[m].key, IfSet{numbers.values[m].threshold}, "its score");
        }},
        "Score at which each metric is reached.");
  visit("tied_queries", IfSet{numbers.tied_queries}, "Queries whose best score is tied.");
  visit("same_without_score", IfSet{numbers.same_without_score}, "Same places without a score.");
  visit("ignored", IfSet{numbers.ignored}, "Pairs labeled ignore.");
}

VPR_FIELDS(ReportedPoint, (threshold, "Accepted at this score.", kOrNull),
           (correct, "Correct ones accepted."), (incorrect, "Accepted so far."))

VPR_FIELDS(ReportedCurve, (thresholds, "Points of the exact curve."),
           (points, "At most 100 of them."))

}  // namespace vpr
