// Results on the Nordland railway, winter as query and summer as training (1500 + 1500 frames).
#include <catch2/catch.hpp>

#include "base/json.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

TEST_CASE("best matches on Nordland, aligned within 2 frames, in percent") {
  const auto nordland = real_data("data/nordland");
  if (!nordland) return;
  run_ok("vpr-train", {"fastable", "--train", *nordland / "summer", "-o", "n.vprdb"});
  for (const auto& [length, per_cent] :
       std::vector<std::pair<int, double>>{{1, 10.5}, {10, 44.3}, {50, 92.2}, {100, 93.1}}) {
    run_ok("vpr-query", {"n.vprdb", "--query", *nordland / "winter", "--c-l",
                         std::to_string(length), "--t-r", "0.4", "--force", "-o", "r.json"});
    const auto eval = run_program(
        "vpr-eval", {"r.json", "--ground-truth", "aligned", "--tolerance", "2", "--json"});
    const double rate = Json::parse(eval.out)["best_match"]["rate"].get<double>();
    CHECK(100 * rate == Approx(per_cent).margin(0.05));
  }
}

TEST_CASE("relative thresholds on Nordland use the finished maximum: 2583 recognitions, not 631") {
  const auto nordland = real_data("data/nordland");
  if (!nordland) return;
  run_program("vpr-train", {"fastable", "--train", *nordland / "summer", "-o", "n.vprdb"});
  const auto query = run_program("vpr-query", {"n.vprdb", "--query", *nordland / "winter", "--c-l",
                                               "50", "--t-r", "0.55", "--json"});
  CHECK(Json::parse(query.out)["totals"]["recognitions"] == 2583);
}
