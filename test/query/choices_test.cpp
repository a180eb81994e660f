// The choice of a rule: every refused combination is refused by name, and nothing else is.
#include "query/choices.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"

using namespace vpr;

namespace {

SequenceQuerySettings chosen_by(const Json& json, QueryCommand command = QueryCommand::query) {
  SequenceKeys keys;
  value_from_json(json, keys, "test", "settings");
  std::vector<std::string> given;
  for (const auto& item : json.items()) given.push_back(item.key());
  return choose_query(keys, given, command);
}

/// The sentence of the refusal; empty without one.
std::string error_of(const Json& json, QueryCommand command) {
  try {
    chosen_by(json, command);
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::usage);
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("settings that cannot be combined are refused by both names, with the cure") {
  struct Refused {
    Json keys;
    const char* first;
    const char* second;
    QueryCommand command = QueryCommand::query;
  };
  constexpr QueryCommand kLive = QueryCommand::live;
  constexpr QueryCommand kLoops = QueryCommand::loops;
  constexpr QueryCommand kSweep = QueryCommand::sweep;
  const std::vector<Refused> all = {
      // Scores and decisions.
      {{{"t_r_scale", "mean-z"}}, "--t-r-scale mean-z", "--score raw"},
      {{{"score", "zscore"}, {"t_r", -1}, {"t_r_scale", "bits"}}, "--t-r-scale bits", "zscore"},
      {{{"score", "zscore"}, {"t_r", 0}, {"t_r_scale", "relative"}}, "relative", "zscore"},
      {{{"score", "zscore"}}, "an automatic t_r", "--score zscore"},
      {{{"safety_factor", 0.9}, {"t_r", 0.5}}, "--safety-factor", "--t-r"},
      {{{"method", "openable"}, {"score", "zscore"}, {"t_r", -1}}, "--score zscore", "openable"},
      {{{"c_l", 5}, {"margin", 3}}, "--margin", "--decide threshold"},
      {{{"decide", "margin"}, {"t_r", 0.5}}, "--t-r", "--decide margin"},
      {{{"decide", "margin"}, {"t_r_scale", "bits"}}, "--t-r-scale bits", "--decide margin"},
      {{{"decide", "margin"}, {"safety_factor", 0.9}}, "--safety-factor", "--decide margin"},
      // Methods.
      {{{"method", "lsh"}, {"decide", "margin"}}, "--decide margin", "--method lsh"},
      {{{"method", "lsh"}, {"score", "zscore"}}, "--score zscore", "--method lsh"},
      {{{"method", "lsh"}, {"t_r", 0.5}}, "a relative --t-r", "--method lsh"},
      {{{"method", "lsh"}, {"t_r", 0.5}, {"t_r_scale", "relative"}}, "relative", "--method lsh"},
      {{{"method", "lsh"}, {"margin", 3}}, "--margin", "--method lsh"},
      {{{"method", "lsh"}, {"same_place", {"a=b"}}}, "--same-place", "--method lsh"},
      {{{"method", "filter"}, {"t_r", 0.5}}, "--t-r", "--method filter"},
      {{{"method", "filter"}, {"t_r_scale", "mean-z"}}, "--t-r-scale mean-z", "--method filter"},
      {{{"method", "filter"}, {"safety_factor", 0.9}}, "--safety-factor", "--method filter"},
      {{{"method", "filter"}, {"exclusion_frames", 3}}, "--exclusion-frames", "--method filter"},
      {{{"method", "filter"}, {"c_l", 5}}, "--c-l", "--method filter"},
      {{{"method", "filter"}, {"score", "raw"}}, "--score raw", "--method filter"},
      {{{"method", "filter"}, {"decide", "threshold"}}, "--decide threshold", "--method filter"},
      {{{"method", "filter"}, {"lsh", {{"tables", 3}}}}, "\"lsh\"", "--method filter"},
      {{{"c_l", 5}, {"filter", {{"path_keyframes", 9}}}}, "\"filter\"", "--decide threshold"},
      // A loop query.
      {{{"loop_gap", 9}, {"method", "filter"}}, "--method filter", "vpr-query loops", kLoops},
      {{{"loop_gap", 9}, {"method", "lsh"}}, "--method lsh", "vpr-query loops", kLoops},
      {{{"loop_gap", 9}, {"t_r_scale", "relative"}}, "relative", "vpr-query loops", kLoops},
      {{{"loop_gap", 9}, {"decide", "margin"}}, "a default --margin", "vpr-query loops", kLoops},
      {{{"loop_gap_s", 9.0}, {"decide", "margin"}, {"margin", 3}},
       "an automatic --exclusion-frames",
       "vpr-query loops",
       kLoops},
      {{{"loop_gap", 9}, {"only_sequence", {"a"}}}, "--only-sequence", "loops", kLoops},
      {{{"loop_gap", 9}, {"same_place", {"a=b"}}}, "--same-place", "loops", kLoops},
      {{{"loop_gap", 9}, {"safety_factor", 0.9}}, "--safety-factor", "--t-r", kLoops},
      {{{"descriptor", "hog"}}, "--descriptor hog", "vpr-query"},
      {{{"loop_gap", 9}}, "\"loop_gap\"", "vpr-query"},
      // Frames as they arrive.
      {{{"method", "openable"}}, "vpr-query live", "--method openable", kLive},
      {{{"method", "lsh"}}, "vpr-query live", "--method lsh", kLive},
      {{{"t_r", 0.5}}, "a relative --t-r", "vpr-query live", kLive},
      // vpr-tune.
      {{{"method", "filter"}}, "vpr-tune fastable", "--method filter", kSweep},
      {{{"method", "lsh"}}, "vpr-tune fastable", "--method lsh", kSweep}};
  for (const Refused& one : all) {
    const std::string error = error_of(one.keys, one.command);
    const size_t middle = error.find(" does not go with ");
    INFO(one.keys.dump() << ": " << error);
    CHECK(error.find(one.first) < middle);
    CHECK(error.find(one.second, middle) < error.size());
    CHECK(error.ends_with('.'));
    CHECK(error.find(". ", middle) < error.size());
  }
}

TEST_CASE("settings that can be combined are accepted") {
  struct Accepted {
    Json keys;
    QueryCommand command = QueryCommand::query;
  };
  const std::vector<Accepted> all = {
      {Json::object()},
      {{{"method", "openable"}, {"t_r", 200}, {"t_r_scale", "bits"}}},
      {{{"method", "lsh"}, {"t_r", 200}, {"t_r_scale", "bits"}}},
      {{{"method", "lsh"}}},
      {{{"method", "filter"}, {"margin", 3}, {"same_place", {"a=b"}}, {"only_sequence", {"a"}}}},
      {{{"method", "filter"}}, QueryCommand::live},
      {{{"t_r", 200}, {"t_r_scale", "bits"}, {"skip_unreadable", true}}, QueryCommand::live},
      {{{"t_r_scale", "relative"}}, QueryCommand::live},
      {{{"decide", "margin"}}, QueryCommand::live},
      {{{"score", "zscore"}, {"t_r", -1}, {"t_r_scale", "mean-z"}}},
      {{{"score", "zscore"}, {"decide", "margin"}, {"margin", 3}, {"exclusion_frames", 3}}},
      {{{"loop_gap", 9}, {"descriptor", "hog"}}, QueryCommand::loops},
      {{{"loop_gap_s", 9.0}, {"score", "zscore"}, {"t_r", -1}}, QueryCommand::loops},
      {{{"loop_gap", 9}, {"method", "openable"}, {"decide", "margin"}, {"margin", 3}},
       QueryCommand::loops},
      {{{"score", "zscore"}}, QueryCommand::sweep},
      {{{"decide", "margin"}}, QueryCommand::sweep}};
  for (const Accepted& one : all) {
    INFO(one.keys.dump());
    CHECK(error_of(one.keys, one.command) == "");
  }
}

TEST_CASE("the settings of any result are a configuration with the same settings") {
  const std::vector<std::pair<Json, QueryCommand>> all = {
      {Json::object(), QueryCommand::query},
      {{{"c_l", 5}}, QueryCommand::query},
      {{{"c_l", 5}, {"score", "zscore"}, {"decide", "margin"}}, QueryCommand::query},
      {{{"method", "lsh"}, {"t_r", 200}, {"t_r_scale", "bits"}}, QueryCommand::query},
      {{{"loop_gap", 9}, {"c_l", 5}, {"t_r", 50}}, QueryCommand::loops},
      {{{"loop_gap_s", 9.0}, {"score", "zscore"}}, QueryCommand::loops}};
  for (const auto& [keys, command] : all) {
    const Json first = settings_in_force(chosen_by(keys, command));
    INFO(first.dump());
    CHECK(settings_in_force(chosen_by(first, command)) == first);
  }
}

TEST_CASE("values of settings are checked") {
  for (const Json& keys : std::vector<Json>{{{"c_l", 0}},
                                            {{"method", "fastabel"}},
                                            {{"t_r", -1}},
                                            {{"t_r", 55}},
                                            {{"score", "zscore"}, {"t_r", 0.5}},
                                            {{"score", "zscore"}, {"t_r", -1}, {"c_l", 100'000}},
                                            {{"c_l", 5}, {"safety_factor", 0}},
                                            {{"margin", 65}},
                                            {{"clustering", {{"eps", -1}}}}}) {
    INFO(keys.dump());
    CHECK(error_of(keys, QueryCommand::query) != "");
  }
  for (const Json& keys : std::vector<Json>{
           Json::object(), {{"loop_gap", 3}, {"loop_gap_s", 3.0}}, {{"loop_gap_s", -3.0}}}) {
    INFO(keys.dump());
    CHECK(error_of(keys, QueryCommand::loops) != "");
  }
}

TEST_CASE("settings of windows select FastABLE; otherwise the filter is the method") {
  using Keys = std::vector<std::string>;
  CHECK(default_method(QueryCommand::query, Keys{}) == "filter");
  CHECK(default_method(QueryCommand::query, Keys{"margin", "only_sequence"}) == "filter");
  for (const char* key :
       {"c_l", "t_r", "t_r_scale", "safety_factor", "score", "decide", "exclusion_frames"})
    CHECK(default_method(QueryCommand::query, Keys{"margin", key}) == "fastable");
  CHECK(default_method(QueryCommand::loops, Keys{}) == "fastable");
}
