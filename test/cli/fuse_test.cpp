// Fusion of FAB-MAP and sequences in the programs.
#include <catch2/catch.hpp>

#include "files/result_file.h"
#include "world.h"

using namespace vpr;
using namespace vpr::test;

namespace {

/// A database of the sequence in the world's FAB-MAP database.
const std::string& database() {
  static const TemporaryFolder kFolder;
  static const std::string kPath = [] {
    const std::string path = kFolder / "one.vprdb";
    run_ok("vpr-train", {"fastable", "--train", world().walk("one"), "--c-l", "10", "-o", path});
    return path;
  }();
  return kPath;
}

RunOutcome query(Words words) {
  return run_program("vpr-query", joined({database(), "--query", world().walk("again")}, words));
}

}  // namespace

TEST_CASE("a fused query reports its FAB-MAP database") {
  const Json json =
      printed_json(query({"--fuse", world().fabmap(), "--c-l", "10", "--t-r", "-2", "--json"}));
  CHECK(json["settings"]["score"] == "zscore");
  CHECK(json["settings"]["fusion_weight"] == 0.2);
  CHECK(json["provenance"]["fused"].get<std::string>().starts_with("xxh3:"));
  CHECK(json["machine"]["paths"]["fuse"] == world().fabmap());
  const Json alone =
      printed_json(query({"--score", "zscore", "--c-l", "10", "--t-r", "-2", "--json"}));
  CHECK_FALSE(alone["settings"].contains("fusion_weight"));
  CHECK_FALSE(alone["provenance"].contains("fused"));
  CHECK(alone["provenance"]["query"] == json["provenance"]["query"]);
  const Json weak = printed_json(query({"--fuse", world().fabmap(), "--fusion-weight", "0", "--c-l",
                                        "10", "--t-r", "-2", "--json"}));
  CHECK(weak["totals"] == alone["totals"]);
  CHECK(weak["clusters"] == alone["clusters"]);
}

TEST_CASE("a result as settings selects the same database again") {
  const TemporaryFolder folder;
  const std::string result = folder / "r.json";
  ok(query({"--fuse", world().fabmap(), "--fusion-weight", "0.5", "--c-l", "10", "--t-r", "-2",
            "-o", result}));
  check_failure(query({"--config", result}), 2, "--fuse");
  const Json json = printed_json(query({"--config", result, "--fuse", world().fabmap(), "--json"}));
  CHECK(json["settings"]["fusion_weight"] == 0.5);
}

TEST_CASE("live frames have the results of the whole fused query") {
  const TemporaryFolder folder;
  std::string list;
  for (const std::string& name : images_of(world().walk("again")))
    list += world().walk("again") + "/" + name + "\n";
  write_text(folder / "list.txt", list);
  const auto asked = [&](const Words& command, const Words& more) {
    const Words words = {database(), "--query", folder / "list.txt", "--fuse", world().fabmap(),
                         "--c-l",    "10",      "--decide",          "margin"};
    return run_program("vpr-query", joined(command, joined(words, more)));
  };
  ok(asked({}, {"-o", folder / "r.json"}));
  const Result whole = read_result(folder / "r.json").result;
  const auto followed = ok(asked({"live"}, {"--quiet"}));
  const Words lines = lines_of(followed.out);
  REQUIRE(lines.size() == whole.query.frames);
  for (size_t window = 0; window < whole.best.size(); ++window) {
    const Json line = Json::parse(lines[window + 9]);
    CHECK(lines[window + 9] ==
          to_line(live_line({window + 9, line["name"], true}, &whole, window)));
  }
}

TEST_CASE("incompatible databases for fusion are refused with advice") {
  check_failure(query({"--fuse", world().fabmap(), "--score", "raw"}), 2, "--score raw");
  check_failure(query({"--fuse", database(), "--t-r", "-2"}), 4, "fabmap");
  check_failure("vpr-query",
                {world().database(), "--query", world().walk("again"), "--fuse", world().fabmap(),
                 "--t-r", "-2"},
                4, "two");
  check_failure("vpr-query",
                {world().fabmap(), "--query", world().walk("again"), "--fuse", world().fabmap()}, 2,
                "--fuse");
  check_failure(query({"--fuse", world().fabmap(), "--fusion-weight", "3", "--t-r", "-2"}), 2,
                "fusion_weight");
}

TEST_CASE("vpr-tune sweeps fused scores and prints the query that repeats them") {
  const auto outcome =
      run_ok("vpr-tune", {"fastable", database(), "--query", world().walk("again"),
                          "--ground-truth", "aligned", "--tolerance", "1000", "--fuse",
                          world().fabmap(), "--c-l", "5,10", "--t-r", "-3:-0.5:0.5"});
  CHECK(has(outcome.out, "--fuse " + world().fabmap()));
  CHECK(has(outcome.out, "--fusion-weight 0.2"));
}
