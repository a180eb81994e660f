#include "vpr/compare.h"

#include "base/error.h"

namespace vpr::calls {

std::vector<ComparisonReport> compare(Keywords& keywords, const std::vector<std::string>& texts,
                                      const std::vector<std::string>& names,
                                      const Monitor& monitor) {
  ComparisonSettings settings;
  NestedObject own{[&](auto&& visit) {
    visit("block", settings.block);
    visit("recall_at", settings.recall_at);
    visit("common", settings.only_common);
    visit("allow_different", settings.omit_disputed);
  }};
  keywords.read(own);
  if (texts.size() < 2) throw Error(ErrorKind::usage, "a comparison needs two or more reports");
  settings.seed = keywords.process.seed;
  std::vector<Report> reports;
  for (size_t r = 0; r < texts.size(); ++r) {
    const std::optional<Json> json = parse_json(texts[r]);
    reports.push_back(parse_report(json ? *json : Json(), names[r]));
  }
  std::vector<ComparisonReport> sets = by_data_set(std::move(reports), names);
  for (ComparisonReport& set : sets) {
    if (compare_ground_truths(set.reports) == GroundTruths::different && !settings.omit_disputed)
      throw Error(ErrorKind::data,
                  "the reports have different ground truths. Evaluate all results with one of "
                  "them, or pass allow_different=True");
    set.settings = settings;
    compare_reports(set, monitor);
    set.made_by = provenance_of(run_of("vpr-eval", {keywords.function}, settings.seed));
  }
  return sets;
}

}  // namespace vpr::calls
