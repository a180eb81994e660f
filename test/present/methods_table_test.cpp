#include "present/methods_table.h"

#include <catch2/catch.hpp>

#include "present/html_page.h"
#include "support.h"

using namespace vpr;
using test::has;

namespace {

/// Windows over 10 frames with a match, `correct` of them recognized, and some accepted pairs.
Report windows(const std::string& name, uint64_t correct, LabelCounts pairs) {
  Report report;
  report.row_name = name;
  report.query = "walk";
  report.settings = QuerySettings(SequenceQuerySettings{Threshold{{.window_length = 2}, 0.5}});
  report.counts.recognitions = pairs;
  report.counts.best_match.frames = report.frames.localization.frames_with_match = 10;
  report.frames.localization.frames = 12;
  report.frames.localization.correct = correct;
  report.frames.localization.longest_gap_frames = 5;
  report.metrics.ranks[0][1] = static_cast<double>(correct) / 10;
  report.metrics.curves.single_best.values[0].value = 0.5;
  return report;
}

Report filter(const std::string& name, uint64_t correct) {
  Report report = windows(name, correct, {correct, 0, 0});
  report.settings = QuerySettings(SequenceQuerySettings{Filter{}});
  report.frames.localization.first_recognition_frames = 4;
  return report;
}

std::string table_of(const std::vector<Report>& reports, TableDetail detail, TableFormat format) {
  return render_table(methods_table(side_by_side(reports), detail), format);
}

}  // namespace

TEST_CASE("a table of methods has the incorrect pairs that a threshold accepted") {
  const std::vector<Report> reports = {filter("filter", 9), windows("windows", 6, {7, 41, 2})};
  CHECK(table_of(reports, TableDetail::brief, TableFormat::text) ==
        "walk: over 10 frames with a match; correct and incorrect: recognized frames\n"
        "method       R@1       AP  correct  incorrect  pairs incorrect  first\n"
        "---------------------------------------------------------------------\n"
        "filter   0.9000*  0.5000*        9          0                -      4\n"
        "windows  0.6000   0.5000*        6          0         41 of 50      -\n"
        "* the best\n");
  for (const TableFormat format : {TableFormat::latex, TableFormat::markdown})
    CHECK(has(table_of(reports, TableDetail::brief, format), "41 of 50"));
  CHECK(has(table_html(methods_table(side_by_side(reports), TableDetail::full)),
            "<td>41 of 50</td>"));
  CHECK_FALSE(has(table_of({reports[0], windows("windows", 6, {7, 0, 2})}, TableDetail::full,
                           TableFormat::text),
                  "pairs"));
}

TEST_CASE("longer tables have the same columns and more of them, data in full precision") {
  std::vector<Report> reports = {filter("filter", 9), windows("windows", 6, {7, 41, 2})};
  reports[1].metrics.ranks[0][1] = 0.62345678;
  CHECK(has(table_of(reports, TableDetail::full, TableFormat::text),
            "incorrect  pairs incorrect   share  longest gap  first\n"));
  const std::string data = table_of(reports, TableDetail::data, TableFormat::csv);
  CHECK(
      data.starts_with("method,query,margin,c_l,t_r,scale,R@1,AP,correct,incorrect,pairs correct,"
                       "pairs incorrect,pairs ignored,share,longest gap,first,"));
  CHECK(has(data, "\nwindows,walk,,2,0.5,relative,0.62345678,0.5,6,0,7,41,2,0.6,5,,"));
}

TEST_CASE(
    "frames at a threshold from the ground truth are unknown, and reports without labels or "
    "over other frames are not the best") {
  std::vector<Report> reports = {filter("a", 9), filter("b", 6), filter("c", 7)};
  reports[1].frames.is_oracle = true;
  reports[2].provenance.ground_truth = "another";
  reports[2].counts.best_match.frames = 9;
  reports[2].metrics.ranks[0][1] = 0.95;
  reports[2].protocol.ground_truth = "pairs from my desk";
  const std::string text = table_of(reports, TableDetail::brief, TableFormat::text);
  CHECK(has(text, "\nmethod  of frames      R@1 "));
  CHECK(has(text, "\na              10  0.9000*  0.5000*        9          0      4\n"));
  CHECK(has(text, "\nb              10  0.6000   0.5000*        -          -      -\n"));
  CHECK(has(text, "\nc               9  0.9500   0.5000         7          0      4\n"));
  CHECK(has(text, "\nb: threshold from the ground truth"));
  CHECK(has(text, "\nc: over 9 frames of its own; pairs from my desk\n"));
  for (Report& report : reports) {
    report.protocol.definitions = {{"labels", "single pairs"}};
    report.counts.best_match.ignored = 1;
  }
  CHECK_FALSE(has(table_of(reports, TableDetail::brief, TableFormat::text), "*"));
}

TEST_CASE("a comparison that omits frames names the counts of all frames") {
  const std::vector<Report> reports = {filter("filter", 9), windows("windows", 6, {7, 41, 2})};
  SideBySide methods = side_by_side(reports);
  methods.omits_frames = true;
  CHECK(has(render_table(methods_table(methods, TableDetail::brief), TableFormat::latex),
            "pairs incorrect (all frames)"));
}

TEST_CASE("long names are cut between letters") {
  const std::string begin(18, 'x');
  CHECK(
      short_text({"", {"name"}, {{begin + "\xc3\xa4 and more"}}}, true).ends_with(begin + "...\n"));
}
