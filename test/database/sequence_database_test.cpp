#include "database/sequence_database.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "database/archive.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

SequenceDatabase example() {
  SequenceDatabase database;
  database.descriptor.illumination_invariant = true;
  database.sequences = {{{"one", 3, {"1.png", "2.png", "3.png"}, {1}}},
                        {{"t/two", 2, {"#0", "#1"}}}};
  database.descriptors.append(random_codes(5, 1));
  database.thresholds = {{2, 0.9, {ClosestWindows{700, 1, 1, 0}, std::nullopt}}};
  for (TrainSequence& sequence : database.sequences) {
    sequence.typical_distance = 300.5;
    sequence.exclusion_radius = 2;
  }
  database.overlapping_sequences.emplace();
  database.statistics = {
      {3, 0.25, 77, 9}, 301.25, {-1.5F, 0, 2, 3.25F, 1e-3F}, {100, 0, 4096, 1, 2}};
  return database;
}

void write(const fs::path& path, const SequenceDatabase& database, Existing existing) {
  Outputs outputs(existing);
  write_sequence_database(path, database, outputs);
  outputs.commit();
}

fs::path write_example() {
  write("d.vprdb", example(), Existing::refuse);
  return "d.vprdb";
}

}  // namespace

TEST_CASE("a database can be read back after writing") {
  const SequenceDatabase database = read_sequence_database(write_example());
  CHECK(database.descriptor.illumination_invariant);
  REQUIRE(database.sequences.size() == 2);
  CHECK(database.sequences[0].sequence.unreadable == std::vector<size_t>{1});
  CHECK(database.sequences[1].sequence.name == "t/two");
  CHECK(database.sequences[1].sequence.frame_names == std::vector<std::string>{"#0", "#1"});
  const std::vector<LdbCode> codes = random_codes(5, 1);
  CHECK(std::ranges::equal(database.descriptors.rows().bytes, DescriptorRows(codes).bytes));
  CHECK(std::ranges::equal(database.descriptors.rows()[4], codes[4]));
  CHECK(database.descriptors.kind->name == "ldb");
  const ThresholdTable* table = find_thresholds(database.thresholds, 2);
  REQUIRE(table != nullptr);
  CHECK(table->safety_factor == 0.9);
  CHECK(table->closest[0]->score == 700);
  CHECK_FALSE(table->closest[1].has_value());
  CHECK(find_thresholds(database.thresholds, 3) == nullptr);
  CHECK(database.statistics == example().statistics);
}

TEST_CASE("any flipped bit is detected") {
  const fs::path path = write_example();
  RandomEngine engine(1);
  for (const char* name : {"manifest.json", "codes.npy", "frames.txt", "statistics.npy"}) {
    const std::string whole = read_text(path / name);
    for (int i = 0; i < 300; ++i) {
      std::string broken = whole;
      const size_t at = uniform_below(engine, whole.size());
      broken[at] = static_cast<char>(broken[at] ^ 1 << uniform_below(engine, 8));
      write_text(path / name, broken);
      INFO(name << " byte " << at);
      REQUIRE(error_kind([&] { read_sequence_database(path); }) == ErrorKind::data);
    }
    write_text(path / name, whole);
  }
  read_sequence_database(path);
}

TEST_CASE("a truncated or missing file is detected") {
  const fs::path path = write_example();
  for (const char* name : {"manifest.json", "codes.npy", "frames.txt", "statistics.npy"}) {
    INFO(name);
    const std::string whole = read_text(path / name);
    for (size_t size = 0; size < whole.size(); size += 7) {
      write_text(path / name, whole.substr(0, size));
      REQUIRE(error_kind([&] { read_sequence_database(path); }) == ErrorKind::data);
    }
    fs::remove(path / name);
    CHECK(error_kind([&] { read_sequence_database(path); }).has_value());
    write_text(path / name, whole);
  }
}

TEST_CASE("errors distinguish another version from a folder that is not a database") {
  const fs::path path = write_example();
  std::string text = read_text(path / "manifest.json");
  text.replace(text.find("vpr.database/3"), 14, "vpr.database/4");
  write_text(path / "manifest.json", text);
  CHECK(has(error_text([&] { read_sequence_database(path); }), "another version"));
  fs::create_directory("empty");
  CHECK(error_kind([&] { read_sequence_database("empty"); }) == ErrorKind::data);
  CHECK(error_kind([&] { read_sequence_database("none"); }) == ErrorKind::input);
}

TEST_CASE("a database without training results is damaged") {
  const auto kind = [&](auto change) {
    SequenceDatabase database = example();
    change(database);
    write("d.vprdb", database, Existing::replace);
    return error_kind([&] { read_sequence_database("d.vprdb"); });
  };
  using Database = SequenceDatabase;
  CHECK_FALSE(kind([](Database&) {}));
  CHECK(kind([](Database& d) { d.statistics.reset(); }) == ErrorKind::data);
  CHECK(kind([](Database& d) { d.overlapping_sequences.reset(); }) == ErrorKind::data);
  CHECK(kind([](Database& d) { d.sequences[1].exclusion_radius.reset(); }) == ErrorKind::data);
  CHECK(kind([](Database& d) { d.sequences[0].typical_distance.reset(); }) == ErrorKind::data);
}

TEST_CASE("features of keyframes are read back, and refused if invalid") {
  const auto stored = [&](auto change) {
    SequenceDatabase database = example();
    LocalFeature feature;
    feature.bits[31] = 7;
    feature.x = 2.5F;
    database.features.emplace();
    database.features->append(0, {});
    database.features->append(3, std::vector{feature, LocalFeature{}});
    change(*database.features);
    write("d.vprdb", database, Existing::replace);
    return read_sequence_database("d.vprdb");
  };
  const SequenceDatabase database = stored([](KeyframeFeatures&) {});
  REQUIRE(database.features);
  CHECK(database.features->frames == std::vector<uint32_t>{0, 3});
  CHECK(database.features->of(0).empty());
  REQUIRE(database.features->of(1).size() == 2);
  CHECK(database.features->of(1)[0].bits[31] == 7);
  CHECK(database.features->of(1)[0].x == 2.5F);
  const auto kind = [&](auto change) { return error_kind([&] { stored(change); }); };
  CHECK(kind([](KeyframeFeatures& f) { f.frames[1] = 5; }) == ErrorKind::data);
  CHECK(kind([](KeyframeFeatures& f) { f.frames[1] = 0; }) == ErrorKind::data);
  CHECK(kind([](KeyframeFeatures& f) { f.all[1].y = -1; }) == ErrorKind::data);
  CHECK(kind([](KeyframeFeatures& f) { f.all[1].y = std::nanf(""); }) == ErrorKind::data);
  CHECK(kind([](KeyframeFeatures& f) { f.all.emplace_back(); }) == ErrorKind::data);
}

TEST_CASE("invalid statistics are refused") {
  const auto kind = [&](auto change) {
    SequenceDatabase database = example();
    change(*database.statistics);
    write("d.vprdb", database, Existing::replace);
    return error_kind([&] { read_sequence_database("d.vprdb"); });
  };
  CHECK_FALSE(kind([](TrainStatistics&) {}));
  CHECK(kind([](TrainStatistics& s) { s.bias[1] = std::nanf(""); }) == ErrorKind::data);
  CHECK(kind([](TrainStatistics& s) { s.variance[1] = -1; }) == ErrorKind::data);
  CHECK(kind([](TrainStatistics& s) { s.variance[1] = INFINITY; }) == ErrorKind::data);
  CHECK(kind([](TrainStatistics& s) { s.typical_distance = -1; }) == ErrorKind::data);
}

TEST_CASE("exclusion radii and overlapping sequences are read back, and refused if invalid") {
  const auto stored = [&](size_t exclusion_radius, std::vector<std::pair<size_t, size_t>> shared) {
    SequenceDatabase database = example();
    database.sequences[0].exclusion_radius = exclusion_radius;
    database.overlapping_sequences = std::move(shared);
    write("d.vprdb", database, Existing::replace);
    return read_sequence_database("d.vprdb");
  };
  const size_t frames = example().sequences[0].sequence.frames;
  REQUIRE(example().sequences.size() == 2);
  const SequenceDatabase database = stored(1, {{0, 1}});
  CHECK(database.sequences[0].exclusion_radius == 1);
  CHECK(database.sequences[1].exclusion_radius == 2);
  CHECK(database.overlapping_sequences == std::vector<std::pair<size_t, size_t>>{{0, 1}});
  const auto kind = [&](size_t exclusion_radius, std::vector<std::pair<size_t, size_t>> shared) {
    return error_kind([&] { stored(exclusion_radius, std::move(shared)); });
  };
  CHECK(kind(0, {}) == ErrorKind::data);
  CHECK(kind(frames + 1, {}) == ErrorKind::data);
  CHECK(kind(1, {{0, 0}}) == ErrorKind::data);
  CHECK(kind(1, {{1, 0}}) == ErrorKind::data);
  CHECK(kind(1, {{0, 2}}) == ErrorKind::data);
  CHECK(kind(1, {{0, 1}, {0, 1}}) == ErrorKind::data);
}

TEST_CASE("repeated places are stored, and refused out of order") {
  const auto stored = [&](std::vector<RepeatedPlace> places) {
    SequenceDatabase database = example();
    database.repeated_places = std::move(places);
    write("d.vprdb", database, Existing::replace);
    return read_sequence_database("d.vprdb").repeated_places;
  };
  CHECK(stored({}) == std::vector<RepeatedPlace>{});
  CHECK(stored({{2, 0}, {3, 1}}) == std::vector<RepeatedPlace>{{2, 0}, {3, 1}});
  const auto kind = [&](std::vector<RepeatedPlace> places) {
    return error_kind([&] { stored(std::move(places)); });
  };
  CHECK(kind({{2, 2}}) == ErrorKind::data);
  CHECK(kind({{2, 0}, {2, 1}}) == ErrorKind::data);
  CHECK(kind({{100, 0}}) == ErrorKind::data);
}

TEST_CASE("the manifest names the descriptor of its frames") {
  const fs::path path = write_example();
  const auto rewrite = [&](auto change) {
    Json manifest = Json::parse(read_text(path / "manifest.json"));
    manifest.erase("checksum");
    change(manifest);
    write_text(path / "manifest.json", sealed_manifest(manifest));
  };
  CHECK(Json::parse(read_text(path / "manifest.json"))["descriptor"] == "ldb");
  rewrite([](Json& manifest) { manifest.erase("descriptor"); });
  CHECK(error_kind([&] { read_sequence_database(path); }) == ErrorKind::data);
  rewrite([](Json& manifest) { manifest["descriptor"] = "netvlad"; });
  CHECK(error_kind([&] { read_sequence_database(path); }) == ErrorKind::data);
  CHECK(error_text([&] { read_sequence_database(path); }) ==
        path.string() +
            ": its frames are described by netvlad, which this version does not support");
  rewrite([](Json& manifest) { manifest["descriptor"] = 7; });
  CHECK(error_kind([&] { read_sequence_database(path); }) == ErrorKind::data);
}

TEST_CASE("an unknown descriptor is refused with a list of the known ones") {
  CHECK(error_text([] { descriptor_kind("surf"); }) ==
        "unknown descriptor \"surf\"; choose one of ldb, thumbnail, hog, ldb+hog");
  CHECK(&descriptor_kind("ldb") == &descriptor_kinds().front());
  CHECK(find_descriptor_kind("") == nullptr);
}
