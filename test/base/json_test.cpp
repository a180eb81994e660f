#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json_schema.h"
#include "base/text.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

enum class Fruit { apple, pear };

struct Inner {
  int64_t depth = 2;
};
template <class Visitor>
void visit_fields(Inner& inner, Visitor&& visit) {
  visit("depth", inner.depth, "meters below ground (default: {})", within(-9, 9));
}

struct Outer {
  double ratio = 0.5;
  std::optional<double> limit;
  uint64_t count = 1;
  bool on = false;
  std::string name = "n";
  std::vector<std::string> list;
  Fruit fruit = Fruit::apple;
  Inner inner;
};
template <class Visitor>
void visit_fields(Outer& outer, Visitor&& visit) {
  visit("ratio", outer.ratio, "Share.", above(0), kRequired);
  visit("limit", outer.limit, "Most.", kMayBeMissing);
  visit("count", outer.count);
  visit("on", outer.on);
  visit("name", outer.name);
  visit("list", outer.list);
  visit("fruit", outer.fruit);
  visit("inner", outer.inner);
}

}  // namespace

namespace vpr {
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Fruit> = {"apple", "pear"};
}

TEST_CASE("settings survive conversion to JSON and back") {
  Outer outer;
  outer.limit = 0.25;
  outer.fruit = Fruit::pear;
  outer.list = {"a", "b"};
  outer.inner.depth = -7;
  Outer back;
  value_from_json(value_to_json(outer), back, "test", "outer");
  CHECK(value_to_json(back).dump() == value_to_json(outer).dump());
  CHECK(value_to_json(Outer{})["limit"] == "auto");
}

TEST_CASE("the schema of a struct follows from its fields") {
  const Json schema = schema_of<Outer>(SchemaForm::in_force);
  const Json& properties = schema["properties"];
  CHECK(properties["ratio"].dump() ==
        R"({"description":"Share.","type":"number","exclusiveMinimum":0})");
  CHECK(properties["limit"].dump() ==
        R"({"description":"Most.","anyOf":[{"type":"number"},{"const":"auto"}]})");
  CHECK(properties["count"].dump() == R"({"type":"integer","minimum":0})");
  CHECK(properties["list"].dump() == R"({"type":"array","items":{"type":"string"}})");
  CHECK(properties["fruit"].dump() == R"({"enum":["apple","pear"]})");
  CHECK(properties["inner"]["properties"]["depth"].dump() ==
        R"({"description":"Meters below ground.","type":"integer","minimum":-9,"maximum":9})");
  CHECK(schema["required"].dump() == R"(["ratio","count","on","name","list","fruit","inner"])");
  CHECK(schema_of<Outer>(SchemaForm::partial)["required"].dump() == R"(["ratio"])");
  CHECK(schema_of<Outer>()["properties"]["limit"]["type"].dump() == R"(["number","null"])");
}

TEST_CASE("the schema of two forms of a file requires the common keys") {
  const Json a = schema_of<Inner>();
  const Json both = merged(schema_of<Outer>(), a);
  CHECK(both["required"].empty());
  CHECK(both["properties"].contains("depth"));
  CHECK(merged(a, a) == a);
}

TEST_CASE("missing keys leave their fields unchanged") {
  Outer outer;
  outer.count = 9;
  value_from_json(Json::parse(R"({"inner": {}})"), outer, "test", "outer");
  CHECK(outer.count == 9);
}

TEST_CASE("an unknown key is refused, and the nearest known one is suggested") {
  Outer outer;
  const auto text = error_text(
      [&] { value_from_json(Json::parse(R"({"raito": 1})"), outer, "a.json", "outer"); });
  CHECK(text == "a.json: unknown key \"raito\"; did you mean \"ratio\"?");
}

TEST_CASE("values of the wrong type or out of range are refused") {
  const std::string bad =
      GENERATE(R"({"ratio": "x"})", R"({"count": -1})", R"({"count": 1.5})", R"({"on": 1})",
               R"({"name": 3})", R"({"fruit": "plum"})", R"({"inner": 3})", R"({"limit": true})",
               R"({"list": [1]})", R"({"count": 99999999999999999999})");
  Outer outer;
  CHECK(error_kind([&] { value_from_json(Json::parse(bad), outer, "t", "outer"); }) ==
        ErrorKind::usage);
}

TEST_CASE("the edit distance counts inserts, deletes, replacements and swaps") {
  CHECK(edit_distance("", "abc") == 3);
  CHECK(edit_distance("abc", "abc") == 0);
  CHECK(edit_distance("c_l", "cl") == 1);
  CHECK(edit_distance("raito", "ratio") == 1);
  CHECK(edit_distance("kitten", "sitting") == 3);
}

TEST_CASE("errors distinguish schemas of another kind and of another version") {
  const auto text = [](const char* schema) {
    return error_text([&] {
      require_schema(Json{{"schema", schema}}, "result", "r.json", ErrorKind::data);
    });
  };
  CHECK(text("vpr.result/5").empty());
  for (const char* other : {"vpr.result/2", "vpr.result/6"})
    CHECK(text(other) ==
          fmt::format("r.json: has schema {}, written by another version of the program "
                      "(this one reads vpr.result/5). Run the command that wrote it "
                      "again",
                      other));
  CHECK(text("vpr.report/5") == "r.json: expected schema vpr.result/5, found vpr.report/5");
  CHECK(error_kind([] { require_schema(Json(3), "result", "r", ErrorKind::data); }) ==
        ErrorKind::data);
}

TEST_CASE("text with invalid UTF-8 can still be written") {
  CHECK(to_text(Json{{"name", "a\xff"}}) == "{\n  \"name\": \"a\xef\xbf\xbd\"\n}\n");
}

TEST_CASE("JSON with excessive nesting is refused") {
  CHECK(parse_json("[[1]]").has_value());
  CHECK(parse_json(std::string(60, '[') + std::string(60, ']')).has_value());
  CHECK_FALSE(parse_json(std::string(300'000, '[') + std::string(300'000, ']')).has_value());
  CHECK_FALSE(parse_json(R"({"a":)" + std::string(300'000, '[')).has_value());
  CHECK_FALSE(parse_json("{").has_value());
  CHECK(parse_json(R"({"a": {"a": 1}, "b": {"a": 1}})").has_value());
  CHECK_FALSE(parse_json(R"({"a": 1, "b": [{"a": 1, "a": 2}]})").has_value());
}
