// The parts of all HTML pages: escaped text and data, style, tables, figures and legends.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.h"
#include "present/palette.h"
#include "present/table.h"

namespace vpr {

struct Chart;

/// A string for element content and quoted attributes: & < > " ' become references; bytes that are
/// not UTF-8 and control characters become U+FFFD.
std::string html_escaped(std::string_view text);

/// RFC 4648, padded.
std::string base64(std::span<const std::byte> bytes);

/// JSON for a script element of type application/json; it cannot end the element.
std::string script_json(const Json& json);

/// Replaces every {{name}} by its part. Parts are not expanded again. Every name of the page must
/// have a part.
std::string fill_page(std::string_view page, const std::map<std::string, std::string>& parts);

/// An element that scrolls, also by keyboard, if its content is wider than the page.
std::string scrolling_html(const std::string& escaped_title, const std::string& content);

/// The table below its title; the best cells are bold.
std::string table_html(const Table& table);

/// The keys and values of an object for a <dl>.
std::string list_html(const Json& object);

/// An entry of a legend: a swatch of this CSS class, and words, which are HTML.
std::string legend_entry(std::string_view color, std::string_view words);
std::string legend_html(const std::vector<Meaning>& meanings);

/// A chart with its caption and legend, which are HTML.
std::string figure_html(const std::string& caption, const Chart& chart, const std::string& legend);

/// Title and content are HTML.
std::string section_html(const std::string& title, const std::string& content);

/// A page of several sections, which are HTML; the other strings are escaped.
std::string sections_page(const std::string& title, const std::string& summary,
                          const std::string& subtitle, const std::string& sections,
                          const Json& protocol, const Json& provenance);

}  // namespace vpr
