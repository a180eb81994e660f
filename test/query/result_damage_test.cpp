// Invalid files are refused by a robust reader.
#include <cmath>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"
#include "npz.h"
#include "query/result_examples.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

TEST_CASE("a modified result of places is refused") {
  for (const auto& change : std::vector<void (*)(Result&)>{
           [](Result& r) { r.places->names.pop_back(); }, [](Result& r) { r.places->views = 2; },
           [](Result& r) { r.sequences.push_back(r.sequences[0]); },
           [](Result& r) { r.places->new_place.pop_back(); }, [](Result& r) { r.best.pop_back(); },
           [](Result& r) { r.query_windows = 4; }, [](Result& r) { r.recognitions[1].train = 2; },
           [](Result& r) { r.recognitions[1] = r.recognitions[0]; },
           [](Result& r) { r.recognitions[2].score = std::nan(""); }}) {
    Result result = places_example();
    change(result);
    write("r.json", result, Existing::replace);
    CHECK(test::error_kind([&] { read_result("r.json"); }) == ErrorKind::data);
  }
}

TEST_CASE("arrays of another run are refused") {
  const test::TemporaryFolder other;
  const fs::path path = write_example();
  Result changed = example_result();
  changed.recognitions.pop_back();
  write(other / "r.json", changed, Existing::refuse);
  fs::copy_file(other / "r.npz", "r.npz", fs::copy_options::overwrite_existing);
  CHECK(has(test::error_text([&] { read_result(path); }), "belongs to another run"));
  fs::remove("r.npz");
  CHECK(test::error_kind([&] { read_result(path); }) == ErrorKind::input);
}

TEST_CASE("damage in any array of a result is detected") {
  for (const Result& result : {example_result(), places_example()}) {
    write("r.json", result, Existing::replace);
    const std::string whole = read_text("r.npz");
    const std::vector<std::string> names = ZipFile("r.npz").names();
    for (const std::string& name : names) {
      INFO(name);
      const std::string array = npz_bytes("r.npz", name.substr(0, name.size() - 4));
      const size_t last = whole.find(array) + array.size() - 1;
      for (const size_t at : {last, last - array.size() / 2, last - array.size() + 1}) {
        std::string text = whole;
        text[at] = static_cast<char>(text[at] ^ 1);
        write_text("r.npz", text);
        CHECK(error_kind([] { read_result("r.json"); }) == ErrorKind::data);
      }
      // Without the array, by another name in its header and in the directory.
      std::string renamed = whole;
      for (size_t at = 0; (at = renamed.find(name, at)) != std::string::npos;) renamed[at] = 'x';
      write_text("r.npz", renamed);
      CHECK(error_kind([] { read_result("r.json"); }) == ErrorKind::data);
      write_text("r.npz", whole);
    }
    for (const size_t size : {size_t{0}, whole.size() / 2, whole.size() - 1}) {
      write_text("r.npz", whole.substr(0, size));
      CHECK(error_kind([] { read_result("r.json"); }) == ErrorKind::data);
    }
    write_text("r.npz", whole);
    read_result("r.json");
  }
}

TEST_CASE("a file of another run next to a result is refused, and may be removed") {
  const fs::path path = "r.json";
  {
    Outputs outputs(Existing::refuse);
    outputs.file("m.png").write("image");
    outputs.file("m.npy").write("matrix");
    write_result(path, example_result(), {}, outputs);
    outputs.commit();
  }
  read_result(path);
  for (const char* name : {"m.png", "m.npy"}) {
    test::write_text(name, "of another run");
    CHECK(test::error_text([&] { read_result(path); }) ==
          fmt::format("{}: belongs to another run than {}; run vpr-query again, with --force, or "
                      "remove this file",
                      name, path.string()));
    fs::remove(name);
  }
  read_result(path);
}

TEST_CASE("modified results are refused without a crash") {
  const fs::path path = write_example();
  const Json whole = Json::parse(test::read_text(path));
  const auto broken = [&](const std::string& pointer, const Json& value) {
    Json json = whole;
    json[Json::json_pointer(pointer)] = value;
    json.erase("checksum");
    json["checksum"] = result_checksum(json);
    test::write_text(path, json.dump());
    return test::error_kind([&] { read_result(path); });
  };
  for (const auto& [pointer, value] :
       std::vector<std::pair<std::string, Json>>{{"/settings/c_l", 0},
                                                 {"/settings/c_l", 3},
                                                 {"/settings/t_r", -1},
                                                 {"/sequences/0/searched", false},
                                                 {"/settings/method", "fastabel"},
                                                 {"/query/windows", 5},
                                                 {"/query/frames", -1},
                                                 {"/query/frames", 1e30},
                                                 {"/sequences/0/frames", 2},
                                                 {"/sequences/0/windows", 6},
                                                 {"/sequences", 3},
                                                 {"/clusters/0/sequence", 2},
                                                 {"/clusters/0/train/last", 5},
                                                 {"/clusters/0/query/window", 4},
                                                 {"/files/recognitions/checksum", "xxh3:0"},
                                                 {"/files", Json::array()},
                                                 {"/files/best/rows", 3},
                                                 {"/files/best/rows", uint64_t{1} << 62},
                                                 {"/settings/clustering/eps", 5000},
                                                 {"/settings/clustering/eps", 0},
                                                 {"/clusters", Json::array()},
                                                 {"/clusters/0/recognitions", 3},
                                                 {"/schema", "vpr.result/2"},
                                                 {"/query", Json()}}) {
    INFO(pointer);
    CHECK(broken(pointer, value) == ErrorKind::data);
  }
}

TEST_CASE("a result of z-scores whose windows are too long for them is refused") {
  Result result = example_result();
  result.settings = SequenceQuerySettings{Margin{{.window_length = 2, .score = Score::zscore}}};
  Json json = write("r.json", result, Existing::replace);
  json["settings"]["c_l"] = 65537;
  json.erase("checksum");
  json["checksum"] = result_checksum(json);
  test::write_text("r.json", json.dump());
  CHECK(has(error_text([] { read_result("r.json"); }), "c_l must be at most 65536"));
}

TEST_CASE("a result with modified text is refused, except in machine and timing") {
  const fs::path path = write_example();
  Json json = Json::parse(test::read_text(path));
  json["machine"]["threads"] = 99;
  test::write_text(path, to_text(json));
  read_result(path);
  json["clusters"] = Json::array();
  test::write_text(path, to_text(json));
  CHECK(has(test::error_text([&] { read_result(path); }), "checksum"));
}

TEST_CASE("random damage yields an error or a result, never a crash") {
  const fs::path path = write_example();
  RandomEngine engine(1);
  for (const char* name : {"r.json", "r.npz"}) {
    const std::string whole = test::read_text(name);
    for (int i = 0; i < 300; ++i) {
      std::string text = whole.substr(0, 1 + uniform_below(engine, whole.size()));
      text[uniform_below(engine, text.size())] = static_cast<char>(engine());
      test::write_text(name, text);
      test::error_kind([&] { read_result(path); });
    }
    test::write_text(name, whole);
  }
  CHECK(read_result(path).result.recognitions == example_result().recognitions);
}

TEST_CASE("an existing result is refused as a whole") {
  write_example();
  fs::remove("r.json");
  Outputs outputs(Existing::refuse);
  CHECK(test::error_kind([&] { claim_result("r.json", outputs); }) == ErrorKind::usage);
  write_example(Existing::replace);
}
