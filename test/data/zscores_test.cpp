// Z-scores on real images: their recall, and fast against reference implementation.
#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "npz.h"
#include "query/open.h"
#include "query/prepare.h"
#include "reference/verified_query.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

struct Early {
  double right = 0;  ///< correct best matches, in percent
  double early = 0;  ///< windows before the first incorrect one in order of score, in percent
};

Early recognized(const fs::path& folder, int tolerance) {
  const auto values = npz_array<int32_t>(folder / "r.npz", "best");
  const auto scores = npz_array<double>(folder / "r.npz", "best_scores");
  struct Row {
    double score;
    bool right;
  };
  std::vector<Row> rows;
  for (size_t i = 0; i < scores.size(); ++i)
    rows.push_back({scores[i], std::abs(values[3 * i] - values[3 * i + 2]) <= tolerance});
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.score < b.score; });
  const auto count = static_cast<double>(rows.size());
  const auto right = std::count_if(rows.begin(), rows.end(), [](const Row& r) { return r.right; });
  const auto wrong = std::find_if(rows.begin(), rows.end(), [](const Row& r) { return !r.right; });
  return {100.0 * static_cast<double>(right) / count,
          100.0 * static_cast<double>(wrong - rows.begin()) / count};
}

struct DataSet {
  const char* folder;
  const char* train;
  const char* query;
  int tolerance;
};

struct Figure {
  int window_length;
  const char* score;
  Early expected;
};

// Compares windows of the database and the query with the reference implementation.
void check_cells(const fs::path& query, const Figure& figure) {
  const WindowSettings windows{"fastable", static_cast<uint64_t>(figure.window_length),
                               enum_value<Score>(figure.score).value()};
  const SequenceQuerySettings settings{Threshold{windows, 0}};
  const SequenceDatabase database = open_database("d.vprdb", settings, {});
  const DescriptorSet frames = describe_query({query, {}}, database, settings, {});
  run_verified(plan_query(prepare(database, settings), frames, "query", settings, {}, {}), 100);
}

void check_figures(const DataSet& set, const std::vector<Figure>& figures) {
  const auto data = real_data(fmt::format("data/{}", set.folder));
  if (!data) return;
  run_ok("vpr-train",
         {"fastable", "--descriptor", "ldb", "--train", *data / set.train, "-o", "d.vprdb"});
  for (const Figure& figure : figures) {
    INFO(set.folder << ", c_l " << figure.window_length << ", " << figure.score);
    run_ok("vpr-query",
           {"d.vprdb", "--query", *data / set.query, "--score", figure.score, "--t-r", "0", "--c-l",
            std::to_string(figure.window_length), "--force", "-o", "r.json"});
    check_cells(*data / set.query, figure);
    const Early found = recognized(".", set.tolerance);
    CHECK(found.right == Approx(figure.expected.right).margin(0.05));
    CHECK(found.early == Approx(figure.expected.early).margin(0.5));
  }
}

}  // namespace

TEST_CASE("z-scores recognize the corridor earlier") {
  check_figures({"corridor", "ref", "query", 3}, {{5, "raw", {48.6, 12}},
                                                  {5, "zscore", {72.0, 34}},
                                                  {10, "zscore", {93.1, 33}},
                                                  {20, "zscore", {100, 100}}});
}

TEST_CASE("z-scores recognize the corridor earlier with exchanged roles as well") {
  check_figures({"corridor", "query", "ref", 3}, {{10, "raw", {61.8, 17}},
                                                  {10, "zscore", {83.3, 56}},
                                                  {20, "raw", {94.6, 50}},
                                                  {20, "zscore", {94.6, 85}}});
}

TEST_CASE("z-scores recognize Nordland earlier") {
  check_figures({"nordland", "summer", "winter", 2}, {{10, "raw", {44.6, 0}},
                                                      {10, "zscore", {78.5, 2}},
                                                      {20, "zscore", {87.9, 1}},
                                                      {50, "zscore", {99.1, 94}}});
}

TEST_CASE("a stop of one minute in the corridor changes no score before or after it") {
  const auto corridor = real_data("data/corridor");
  if (!corridor) return;
  constexpr size_t kStop = 60;       // the frame at which the walk stops
  constexpr size_t kStanding = 600;  // a minute at 10 frames per second
  constexpr size_t kLength = 10;
  std::string list;
  for (size_t frame = 0; frame < 111; ++frame)
    for (size_t n = 0; n < (frame == kStop ? kStanding + 1 : 1); ++n)
      list += (*corridor / "query" / fmt::format("{:07}.jpg\n", frame)).string();
  write_text("stop.txt", list);
  run_ok("vpr-train", {"fastable", "--train", *corridor / "ref", "-o", "d.vprdb"});
  const auto best_rows = [&](const fs::path& query, const std::string& name) {
    run_ok("vpr-query", {"d.vprdb", "--query", query, "--score", "zscore", "--t-r", "0", "--c-l",
                         std::to_string(kLength), "-o", (name + ".json")});
    const auto values = npz_array<int32_t>(name + ".npz", "best");
    const auto scores = npz_array<double>(name + ".npz", "best_scores");
    std::vector<std::array<double, 3>> rows;  // target, window and score
    for (size_t i = 0; i < scores.size(); ++i)
      rows.push_back({double(values[3 * i + 1]), double(values[3 * i + 2]), scores[i]});
    return rows;
  };
  const auto moving = best_rows(*corridor / "query", "moving");
  const auto standing = best_rows("stop.txt", "standing");
  for (size_t window = 0; window + kLength <= 111; ++window) {
    if (window <= kStop && window + kLength > kStop + 1) continue;  // spans the stop
    const size_t later = window > kStop ? window + kStanding : window;
    CHECK(standing[later] == moving[window]);
  }
}
