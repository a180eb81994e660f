// The parts of all HTML pages: escaped text and data, style, tables and legends.
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

/// A text for element content and quoted attributes: & < > " ' become references; bytes that are
/// not UTF-8 and control characters become U+FFFD.
std::string html_escaped(std::string_view text);

/// Bytes as base64 (RFC 4648), padded.
std::string base64(std::span<const std::byte> bytes);

/// A JSON for a script element of type application/json: nothing in it can end the element.
std::string script_json(const Json& json);

/// Replaces every {{name}} by its part, once: what is put in is not looked through again. Every
/// name in the page must have a part.
std::string fill_page(std::string_view page, const std::map<std::string, std::string>& parts);

/// The files of src/present/html as they are embedded.
struct HtmlParts {
  std::string_view page;             ///< of an evaluation
  std::string_view comparison_page;  ///< of several reports
  std::string_view style;
  std::string_view script;        ///< of an evaluation's page: gallery and queries
  std::string_view hover_script;  ///< values below the pointer, and thresholds
  std::string_view label_script;  ///< labels and anchors
};
const HtmlParts& html_parts();

/// Begins a part that scrolls where it is wider than the page, by keyboard, too. It ends with
/// </div>.
std::string scroll_begin(const std::string& escaped_title);

/// The table below its title; the best cells are bold.
std::string table_html(const Table& table);

/// The entries of an object as terms with what they say, for a <dl>.
std::string list_html(const Json& object);

/// Entries of a legend: a swatch and words each.
std::string legend_html(const std::vector<Meaning>& meanings);
/// The same of curves that mean nothing but their order.
std::string legend_html(const std::vector<std::string>& series);

/// A section of such a page; both texts are HTML.
std::string section_html(const std::string& title, const std::string& content);

/// A page of several sections, which are HTML; the other texts are escaped.
std::string sections_page(const std::string& title, const std::string& summary,
                          const std::string& subtitle, const std::string& sections,
                          const Json& protocol, const Json& provenance);

}  // namespace vpr
