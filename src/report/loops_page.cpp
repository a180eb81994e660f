#include "report/loops_page.h"

#include <fmt/format.h>

#include "base/json.h"
#include "report/chart_svg.h"
#include "report/html_parts.h"
#include "report/html_text.h"
#include "report/loops_charts.h"
#include "report/palette.h"

namespace vpr {
namespace {

/// The names of a chart's series, beside their colours.
std::string legend_of(const Chart& chart) {
  std::string html;
  for (const Series& series : chart.series)
    if (!series.name.empty() && series.meaning)
      html += fmt::format("<span class=\"entry\"><span class=\"key {}\"></span>{}</span> ",
                          colour_of(*series.meaning).name, html_escaped(series.name));
  return html;
}

std::string figure(const Chart& chart, const std::string& title) {
  return fmt::format("<figure><figcaption>{}</figcaption>{}<p class=\"legend\">{}</p></figure>",
                     title, page_svg(chart), legend_of(chart));
}

std::string charts_html(const LoopsEvaluation& evaluation) {
  Chart map = loops_map_chart(evaluation);
  map.title = "Loops on the trajectory";
  std::string html = "<div class=\"charts\">" + figure(map, map.title);
  Chart curve = loops_curve_chart(evaluation);
  curve.title = "Precision and recall";
  curve.width = 650;
  curve.height = 450;
  if (!curve.series.empty()) html += figure(curve, curve.title);
  return html + "</div>";
}

std::string mistakes_html(const Json& report) {
  const std::string text = loops_mistakes(report);
  if (text.empty()) return "";
  return "<section><h2>Mistakes</h2><pre>" + html_escaped(text.substr(1)) + "</pre></section>";
}

}  // namespace

std::string loops_page(const LoopsEvaluation& evaluation, const Json& report) {
  Json made = report["provenance"];
  if (report.contains("machine")) made["command_line"] = report["machine"]["command_line"];
  const std::string sections = "<section><h2>Numbers</h2>" + table_html(loops_table(report)) +
                               "</section>\n<section>" + "<h2>On the way</h2>" +
                               charts_html(evaluation) + "</section>\n" + mistakes_html(report);
  return fill_page(html_parts().comparison_page,
                   {{"title", html_escaped("Loop closures: " + evaluation.name)},
                    {"summary", html_escaped(loops_sentence(report))},
                    {"subtitle", html_escaped(report["protocol"]["loop"].get<std::string>())},
                    {"style", palette_css() + std::string(html_parts().style)},
                    {"sections", sections},
                    {"protocol", list_html(report["protocol"])},
                    {"provenance", list_html(made)}});
}

}  // namespace vpr
