// Automatic thresholds of six floors of an office tower, which look alike (635 frames).
#include <catch2/catch.hpp>

#include "printed.h"

using namespace vpr;
using namespace vpr::test;

TEST_CASE("automatic thresholds of the tower equal equation (5), and a large one is reported") {
  const auto tower = real_data("data/tower");
  if (!tower) return;
  Words train = {"fastable", "--c-l", "40", "-o", "t.vprdb", "--json"};
  for (const std::string floor : {"5", "7", "9", "12", "15", "18"})
    train = joined(train, {"--train", *tower / ("floor" + floor)});
  const Json info = printed_json("vpr-train", train);
  CHECK(info["sequences"][0]["t_r"][0]["bits"] == Approx(607.35));
  CHECK(info["sequences"][5]["t_r"][0]["bits"] == Approx(606.175));
  const auto query = [&](const std::filesystem::path& walk) {
    return run_ok("vpr-query",
                  {"t.vprdb", "--query", walk, "--c-l", "40", "--force", "-o", "r.json"})
        .err;
  };
  CHECK(has(query(*tower / "floor18"), "the same frames as the training sequence floor18"));
  const auto corridor = real_data("data/corridor");  // looks different from every floor
  if (!corridor) return;
  run_ok("vpr-train", {"add", "t.vprdb", "--train", *corridor / "ref", "-o", "t.vprdb", "--force"});
  const std::string warnings = query(*corridor / "query");
  CHECK(has(warnings, "are 160 x 120, those of floor5 are 640 x 360"));
  CHECK(has(warnings, "t_r accepts 100 % of the window pairs of ref: too many to tell"));
}
