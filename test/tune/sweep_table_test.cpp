#include <catch2/catch.hpp>

#include "support.h"
#include "tune/sweep_report.h"

using namespace vpr;

namespace {

CellCounts cell(uint64_t c_l, std::optional<double> t_r, LabelCounts recognitions,
                LabelCounts places, uint64_t mixed) {
  CellCounts made{c_l, t_r, ThresholdScale::relative, {}};
  made.counts.recognitions = recognitions;
  made.counts.recognitions_by_place = {recognitions.correct + recognitions.incorrect, 0,
                                       recognitions.ignored};
  made.counts.clusters = places;
  made.counts.mixed_clusters = mixed;
  made.counts.distinct = places.correct;
  made.counts.best_match.frames = made.path.frames_with_match = 9;
  made.counts.best_match.correct = 7;
  made.counts.best_match.incorrect = 1;
  return made;
}

Sweep example() {
  Sweep sweep;
  sweep.query.name = "a walk, \"quoted\"";
  sweep.cells = {cell(5, 0.3, {4, 0, 0}, {1, 0, 0}, 0), cell(5, 0.4, {6, 0, 1}, {1, 0, 0}, 0),
                 cell(5, 0.5, {24, 8, 2}, {2, 0, 1}, 1)};
  sweep.recommendation = recommend(sweep.cells, ScoreOrder::distance);
  return sweep;
}

// Without the line breaks of wrapped_text.
std::string unwrapped(std::string text) {
  for (size_t at; (at = text.find("\n  ")) != std::string::npos;) text.replace(at, 3, " ");
  return text;
}

}  // namespace

TEST_CASE("a sweep as CSV has one row per cell, with recognitions and places") {
  CHECK(render_table(cells_table({example()}), TableFormat::csv) ==
        "query,c_l,t_r,scale,pairs_correct,pairs_incorrect,pairs_ignored,pairs_by_cluster_correct,"
        "pairs_by_cluster_incorrect,pairs_by_cluster_ignored,clusters_correct,clusters_mixed,"
        "clusters_incorrect,clusters_ignored,distinct,best_match_correct,best_match_incorrect,"
        "frames_with_match,pareto,recommended\n"
        "\"a walk, \"\"quoted\"\"\",5,0.3,relative,4,0,0,4,0,0,1,0,0,0,1,7,1,9,no,yes\n"
        "\"a walk, \"\"quoted\"\"\",5,0.4,relative,6,0,1,6,0,1,1,0,0,0,1,7,1,9,yes,no\n"
        "\"a walk, \"\"quoted\"\"\",5,0.5,relative,24,8,2,32,0,2,2,1,0,1,2,7,1,9,yes,no\n");
}

TEST_CASE("FAB-MAP's rows have the same columns, empty for places") {
  Sweep sweep;
  sweep.query.name = "q";
  CellCounts fabmap{3, 0.9, {}, {}};
  sweep.score = &probability_kind();
  fabmap.counts.recognitions = {5, 1, 0};
  fabmap.counts.distinct = 2;
  sweep.cells = {fabmap};
  const Table table = cells_table({sweep});
  CHECK(table.columns.size() == cells_table({example()}).columns.size());
  CHECK(table.rows[0] ==
        std::vector<std::string>{"q", "3", "0.9", "probability", "5", "1", "0", "",   "",  "", "",
                                 "",  "",  "",    "2",           "0", "0", "0", "no", "no"});
}

TEST_CASE(
    "tables have recognitions next to places, and the incorrect recognitions of correct places") {
  const std::vector<Table> tables = sweep_tables({example()});
  REQUIRE(tables.size() == 3);
  CHECK(tables[0].columns == std::vector<std::string>{"t_r", "5 correct", "5 incorrect"});
  CHECK(tables[0].rows == std::vector<std::vector<std::string>>{
                              {"0.3", "4*", "0"}, {"0.4", "6", "0"}, {"0.5", "24", "8"}});
  CHECK(tables[1].rows[2] == std::vector<std::string>{"0.5", "2 (1)", "0"});
  CHECK(tables[2].rows == std::vector<std::vector<std::string>>{{"7", "1"}});
  const Table both = sweep_tables({example(), example()})[0];
  CHECK(both.columns[0] == "query");
  CHECK(both.rows.size() == 6);
}

TEST_CASE("the best cell of each window is listed, without errors if possible") {
  Sweep sweep = example();
  sweep.cells.push_back(cell(10, 0.3, {1, 2, 0}, {0, 1, 0}, 0));
  sweep.cells.push_back(cell(10, 0.4, {9, 1, 0}, {0, 1, 0}, 0));
  sweep.cells[0].path.correct = 2;
  sweep.cells[2].path.correct = 5;
  sweep.cells[4].path.correct = 6;
  const Table table = best_cells_table(sweep);
  CHECK(table.title ==
        "a walk, \"quoted\": best t_r of each c_l, over 9 frames with a match (* recommended)");
  CHECK(table.rows == std::vector<std::vector<std::string>>{{"5*", "0.3", "2", "0", "0"},
                                                            {"10", "0.4", "6", "0", "1"}});
  sweep.cells[1].path.correct = 3;  // not recommended, because the next looser one has errors
  CHECK(best_cells_table(sweep).rows ==
        std::vector<std::vector<std::string>>{{"5*", "0.3", "2", "0", "0"},
                                              {"5", "0.4", "3", "0", "0"},
                                              {"10", "0.4", "6", "0", "1"}});
}

TEST_CASE("the recommendation names the first error") {
  Sweep sweep = example();
  sweep.cells[0].path.correct = 2;
  sweep.cells[2].path.correct = 5;
  sweep.cells[2].path.incorrect = 1;
  const std::string text = unwrapped(recommendation_text(sweep, false));
  CHECK(text.starts_with("Recommended: c_l 5, t_r 0.3 (relative): 2 of 9 frames correctly, 0"));
  CHECK(test::has(text,
                  "The first error of c_l 5 is at t_r 0.5, where 8 of the 34 accepted pairs are "
                  "incorrect.\n"));
  Sweep short_grid = example();
  short_grid.cells.resize(1);
  short_grid.recommendation = recommend(short_grid.cells, ScoreOrder::distance);
  CHECK(test::has(unwrapped(recommendation_text(short_grid, false)), "the grid has no looser t_r"));
}

TEST_CASE("a sweep names the filter if it recognizes more frames and no more incorrectly") {
  Sweep sweep = example();
  sweep.cells[0].path.frames_with_match = 111;
  sweep.cells[0].path.correct = 36;
  Localization filter;
  filter.frames_with_match = 111;
  filter.correct = 68;
  const auto says = [&](const std::string& words) {
    sweep.filter = filter;
    return unwrapped(recommendation_text(sweep, false)).find(words) != std::string::npos;
  };
  CHECK(says("36 of 111 frames correctly, 0 incorrectly"));
  CHECK(says("the filter, recognizes 68 correctly and 0 incorrectly."));
  filter.incorrect = 1;
  CHECK_FALSE(says("filter"));
  sweep.recommendation.cell.reset();
  CHECK(says("The filter recognizes 68 of 111 frames correctly, 1 incorrectly."));
  CHECK_FALSE(says("Use the filter"));
  filter.incorrect = 0;
  CHECK(says("Use the filter: vpr-query without flags of windows."));
  filter.correct = 0;
  filter.incorrect = 7;
  filter.off_map = 2;
  CHECK(says("0 of 111 frames correctly, 7 incorrectly (2 of them without a match).\n"));
  CHECK_FALSE(says("another place"));
  sweep.advice = "The query has 3 keyframes.";
  CHECK(says("The query has 3 keyframes.\n"));
}

TEST_CASE("a validation has the sentence of vpr-eval about incorrect pairs") {
  Sweep sweep = example();
  sweep.validation = {"again", cell(5, 0.3, {16, 2, 0}, {1, 0, 0}, 0)};
  sweep.validation->cell.path.correct = sweep.validation->cell.path.recognized = 7;
  CHECK(unwrapped(validation_text(sweep)) ==
        "On the validation, again: 7 of 9 frames correctly, 0 incorrectly; 2 of the 18 accepted "
        "window pairs are incorrect.\n");
}
