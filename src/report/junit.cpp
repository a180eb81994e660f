#include "report/junit.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/html_text.h"

namespace vpr {

std::string junit_xml(const std::string& suite, const std::string& file,
                      std::span<const CheckedValue> values) {
  const auto failures = std::ranges::count(values, false, &CheckedValue::is_met);
  const std::string counts = fmt::format("tests=\"{}\" failures=\"{}\"", values.size(), failures);
  const std::string name = html_escaped(suite);
  std::string xml = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {0}>\n  <testsuite name=\"{1}\" "
      "{0} errors=\"0\" skipped=\"0\" file=\"{2}\">\n",
      counts, name, html_escaped(file));
  for (const CheckedValue& value : values) {
    xml += fmt::format("    <testcase classname=\"{}\" name=\"{}\"", name, html_escaped(value.key));
    if (value.is_met) {
      xml += "/>\n";
      continue;
    }
    xml += fmt::format(
        ">\n      <failure message=\"{}\"/>\n    </testcase>\n",
        html_escaped(fmt::format("expected {}, found {}", value.expected, value.found)));
  }
  return xml + "  </testsuite>\n</testsuites>\n";
}

}  // namespace vpr
