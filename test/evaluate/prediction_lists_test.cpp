// Prediction lists of other programs, and lists for them.
#include "evaluate/prediction_lists.h"

#include <cmath>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/random.h"
#include "support.h"

using namespace vpr;

namespace {

using Names = std::vector<std::string>;

const Names kQueries = {"q/a.jpg", "q/b.jpg", "q/c.jpg"};
const Names kReferences = {"db/left/1.jpg", "db/left/2.jpg", "db/right/1.jpg", "db/right/2.jpg"};

// Row by row, "-" for a missing score.
std::string rows_of(const ScoreMatrix& matrix) {
  std::vector<std::string> rows(matrix.queries);
  matrix.for_each_row(1, {}, "", [&](size_t, size_t query, std::span<const uint64_t> keys) {
    for (const uint64_t key : keys) {
      const double score = score_of_key(key, matrix.kind);
      rows[query] += std::isnan(score) ? " -" : fmt::format(" {}", score);
    }
  });
  return fmt::format("{}", fmt::join(rows, " |"));
}

struct List {
  std::string name = "list.txt";

  explicit List(const std::string& text, const std::string& called = "list.txt") : name(called) {
    test::write_text(name, text);
  }
  ScoreMatrix matrix(std::optional<ScoreOrder> kind = {}, const Names& queries = kQueries,
                     const Names& references = kReferences) const {
    return prediction_scores(name, FrameNames(queries), FrameNames(references), kind);
  }
  std::string error(std::optional<ScoreOrder> kind = {}) const {
    return test::error_text([&] { matrix(kind); });
  }
};

}  // namespace

TEST_CASE("frames are identified by the end of their paths") {
  const FrameNames names(kReferences);
  CHECK(names.count() == 4U);
  CHECK(names.find("db/left/2.jpg") == 1U);
  CHECK(names.find("/data/db/right/2.jpg") == 3U);
  CHECK(names.find("right/1.jpg") == 2U);
  CHECK_FALSE(names.find("1.jpg"));        // in two folders
  CHECK_FALSE(names.find("other/1.jpg"));  // in no folder
  CHECK_FALSE(names.find("3.jpg"));
  CHECK_FALSE(names.find("db/left/1.jpg db/left/2.jpg"));  // two frames
  CHECK(FrameNames({"q/a.jpg"}).find("/elsewhere/a.jpg") == 0U);
  CHECK(FrameNames({"q/a.jpg", "r/a.jpg"}).find("C:\\there\\r\\a.jpg") == 1U);
  const FrameNames numbers({});
  CHECK(numbers.count() == 0U);
  CHECK_FALSE(numbers.find("12"));
  CHECK(names.has("1.jpg"));
  CHECK(names.has("x/2"));
  CHECK_FALSE(names.has("left"));
}

TEST_CASE("names are the lines of a list, whether or not the files exist") {
  test::write_text("db.txt", "# names\r\none/1.jpg\r\n\nwith blank/2.jpg\ntwo/1.jpg\n");
  const auto names = [&](const FrameRange& range) { return frame_names({"db.txt", range}); };
  CHECK(names({}) == Names{"one/1.jpg", "with blank/2.jpg", "two/1.jpg"});
  CHECK(names({1, 3, 1}) == Names{"with blank/2.jpg", "two/1.jpg"});
  CHECK(names({0, {}, 2}) == Names{"one/1.jpg", "two/1.jpg"});
  CHECK(test::error_kind([&] { names({3, {}, 1}); }) == ErrorKind::usage);
  test::write_image("10.png", 1);
  test::write_image("9.png", 2);
  const Names found = frame_names({".", {}});
  REQUIRE(found.size() == 2);
  CHECK(found[0].ends_with("/9.png"));
}

TEST_CASE("lists of pairs have ranks, and those with scores have scores") {
  const List pairs(
      "q/b.jpg db/right/1.jpg\nq/b.jpg db/left/1.jpg\n\n# nothing\nq/a.jpg left/2.jpg\n");
  CHECK(rows_of(pairs.matrix()) == " - 1 - - | 2 - 1 - | - - - -");
  CHECK(pairs.matrix(ScoreOrder::distance).kind == ScoreOrder::distance);
  const List scored("a.jpg db/left/1.jpg 0.25\na.jpg db/right/2.jpg 0.5\na.jpg db/left/1.jpg 1\n");
  CHECK(rows_of(scored.matrix(ScoreOrder::similarity)) == " 1 - - 0.5 | - - - - | - - - -");
  CHECK(rows_of(scored.matrix(ScoreOrder::distance)) == " 0.25 - - 0.5 | - - - - | - - - -");
  const List table("query,reference,score\n\"q/c.jpg\",db/left/2.jpg,-3e-1\n", "list.csv");
  CHECK(rows_of(table.matrix(ScoreOrder::distance)) == " - - - - | - - - - | - -0.3 - -");
  CHECK(rows_of(List("0 2\n2 1\n").matrix({}, {}, {})) == " - - 1 | - - - | - 1 -");
  const List of_pandas(",query,reference\n0,0,2\n1,2,1\n", "pandas.csv");
  CHECK(rows_of(of_pandas.matrix({}, {}, {})) == " - - 1 | - - - | - 1 -");
}

TEST_CASE("a header states the order of the scores, and ranks are none") {
  const List near("query,reference,distance\n0,2,0.5\n0,1,0.25\n", "near.csv");
  CHECK(near.matrix({}, {}, {}).kind == ScoreOrder::distance);
  CHECK(test::has(near.error(ScoreOrder::similarity), "names the scores distance"));
  const List alike("query,reference,Similarity\n0,2,0.5\n", "alike.csv");
  CHECK(alike.matrix({}, {}, {}).kind == ScoreOrder::similarity);
  CHECK(test::has(alike.error(ScoreOrder::distance), "Omit --distance"));
  const List ranked("query,reference,rank\n0,2,2\n0,1,1\n", "ranked.csv");
  CHECK(rows_of(ranked.matrix({}, {}, {})) == " - 1 2");
  CHECK_FALSE(ranked.matrix({}, {}, {}).has_scores);
  CHECK(test::has(ranked.error(ScoreOrder::similarity), "ranks are distances"));
}

TEST_CASE("a first pair that may be a header of pandas is refused") {
  const std::string pairs = "0,2\n0,3\n1,1\n1,2\n";
  CHECK(test::has(List("0,1\n" + pairs, "list.csv").error(), "header of pandas"));
  CHECK_FALSE(test::has(List("0,1\n" + pairs + "1,3\n", "list.csv").error(), "pandas"));
}

TEST_CASE("rankings begin with the query, or are refused") {
  const auto rows = [](const std::string& text) { return rows_of(List(text).matrix({}, {}, {})); };
  CHECK(rows("0 0 2 1\n1 1 0\n") == " 1 3 2 | 2 1 -");  // a query among its references
  CHECK(rows("query,reference\n0,2,1\n1,0,1\n") == " - 2 1 | 1 2 -");
  CHECK(rows("query,a,b,c\n0,2,1,0\n1,0,1,\n") == " 3 2 1 | 1 2 -");
  CHECK(rows(",query,a,b,c\n7,0,2,1,0\n8,1,0,1,\n") == " 3 2 1 | 1 2 -");  // of pandas
  const auto error = [&](const std::string& text) { return test::error_text([&] { rows(text); }); };
  CHECK(test::has(error("0 1 2 3\n1 0 2 3\n"), "line 1: cannot tell whether"));
  CHECK(test::has(error("query reference\n0 1 2 3\n0 2 1 3\n"), "line 3: 0 has a line before"));
  test::write_text("list.txt", "0 2\n0 1\n1 0\n");
  const auto read = [&](size_t queries) {
    prediction_scores("list.txt", FrameNames({}), FrameNames({}), {}, {queries, 4});
  };
  CHECK(test::has(test::error_text([&] { read(3); }), "cannot tell"));  // a line per query
  CHECK_NOTHROW(read(4));
  test::write_text("list.txt",
                   "# Created by Octave 7.3.0\n# name: A\n# type: matrix\n 1 2\n 3 4\n");
  CHECK(test::has(test::error_text([&] { read(2); }), "save -v7 FILE.mat NAME in Octave"));
  test::write_text("list.txt", "2 0\n0 1\n1 2\n");  // queries once, but not in order
  CHECK(test::has(test::error_text([&] { read(3); }), "cannot tell"));
}

TEST_CASE("numbers in lists are names if all are, and nothing counts frames") {
  const Names names = {"1.jpg", "2.jpg", "3.jpg"};
  const auto rows = [&](const std::string& text) {
    return rows_of(List(text).matrix({}, names, names));
  };
  CHECK(rows("1 2\n2 3\n") == " - 1 - | - - 1 | - - -");
  CHECK(rows("0 1\n1 2\n") == " - 1 - | - - 1 | - - -");  // 0 is not a name
  CHECK(test::has(test::error_text([&] { rows("1 2\n2 7\n"); }), "training 7 is not a name"));
  CHECK(test::has(test::error_text([&] { List("01 2\n").matrix({}, {}, {}); }), "leading zeros"));
}

TEST_CASE("a folder has a file for each query") {
  const auto text = [](const char* query, const Names& found) {
    return fmt::format("Query path:\n{}\n\nPredictions paths:\n{}\n\nPositives paths:\n{}\n", query,
                       fmt::join(found, "\n"), "db/left/1.jpg");
  };
  test::write_text("000.txt", text("/data/q/a.jpg", {"/d/left/2.jpg", "/d/right/2.jpg"}));
  test::write_text("002.txt", text("/data/q/c.jpg", {"/d/right/1.jpg"}));
  test::write_text("000.jpg", "no list");
  const auto read = [&] {
    return prediction_scores(".", FrameNames(kQueries), FrameNames(kReferences), {});
  };
  CHECK(rows_of(read()) == " - 1 - 2 | - - - - | - - 1 -");
  const std::string before = read().fingerprint({});
  test::write_text("002.txt", text("/data/q/c.jpg", {"/d/left/1.jpg"}));
  CHECK(read().fingerprint({}) != before);
  for (const char* bad : {"", "Query path:\n", "something\n", "Predictions paths:\ndb/left/1.jpg\n",
                          "Query path:\nq/a.jpg\nq/b.jpg\n"}) {
    test::write_text("002.txt", bad);
    CHECK(test::error_kind(read) == ErrorKind::data);
    CHECK(test::has(test::error_text(read), "002.txt"));
  }
}

TEST_CASE("files of another format are refused, with the line") {
  CHECK(test::has(List("q/a.jpg db/left/1.jpg\nq/a.jpg\n").error(), "line 2"));
  CHECK(test::has(List("q/a.jpg db/left/1.jpg\nq/x.jpg db/left/1.jpg\n").error(),
                  "line 2: no query"));
  CHECK(test::has(List("q/a.jpg 1.jpg\n").error(), "no training frame, or more than one"));
  CHECK(List("q/a.jpg left/1.jpg 3\nq/a.jpg left/2.jpg\n").error(ScoreOrder::distance) != "");
  CHECK(test::has(List("q/a.jpg left/1.jpg nan\n").error(ScoreOrder::distance), "finite"));
  CHECK(test::has(List("q/a.jpg left/1.jpg 3\n").error(), "--similarity"));
  CHECK(test::has(List("q/a.jpg left/1.jpg\n").error(ScoreOrder::similarity), "ranks"));
  CHECK(test::has(List("# nothing\n").error(), "lists no reference"));
  CHECK(test::has(List("id,images\nq/a.jpg,1.jpg\n").error(), "A header has the columns"));
  CHECK(test::error_kind([] {
          prediction_scores("/off_map", FrameNames({}), FrameNames({}), {});
        }) == ErrorKind::input);
}

TEST_CASE("the best pairs equal those of sorted rows") {
  RandomEngine engine(3);
  constexpr size_t kRows = 7;
  constexpr size_t kColumns = 40;
  std::vector<float> scores(kRows * kColumns);
  for (float& score : scores) score = static_cast<float>(uniform_below(engine, 12));  // many ties
  for (size_t i = 0; i < kColumns; ++i) scores[3 * kColumns + i] = NAN;
  scores[3 * kColumns + 9] = 1;
  test::write_array("s.npy", scores, {kRows, kColumns});
  for (const ScoreOrder kind : {ScoreOrder::distance, ScoreOrder::similarity}) {
    const ScoreMatrix matrix("s.npy", {kind == ScoreOrder::similarity, false, {}});
    const ScoreLayout layout = layout_of(matrix, 3);
    const std::vector<MatchedFrame> pairs = best_pairs(matrix, layout, 5, {});
    REQUIRE(pairs.size() == 6 * 5 + 1);
    size_t p = 0;
    for (size_t row = 0; row < kRows; ++row) {
      std::vector<size_t> order;
      for (size_t i = 0; i < kColumns; ++i)
        if (!std::isnan(scores[row * kColumns + i])) order.push_back(i);
      std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        const float left = scores[row * kColumns + a];
        const float right = scores[row * kColumns + b];
        return kind == ScoreOrder::distance ? left < right : left > right;
      });
      for (size_t k = 0; k < std::min<size_t>(5, order.size()); ++k, ++p)
        CHECK(pairs[p] == MatchedFrame{row + 2, {0, order[k] + 2}});
    }
  }
}
