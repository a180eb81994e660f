// Two reports for vpr-eval compare.
#include <stdexcept>

#include "base/error.h"
#include "base/json.h"
#include "evaluate/report.h"
#include "fuzz.h"
#include "present/comparison_report.h"

using namespace vpr;

namespace {

Report read_report(const std::filesystem::path& path) {
  return parse_report(read_json(path, ErrorKind::data), path.string());
}

void compare(const std::vector<Report>& reports) {
  for (const bool only_common : {false, true}) {
    fuzz::refuses([&] {
      std::vector<ComparisonReport> sets = by_data_set(reports, {"a.json", "b.json"});
      for (ComparisonReport& set : sets) {
        set.settings = {3, 5, 1, only_common, only_common};
        compare_reports(set, {});
      }
      comparisons_json(sets);
      comparison_text(sets);
      for (const TableFormat format : {TableFormat::text, TableFormat::csv, TableFormat::latex})
        comparison_tables(sets, format);
      comparison_page(sets);
    });
  }
}

}  // namespace

void fuzz::run(std::string_view input) {
  const std::filesystem::path folder = folder_of(split_parts(input));
  const Report first = read_report(folder / "a.json");
  const Json written = report_json(first);
  if (report_json(parse_report(written, "written")) != written) throw std::logic_error("differs");
  compare({first, first});
  compare({first, read_report(folder / "b.json")});
}
