// Expected values as XML.
#include <catch2/catch.hpp>

#include "files/exports.h"

using namespace vpr;

TEST_CASE("a value that is met is a test case, another one a failure, with any content") {
  const std::vector<CheckedValue> values = {{"counts.pairs", "3", "3", true},
                                            {"a<b&\"c\"\x01", "at least 5", "4", false}};
  CHECK(junit_xml("x > y on 'z'", "e.json", values) ==
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<testsuites tests=\"2\" failures=\"1\">\n"
        "  <testsuite name=\"x &gt; y on &#39;z&#39;\" tests=\"2\" failures=\"1\" errors=\"0\" "
        "skipped=\"0\" file=\"e.json\">\n"
        "    <testcase classname=\"x &gt; y on &#39;z&#39;\" name=\"counts.pairs\"/>\n"
        "    <testcase classname=\"x &gt; y on &#39;z&#39;\" "
        "name=\"a&lt;b&amp;&quot;c&quot;\xef\xbf\xbd\">\n"
        "      <failure message=\"expected at least 5, found 4\"/>\n"
        "    </testcase>\n"
        "  </testsuite>\n"
        "</testsuites>\n");
}
