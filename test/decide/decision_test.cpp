// Decisions: their settings in files, and the range of margins.
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"
#include "decide/choices.h"
#include "decide/result.h"
#include "support.h"

using namespace vpr;

namespace {

SequenceQuerySettings by_margin(std::optional<double> margin = std::nullopt) {
  SequenceQuerySettings settings;
  settings.decision = Decision::margin;
  settings.margin = margin;
  return settings;
}

bool is_refused(const SequenceQuerySettings& settings) {
  return test::error_kind([&] { ResolvedSettings{settings}; }) == ErrorKind::usage;
}

}  // namespace

TEST_CASE("each decision has an entry with the keys of its setting") {
  REQUIRE(decision_kinds().size() == kEnumNames<Decision>.size());
  for (const DecisionKind& kind : decision_kinds()) {
    const Json all = value_to_json(SequenceQuerySettings{});
    for (const std::string_view key : kind.settings) CHECK(all.contains(std::string(key)));
    CHECK(all.contains(std::string(kind.symbol)));
  }
}

TEST_CASE("files hold the settings of the active decision") {
  const Json threshold = settings_in_force(SequenceQuerySettings{});
  for (const char* key : {"decide", "margin", "margin_width", "same_place"})
    CHECK_FALSE(threshold.contains(key));
  SequenceQuerySettings settings = by_margin(12.5);
  settings.margin_width = 3;
  settings.same_place = {"a=b"};
  const Json margin = settings_in_force(settings);
  for (const char* key : {"t_r", "t_r_scale", "safety_factor"}) CHECK_FALSE(margin.contains(key));
  CHECK(margin["decide"] == "margin");
  CHECK(margin["margin"] == 12.5);
  CHECK(margin["margin_width"] == 3);
  CHECK(margin["same_place"] == Json{"a=b"});
  CHECK(settings_in_force(by_margin())["margin"] == "auto");
}

TEST_CASE("a margin must be a finite number, not negative, and below the largest distance") {
  CHECK_FALSE(is_refused(by_margin()));
  CHECK_FALSE(is_refused(by_margin(0)));
  CHECK_FALSE(is_refused(by_margin(65535)));
  for (const double margin : {-0.1, std::nan(""), double{INFINITY}, 65536.0})
    CHECK(is_refused(by_margin(margin)));
  SequenceQuerySettings scored = by_margin(64);
  scored.score = Score::zscore;
  CHECK_FALSE(is_refused(scored));
  scored.margin = 65;
  CHECK(is_refused(scored));
}
