// Fusion of FAB-MAP and sequences in the programs.
#include <catch2/catch.hpp>

#include "world.h"

using namespace vpr;
using namespace vpr::test;

namespace {

/// A database of the sequence in the world's FAB-MAP database.
void make_database() { run_ok("vpr-train fastable --train $one --c-l 10 -o one.vprdb"); }

RunOutcome query(const std::string& words) {
  return run("vpr-query one.vprdb --query $again " + words);
}

}  // namespace

TEST_CASE("a fused query reports its FAB-MAP database") {
  start_with(make_database);
  const Json json = printed_json(query("--fuse $fabmap --c-l 10 --t-r -2 --json"));
  CHECK(json["settings"]["score"] == "zscore");
  CHECK(json["settings"]["fusion_weight"] == 0.2);
  CHECK(json["provenance"]["fused"].get<std::string>().starts_with("xxh3:"));
  CHECK(json["machine"]["paths"]["fuse"] == world().fabmap());
  const Json alone = printed_json(query("--score zscore --c-l 10 --t-r -2 --json"));
  CHECK_FALSE(alone["settings"].contains("fusion_weight"));
  CHECK_FALSE(alone["provenance"].contains("fused"));
  CHECK(alone["provenance"]["query"] == json["provenance"]["query"]);
  const Json weak =
      printed_json(query("--fuse $fabmap --fusion-weight 0 --c-l 10 --t-r -2 --json"));
  CHECK(weak["totals"] == alone["totals"]);
  CHECK(weak["clusters"] == alone["clusters"]);
}

TEST_CASE("a result as settings selects the same database again") {
  start_with(make_database);
  ok(query("--fuse $fabmap --fusion-weight 0.5 --c-l 10 --t-r -2 -o r.json"));
  check_failure(query("--config r.json"), 2, "--fuse");
  const Json json = printed_json(query("--config r.json --fuse $fabmap --json"));
  CHECK(json["settings"]["fusion_weight"] == 0.5);
}

TEST_CASE("incompatible databases for fusion are refused with advice") {
  start_with(make_database);
  check_refused("vpr-query", {{"$db --query $again --fuse $fabmap --t-r -2", 4, "two"},
                              {"$fabmap --query $again --fuse $fabmap", 2, "--fuse"}});
  check_refused("vpr-query one.vprdb --query $again",
                {{"--fuse $fabmap --score raw", 2, "--score raw"},
                 {"--fuse one.vprdb --t-r -2", 4, "fabmap"},
                 {"--fuse $fabmap --fusion-weight 3 --t-r -2", 2, "fusion_weight"}});
}

TEST_CASE("vpr-tune sweeps fused scores and prints the query that repeats them") {
  start_with(make_database);
  const auto outcome = run_ok(
      "vpr-tune fastable one.vprdb"
      " --query $again --ground-truth aligned --tolerance 1000 --fuse "
      "$fabmap --c-l 5,10 --t-r -3:-0.5:0.5");
  CHECK(has(outcome.out, "--fuse " + world().fabmap()));
  CHECK(has(outcome.out, "--fusion-weight 0.2"));
}
