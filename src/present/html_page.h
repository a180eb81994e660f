// The parts of all HTML pages: escaped text and data, style, tables, figures and legends.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "base/json_fwd.h"
#include "present/table.h"

namespace vpr {

struct Chart;

/// JSON for a script element of type application/json; it cannot end the element.
std::string script_json(const Json& json);

/// Replaces every {{name}} by its part. Parts are not expanded again. Every name of the page must
/// have a part.
std::string fill_page(std::string_view page, const std::map<std::string, std::string>& parts);

/// The table between its title and notes, in an element that scrolls on narrow screens; the best
/// cells are bold. A single row is a list of columns and values.
std::string table_html(const Table& table);

/// The keys and values of an object for a <dl>.
std::string list_html(const Json& object);

/// A chart with its title as caption and its legend.
std::string figure_html(const Chart& chart);

/// A section; `content` is HTML, the title is escaped.
std::string section_html(const std::string& title, const std::string& content);

/// The same, folded.
std::string folded_html(const std::string& title, const std::string& content);

/// A page of several sections, which are HTML; the other strings are escaped.
std::string sections_page(const std::string& title, const std::string& summary,
                          const std::string& subtitle, const std::string& sections,
                          const Json& protocol, const Json& provenance);

}  // namespace vpr
