// Two reports that vpr-eval compares.
#include "base/json.h"
#include "fuzz.h"
#include "present/comparison_page.h"
#include "present/comparison_report.h"

using namespace vpr;

namespace {

constexpr size_t kResamples = 5;

void compare(const std::vector<StoredReport>& reports) {
  const std::vector<std::string> names = report_names(reports, {"a.json", "b.json"});
  std::vector<NamedOutcomes> methods;
  for (size_t r = 0; r < reports.size(); ++r)
    methods.push_back({names[r], reports[r].outcomes, is_same_walk(reports[r], reports.front())});
  for (const Disputed disputed : {Disputed::refuse, Disputed::leave_out}) {
    fuzz::refuses([&] {
      const Comparison found = compare_outcomes(methods, 3, kResamples, 1, {}, disputed);
      const Json json = comparison_json(found, reports, names, kResamples, {});
      render_table(comparison_table(json), TableFormat::text);
      render_table(paired_table(json), TableFormat::text);
      render_table(paper_table(json), TableFormat::latex);
      render_table(comparison_rows(json), TableFormat::csv);
      comparison_page(json, reports, names);
    });
  }
}

}  // namespace

void fuzz::run(std::string_view input) {
  const std::filesystem::path folder = folder_of(split_parts(input));
  const StoredReport first = read_report(folder / "a.json");
  compare({first, first});
  compare({first, read_report(folder / "b.json")});
}
