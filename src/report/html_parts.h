// What all pages share: their style, tables, legends, and what scrolls.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.h"
#include "report/palette.h"
#include "report/table.h"

namespace vpr {

/// The files of src/report/html as they are embedded.
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

}  // namespace vpr
