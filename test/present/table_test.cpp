#include "present/table.h"

#include <catch2/catch.hpp>

#include "support.h"

using namespace vpr;

namespace {
const Table kTable = {"Title_1", {"name", "n"}, {{"a|b, c", "7"}, {"\xc3\xa4", "123"}}};
}

TEST_CASE("a text table aligns numbers to the right, by characters") {
  CHECK(render_table(kTable, TableFormat::text) ==
        "Title_1\n"
        "name      n\n"
        "-----------\n"
        "a|b, c    7\n"
        "\xc3\xa4       123\n");
}

TEST_CASE("tables side by side have groups of columns, and a row for each name") {
  const Table one = {
      "o: all; sums", {"method", "R", "S"}, {{"a", "1", "2"}, {"b", "3", "4"}}, {{1, 2}}};
  const Table two = {"t: some; sums", {"method", "R"}, {{"c", "5"}, {"b", "6"}}, {}, {},
                     {"b: late"}};
  const Table both = joined_tables({{"one", one}, {"long name", two}});
  CHECK(render_table(both, TableFormat::text) ==
        "o: all; sums; t: some\n"
        "        one    long name\n"
        "method  R   S  R\n"
        "----------------\n"
        "a       1  2   -\n"
        "b       3  4*  6\n"
        "c       -  -   5\n"
        "* the best\n"
        "long name: b: late\n");
  const Table all = {"all: sums", {"method", "R"}, {{"a", "1"}}};
  const Table hall = {"hall: sums", {"method", "R"}, {{"a", "1"}}};
  CHECK(joined_tables({{"hall", hall}, {"all", all}}).title == "hall: sums; all: sums");
  CHECK(render_table(both, TableFormat::csv) ==
        "method,one R,one S,long name R\na,1,2,-\nb,3,4,6\nc,-,-,5\n");
  CHECK(test::has(render_table(both, TableFormat::latex),
                  "\\toprule\n & \\multicolumn{2}{c}{one} & \\multicolumn{1}{c}{long name} \\\\\n"
                  "\\cmidrule(lr){2-3}\\cmidrule(lr){4-4}\nmethod & R & S & R \\\\\n"));
}

TEST_CASE("notes are lines below a table, comments in LaTeX, and not in CSV") {
  const Table table = {"", {"n"}, {{"7"}}, {}, {}, {"a: this\nthat"}};
  CHECK(render_table(table, TableFormat::text) == "n\n-\n7\na: this\\x0athat\n");
  CHECK(render_table(table, TableFormat::markdown).ends_with("| 7 |\n\na: this\\x0athat\n"));
  CHECK(test::has(render_table(table, TableFormat::latex), "\n% a: this\\x0athat\n\\begin{table}"));
  CHECK(render_table(table, TableFormat::csv) == "n\n7\n");
}

TEST_CASE("a name in a table can neither control a terminal nor leave its cell") {
  const Table hostile = {"t\x1b[2J", {"na\nme"}, {{"a\x1b[31m\nb"}}};
  CHECK(render_table(hostile, TableFormat::text) ==
        "t\\x1b[2J\n"
        "na\\x0ame\n"
        "--------------\n"
        "a\\x1b[31m\\x0ab\n");
  for (const TableFormat format : {TableFormat::markdown, TableFormat::latex})
    CHECK_FALSE(test::has(render_table(hostile, format), "\x1b"));
  CHECK(render_table(hostile, TableFormat::csv) == "\"na\nme\"\n\"a\x1b[31m\nb\"\n");
}

TEST_CASE("CSV quotes fields if necessary and has no title") {
  CHECK(render_table(kTable, TableFormat::csv) == "name,n\n\"a|b, c\",7\n\xc3\xa4,123\n");
}

TEST_CASE("Markdown escapes bars") {
  CHECK(render_table(kTable, TableFormat::markdown) ==
        "**Title_1**\n\n| name | n |\n| --- | ---: |\n| a\\|b, c | 7 |\n| \xc3\xa4 | 123 |\n");
}

TEST_CASE("LaTeX escapes its special characters") {
  const std::string text = render_table({"a_b", {"50 %"}, {{"x & y"}}}, TableFormat::latex);
  CHECK(test::has(text, "\\caption{a\\_b}"));
  CHECK(test::has(text, "50 \\%"));
  CHECK(test::has(text, "x \\& y \\\\"));
}

TEST_CASE("LaTeX has minus signs, and rows that begin with a bracket or a star") {
  const Table table{"T", {"of", "n"}, {{"[a]", "-0.5 [-1, 2-3]"}, {"*b", "(-1 to -x)"}}};
  const std::string text = render_table(table, TableFormat::latex);
  CHECK(test::has(text, "\n{}[a] & \\shortstack[r]{$-$0.5\\\\{\\scriptsize [$-$1, 2-3]}} \\\\\n"));
  CHECK(test::has(text, "\n{}*b & ($-$1 to -x) \\\\\n"));
}

TEST_CASE("a LaTeX table has booktabs rules and a label for references") {
  CHECK(render_table({"fastable on query (pairs, tolerance 3)", {"n"}, {{"1"}}},
                     TableFormat::latex) ==
        "% \\usepackage{booktabs}\n\\begin{table}\n\\centering\n"
        "\\caption{fastable on query (pairs, tolerance 3)}\n"
        "\\label{tab:fastable-on-query-pairs-tolerance-3}\n"
        "\\begin{tabular}{r}\n\\toprule\nn \\\\\n\\midrule\n1 \\\\\n\\bottomrule\n"
        "\\end{tabular}\n\\end{table}\n");
}

TEST_CASE("the best cells are bold, marked by a star in text, and CSV has numbers only") {
  Table table{"T", {"of", "R@1", "gap"}, {{"a|b", "0.5", "-"}, {"c", "0.25", "3"}}};
  table.best = {{0, 1}, {1, 2}};
  CHECK(render_table(table, TableFormat::text) ==
        "T\n"
        "of     R@1  gap\n"
        "---------------\n"
        "a|b   0.5*   -\n"
        "c    0.25    3*\n"
        "* the best\n");
  CHECK(render_table(table, TableFormat::csv) == "of,R@1,gap\na|b,0.5,-\nc,0.25,3\n");
  CHECK(render_table(table, TableFormat::markdown) ==
        "**T**\n\n| of | R@1 | gap |\n| --- | ---: | ---: |\n| a\\|b | **0.5** | - |\n"
        "| c | 0.25 | **3** |\n");
  const std::string latex = render_table(table, TableFormat::latex);
  CHECK(test::has(latex, "a|b & \\textbf{0.5} & - \\\\"));
  CHECK(test::has(latex, "c & 0.25 & \\textbf{3} \\\\"));
  CHECK(test::has(latex, "\\label{tab:T}"));
}
