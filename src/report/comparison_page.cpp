#include "report/comparison_page.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "report/chart_svg.h"
#include "report/comparison_charts.h"
#include "report/comparison_tables.h"
#include "report/evaluation_charts.h"
#include "report/html_parts.h"
#include "report/html_text.h"

namespace vpr {
namespace {

std::string title_of(const Json& comparison) {
  return fmt::format("{} on {}", counted(comparison["reports"].size(), "method"),
                     comparison["query"].get<std::string>());
}

// "Best matches of the 51 common queries are right in 80.4 % by mine, 61.8 % by theirs."
std::string sentence_of(const Json& comparison) {
  std::string text;
  for (const Json& row : comparison["metrics"])
    if (row["metric"] == "recall_at_1" && !row["value"].is_null())
      text += fmt::format("{}{:.1f} % by {}",
                          text.empty()
                              ? fmt::format("Best matches of the {} common queries are right in ",
                                            comparison["queries"]["with_match"].dump())
                              : ", ",
                          100 * row["value"].get<double>(), row["report"].get<std::string>());
  return text.empty() ? "The queries have nothing to find." : text + ".";
}

std::string section(const std::string& title, const std::string& content) {
  return "<section><h2>" + title + "</h2>" + content + "</section>\n";
}

}  // namespace

std::string methods_html(const std::string& title, std::span<const StoredReport> reports,
                         const std::vector<std::string>& names) {
  Chart curves = curves_overlay(title, reports, names);
  curves.width = 650;
  curves.height = 450;
  const Chart lanes = lanes_chart(title, reports, names);
  std::vector<std::string> entries = names;
  for (size_t r = 0; r < reports.size(); ++r)
    entries[r] +=
        fmt::format(" ({}{})", counted(judged_queries(reports[r].outcomes), "query", "queries"),
                    reports[r].outcomes.confidence == Confidence::margin ? ", by margin" : "");
  return "<div class=\"charts\"><figure><figcaption>Precision and recall of best matches, each "
         "over "
         "its own queries</figcaption>" +
         page_svg(curves) + "<p class=\"legend\">" + legend_html(entries) +
         "</p></figure></div>\n<h3>Along the path</h3><p class=\"legend\">" +
         legend_html(meanings_of(lanes)) + "</p>" + scroll_begin(html_escaped(title)) +
         page_svg(lanes) + "</div>\n";
}

std::string comparison_page(const Json& comparison, std::span<const StoredReport> reports,
                            const std::vector<std::string>& names) {
  const std::string title = title_of(comparison);
  Json made = comparison["bootstrap"];
  made.update(comparison["provenance"]);
  const std::string sections = section("Numbers", table_html(paper_table(comparison))) +
                               section("Curves and paths", methods_html(title, reports, names)) +
                               section("Differences", table_html(comparison_table(comparison)) +
                                                          table_html(paired_table(comparison)));
  return fill_page(html_parts().comparison_page,
                   {{"title", html_escaped(title)},
                    {"summary", html_escaped(sentence_of(comparison))},
                    {"subtitle", html_escaped("Ground truth: " + reports.front().ground_truth)},
                    {"style", palette_css() + std::string(html_parts().style)},
                    {"sections", sections},
                    {"protocol", list_html(comparison["protocol"])},
                    {"provenance", list_html(made)}});
}

void draw_comparison(const Json& comparison, std::span<const StoredReport> reports,
                     const std::vector<std::string>& names, const std::filesystem::path& folder) {
  const std::string title = title_of(comparison);
  draw_chart(curves_overlay(title, reports, names), folder);
  draw_chart(lanes_chart(title, reports, names), folder);
}

}  // namespace vpr
