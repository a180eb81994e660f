#include "present/html_page.h"

#include <algorithm>
#include <cassert>

#include "base/json.h"
#include "base/text.h"
#include "html_parts.h"  // the files of src/present/html, by the build
#include "present/chart.h"

namespace vpr {

std::string script_json(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace))
    text += c == '<' ? "\\u003c" : std::string(1, c);
  return text;
}

std::string fill_page(std::string_view page, const std::map<std::string, std::string>& parts) {
  std::string filled;
  for (;;) {
    const size_t begin = page.find("{{");
    const size_t end = begin == std::string_view::npos ? begin : page.find("}}", begin);
    if (end == std::string_view::npos) return filled.append(page);
    filled.append(page.substr(0, begin));
    const auto part = parts.find(std::string(page.substr(begin + 2, end - begin - 2)));
    assert(part != parts.end());
    filled += part->second;
    page.remove_prefix(end + 2);
  }
}

namespace {

// A row of names over their columns; empty without groups.
std::string groups_html(const Table& table) {
  if (table.groups.empty()) return "";
  std::string html = "<tr>";
  size_t at = 0;
  for (const ColumnGroup& group : table.groups) {
    if (group.first > at) html += "<td colspan=\"" + std::to_string(group.first - at) + "\"></td>";
    html += "<th scope=\"colgroup\" colspan=\"" + std::to_string(group.count) + "\">" +
            html_escaped(group.name) + "</th>";
    at = group.first + group.count;
  }
  return html + "</tr>";
}

}  // namespace

std::string table_html(const Table& table) {
  const std::string title = html_escaped(table.title);
  const auto cell = [&](size_t row, size_t column) {
    const auto [value, interval] = value_and_interval(table.rows[row][column]);
    std::string text = html_escaped(value);
    if (!interval.empty()) text += "<br><small>" + html_escaped(interval) + "</small>";
    return table.best.contains({row, column}) ? "<b>" + text + "</b>" : text;
  };
  std::string html = "<p class=\"note\">" + title + "</p>";
  std::string notes;
  for (const std::string& note : table.notes)
    notes += "<p class=\"note\">" + html_escaped(note) + "</p>";
  if (table.rows.size() == 1 && table.groups.empty()) {
    html += "<dl class=\"facts\">";
    for (size_t column = 0; column < table.columns.size(); ++column)
      html += "<div><dt>" + html_escaped(table.columns[column]) + "</dt><dd>" + cell(0, column) +
              "</dd></div>";
    return html + "</dl>" + notes + "\n";
  }
  html += "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + title +
          "\"><table><thead>" + groups_html(table) + "<tr>";
  for (const std::string& column : table.columns)
    html += "<th scope=\"col\">" + html_escaped(column) + "</th>";
  html += "</tr></thead><tbody>";
  for (size_t row = 0; row < table.rows.size(); ++row) {
    html += "<tr>";
    for (size_t column = 0; column < table.columns.size(); ++column)
      html += "<td>" + cell(row, column) + "</td>";
    html += "</tr>";
  }
  return html + "</tbody></table></div>" + notes + "\n";
}

std::string list_html(const Json& object) {
  std::string html;
  for (const auto& item : object.items()) {
    std::string key = item.key();
    std::ranges::replace(key, '_', ' ');
    const std::string value =
        item.value().is_string()
            ? item.value().get<std::string>()
            : item.value().dump(-1, ' ', false, Json::error_handler_t::replace);
    html += "<dt>" + html_escaped(key) + "</dt><dd>" + html_escaped(value) + "</dd>\n";
  }
  return html;
}

std::string figure_html(const Chart& chart) {
  return "<figure><figcaption>" + html_escaped(chart.title) + "</figcaption>" + page_svg(chart) +
         "<p class=\"legend\">" + legend_html(chart) + "</p></figure>\n";
}

std::string section_html(const std::string& title, const std::string& content) {
  return "<section><h2>" + html_escaped(title) + "</h2>" + content + "</section>\n";
}

std::string folded_html(const std::string& title, const std::string& content) {
  return "<details><summary>" + html_escaped(title) + "</summary>" + content + "</details>\n";
}

std::string sections_page(const std::string& title, const std::string& summary,
                          const std::string& subtitle, const std::string& sections,
                          const Json& protocol, const Json& provenance) {
  return fill_page(html::kComparisonPage, {{"title", html_escaped(title)},
                                           {"summary", html_escaped(summary)},
                                           {"subtitle", html_escaped(subtitle)},
                                           {"style", palette_css() + std::string(html::kStyle)},
                                           {"sections", sections},
                                           {"protocol", list_html(protocol)},
                                           {"provenance", list_html(provenance)}});
}

}  // namespace vpr
