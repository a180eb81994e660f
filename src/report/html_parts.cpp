#include "report/html_parts.h"

#include <fmt/format.h>

#include "base/json.h"
#include "report/html_text.h"

namespace vpr {
namespace {

#include "html_parts.inc"

}  // namespace

const HtmlParts& html_parts() {
  static constexpr HtmlParts kParts = {kPage,   kComparisonPage, kStyle,
                                       kScript, kHoverScript,    kLabelScript};
  return kParts;
}

std::string scroll_begin(const std::string& escaped_title) {
  return "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + escaped_title +
         "\">";
}

std::string table_html(const Table& table) {
  const std::string title = html_escaped(table.title);
  std::string html = "<p class=\"note\">" + title + "</p>" + scroll_begin(title) +
                     "<table aria-label=\"" + title + "\"><thead><tr>";
  for (const std::string& column : table.columns)
    html += "<th scope=\"col\">" + html_escaped(column) + "</th>";
  html += "</tr></thead><tbody>";
  for (size_t row = 0; row < table.rows.size(); ++row) {
    html += "<tr>";
    for (size_t column = 0; column < table.columns.size(); ++column) {
      const std::string cell = html_escaped(table.rows[row][column]);
      html += table.best.contains({row, column}) ? "<td><b>" + cell + "</b></td>"
                                                 : "<td>" + cell + "</td>";
    }
    html += "</tr>";
  }
  return html + "</tbody></table></div>\n";
}

std::string list_html(const Json& object) {
  std::string html;
  for (const auto& item : object.items()) {
    std::string key = item.key();
    for (char& c : key)
      if (c == '_') c = ' ';
    const std::string value =
        item.value().is_string()
            ? item.value().get<std::string>()
            : item.value().dump(-1, ' ', false, Json::error_handler_t::replace);
    html += "<dt>" + html_escaped(key) + "</dt><dd>" + html_escaped(value) + "</dd>\n";
  }
  return html;
}

std::string legend_html(const std::vector<Meaning>& meanings) {
  std::string html;
  for (const Meaning meaning : meanings) html += legend_key(meaning);
  return html;
}

std::string legend_html(const std::vector<std::string>& series) {
  std::string html;
  for (size_t i = 0; i < series.size(); ++i)
    html += fmt::format("<span class=\"entry\"><span class=\"key series-{}\"></span>{}</span> ",
                        i % series_colours().size(), html_escaped(series[i]));
  return html;
}

}  // namespace vpr
