// The library for C++: arrays, images and live frames, files, evaluations and errors.
#include "vpr/vpr.h"

#include <cstdint>
#include <random>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace {

constexpr size_t kFrames = 60;
constexpr size_t kColumns = 32;

float noise(std::mt19937& engine) { return static_cast<float>(engine() % 2001) / 1000 - 1; }

/// Two recordings of the same frames.
struct Walks {
  std::vector<float> monday;
  std::vector<float> tuesday;

  Walks() {
    std::mt19937 engine(1);
    for (size_t i = 0; i < kFrames * kColumns; ++i) monday.push_back(noise(engine));
    for (const float value : monday) tuesday.push_back(value + noise(engine) / 4);
  }
};

vpr::Descriptors rows_of(const std::vector<float>& values, size_t first = 0,
                         size_t count = kFrames) {
  return {values.data() + first * kColumns, count, kColumns, vpr::Descriptors::Type::float32};
}

/// A wall of gray texture, of which each frame shows a part.
std::vector<uint8_t> frame_of_wall(size_t left, size_t channels) {
  constexpr size_t kWidth = 96;
  std::vector<uint8_t> pixels;
  for (size_t y = 0; y < 64; ++y)
    for (size_t x = left; x < left + kWidth; ++x)
      pixels.insert(
          pixels.end(), channels,
          static_cast<uint8_t>(std::mt19937(static_cast<uint32_t>(y / 4 * 1000 + x / 4))()));
  return pixels;
}

bool equal(const vpr::Match& a, const vpr::Match& b) {
  return a.query == b.query && a.sequence == b.sequence && a.frame == b.frame &&
         a.score == b.score && a.margin == b.margin;
}

bool equal(const std::optional<vpr::Match>& a, const std::optional<vpr::Match>& b) {
  return a ? b && equal(*a, *b) : !b;
}

bool equal(const std::vector<vpr::Match>& a, const std::vector<vpr::Match>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return equal(x, y); });
}

bool equal(const vpr::Result& a, const vpr::Result& b) {
  return std::equal(a.best().begin(), a.best().end(), b.best().begin(), b.best().end(),
                    [](const auto& x, const auto& y) { return equal(x, y); }) &&
         equal(a.recognitions(), b.recognitions());
}

/// Requires an error of this kind, whose message has these words.
template <class Work>
void check_refused(Work&& work, vpr::ErrorKind kind, const std::string& words) {
  try {
    work();
    FAIL_CHECK("no error with " << words);
  } catch (const vpr::Error& error) {
    CHECK(error.kind() == kind);
    CHECK_THAT(error.what(), Catch::Contains(words));
  }
}

}  // namespace

TEST_CASE("a match has the last frames of its windows") {
  const Walks walks;
  const vpr::Database database = vpr::train({rows_of(walks.monday)}, {{"c_l", 5}});
  CHECK(database.sequences() == std::vector<std::string>{"train"});
  const vpr::Result result =
      vpr::query(database, rows_of(walks.tuesday), {{"c_l", 5}, {"t_r", 0.3}});
  REQUIRE(result.best().size() == kFrames);
  for (size_t frame = 0; frame < kFrames; ++frame) {
    REQUIRE(result.best()[frame].has_value() == (frame >= 4));
    if (frame < 4) continue;
    CHECK(result.best()[frame]->query == frame);
    CHECK(result.best()[frame]->frame == frame);
    CHECK(result.best()[frame]->sequence == "train");
  }
  REQUIRE(!result.recognitions().empty());
  CHECK(equal(result.recognitions()[0], *result.best()[result.recognitions()[0].query]));
}

TEST_CASE("files have the content of memory") {
  const Walks walks;
  const vpr::Database database = vpr::train({{rows_of(walks.monday), "monday"}});
  database.save("monday.vprdb");
  const vpr::Settings by_margin{{"c_l", 5}, {"score", "zscore"}, {"decide", "margin"}};
  const vpr::Result result = vpr::query(database, {rows_of(walks.tuesday), "tuesday"}, by_margin);
  const vpr::Database loaded = vpr::load_database("monday.vprdb");
  CHECK(loaded.sequences() == std::vector<std::string>{"monday"});
  CHECK(equal(vpr::query(loaded, {rows_of(walks.tuesday), "tuesday"}, by_margin), result));
  result.save("r.json");
  const vpr::Result read = vpr::load_result("r.json");
  CHECK(equal(read, result));
  CHECK(vpr::evaluate(read, "aligned").summary == vpr::evaluate(result, "aligned").summary);
  check_refused([&] { result.save("r.json"); }, vpr::ErrorKind::usage, "r.json");
  result.save("r.json", true);
  check_refused([&] { read.save("s.json"); }, vpr::ErrorKind::usage, "read from a file");
  check_refused([&] { database.save("monday.vprdb"); }, vpr::ErrorKind::usage, "monday.vprdb");
}

TEST_CASE("a database of bits has a copy of its array") {
  std::mt19937 engine(2);
  std::vector<uint8_t> codes(kFrames * 8);
  for (uint8_t& code : codes) code = static_cast<uint8_t>(engine());
  const std::vector<uint8_t> query = codes;
  std::string warning;
  vpr::Monitor monitor;
  monitor.warn = [&](const std::string& sentence) { warning = sentence; };
  const vpr::Database database = vpr::train(
      {vpr::Descriptors{codes.data(), kFrames, 8, vpr::Descriptors::Type::uint8}}, {}, monitor);
  CHECK_THAT(warning, Catch::Contains("compared as bits"));
  std::fill(codes.begin(), codes.end(), uint8_t{0});
  const vpr::Result result = vpr::query(
      database, vpr::Descriptors{query.data(), kFrames, 8, vpr::Descriptors::Type::uint8},
      {{"c_l", 1}, {"t_r", 0.1}});
  for (size_t frame = 0; frame < kFrames; ++frame) {
    CHECK(result.best()[frame]->frame == frame);
    CHECK(result.best()[frame]->score == 0);
  }
}

TEST_CASE("live frames have the matches of the whole query") {
  const Walks walks;
  const vpr::Database database = vpr::train({rows_of(walks.monday)});
  const std::vector<vpr::Settings> all = {{},
                                          {{"c_l", 5}, {"score", "zscore"}, {"decide", "margin"}},
                                          {{"c_l", 3}, {"score", "zscore"}, {"t_r", -3}}};
  for (const vpr::Settings& settings : all) {
    const vpr::Result result = vpr::query(database, rows_of(walks.tuesday), settings);
    vpr::Live live(database, settings);
    std::vector<vpr::Match> recognized;
    for (size_t frame = 0; frame < kFrames; ++frame) {
      const auto answer = live.add(rows_of(walks.tuesday, frame, 1));
      CHECK(answer.frame == frame);
      if (!settings.empty()) CHECK(equal(answer.best, result.best()[frame]));
      if (settings.empty()) CHECK(answer.best->frame == result.best()[frame]->frame);
      recognized.insert(recognized.end(), answer.recognized.begin(), answer.recognized.end());
    }
    const auto last = live.finish();
    recognized.insert(recognized.end(), last.begin(), last.end());
    REQUIRE(recognized.size() == result.recognitions().size());
    CHECK(recognized.size() > 20);
    if (!settings.empty()) CHECK(equal(recognized, result.recognitions()));
    for (size_t i = 0; i < recognized.size(); ++i) {
      CHECK(recognized[i].query == result.recognitions()[i].query);
      CHECK(recognized[i].frame == result.recognitions()[i].frame);
      CHECK(recognized[i].score == result.recognitions()[i].score);
    }
    check_refused([&] { live.add_missing(); }, vpr::ErrorKind::usage, "is finished");
  }
}

TEST_CASE("a live frame is a file, or pixels with or without gaps between rows") {
  std::vector<std::string> names;
  for (size_t i = 0; i < 12; ++i) {
    std::vector<uint8_t> pixels = frame_of_wall(8 * i, 1);
    names.push_back("walk/" + std::to_string(10 + i) + ".png");
    std::filesystem::create_directory("walk");
    cv::imwrite(names.back(), cv::Mat(64, 96, CV_8UC1, pixels.data()));
  }
  const vpr::Database database = vpr::train({"walk"}, {{"descriptor", "ldb"}});
  const vpr::Settings settings{{"c_l", 2}, {"t_r", 1}, {"t_r_scale", "bits"}};
  vpr::Live files(database, settings);
  vpr::Live gray(database, settings);
  vpr::Live color(database, settings);
  for (size_t i = 0; i < 6; ++i) {
    const std::vector<uint8_t> pixels = frame_of_wall(8 * i, 1);
    std::vector<uint8_t> wide(64 * 100);
    for (size_t y = 0; y < 64; ++y)
      std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(96 * y), 96,
                  wide.begin() + static_cast<std::ptrdiff_t>(100 * y));
    const auto answer = files.add(names[i]);
    CHECK(answer.best.has_value() == (i > 0));
    CHECK(answer.recognized.size() == (i > 0 ? 1 : 0));
    if (answer.best) CHECK(answer.best->frame == i);
    CHECK(equal(gray.add(vpr::Image{wide.data(), 96, 64, 1, 100}).best, answer.best));
    CHECK(
        equal(color.add(vpr::Image{frame_of_wall(8 * i, 3).data(), 96, 64, 3}).best, answer.best));
  }
  CHECK(!files.add_missing().best);
  CHECK(!files.add(names[6]).best);
  CHECK(files.add(names[7]).best->frame == 7);
  check_refused([&] { files.add(vpr::Image{nullptr, 96, 64}); }, vpr::ErrorKind::usage, "an image");
  const std::vector<uint8_t> pixels = frame_of_wall(0, 1);
  check_refused(
      [&] {
        files.add(vpr::Image{pixels.data(), 96, 64, 1, 95});
      },
      vpr::ErrorKind::usage, "stride");
  check_refused([&] { files.add("walk/missing.png"); }, vpr::ErrorKind::input, "missing.png");
  check_refused([&] { files.add(rows_of(Walks().monday, 0, 1)); }, vpr::ErrorKind::data, "");
}

TEST_CASE("a result is judged by pairs, by their file, or by a name") {
  const Walks walks;
  const vpr::Database database = vpr::train({rows_of(walks.monday)});
  const vpr::Result result =
      vpr::query(database, rows_of(walks.tuesday), {{"c_l", 1}, {"t_r", 0.5}});
  std::vector<vpr::Pair> pairs;
  for (size_t i = 0; i < 40; ++i) pairs.push_back({i, i < 30 ? i : i - 10, i < 5 ? "train" : ""});
  const vpr::Evaluation evaluation = vpr::evaluate(result, pairs);
  CHECK(evaluation.frames == 60);
  CHECK(evaluation.frames_with_match == 40);
  CHECK(evaluation.recognized == 60);
  CHECK(evaluation.correct == 30);
  CHECK(evaluation.incorrect == 30);
  CHECK(evaluation.recall_at_1 == 0.75);
  CHECK(evaluation.average_precision.has_value());
  CHECK_THAT(evaluation.summary,
             Catch::Contains("40 of 40 frames with a match recognized, 10 of them incorrectly"));
  std::FILE* file = std::fopen("pairs.csv", "w");
  REQUIRE(file != nullptr);
  std::fputs("query,reference\n", file);
  for (const vpr::Pair& pair : pairs)
    std::fputs(fmt::format("{},{}\n", pair.query, pair.frame).c_str(), file);
  std::fclose(file);
  const vpr::Evaluation by_file = vpr::evaluate(result, "pairs.csv");
  CHECK(by_file.summary == evaluation.summary);
  CHECK(by_file.recall_at_full_precision == evaluation.recall_at_full_precision);
  const auto before_run = [](const std::string& report) {
    return report.substr(0, report.find("\"machine\""));
  };
  CHECK(before_run(by_file.report) == before_run(evaluation.report));
  CHECK(vpr::evaluate(result, pairs, {{"tolerance", 10}}).correct == 40);
  CHECK(vpr::evaluate(result, "aligned").correct == 60);
  check_refused(
      [&] {
        vpr::evaluate(result, std::vector<vpr::Pair>{{60, 0}});
      },
      vpr::ErrorKind::data, "pairs, pair 0: query 60 is out of range");
  check_refused([&] { vpr::evaluate(result, "alignd"); }, vpr::ErrorKind::usage, "aligned");
  check_refused([&] { vpr::evaluate(result, ""); }, vpr::ErrorKind::usage, "is empty");
}

TEST_CASE("settings have the checks of the programs") {
  const Walks walks;
  const vpr::Database database = vpr::train({rows_of(walks.monday)});
  const auto refused = [&](const vpr::Settings& settings, const std::string& words) {
    check_refused([&] { vpr::query(database, rows_of(walks.tuesday), settings); },
                  vpr::ErrorKind::usage, words);
  };
  refused({{"c_1", 5}}, "vpr::query");
  refused({{"c_1", 5}}, "c_l");
  refused({{"thread", 1}}, "threads");
  refused({{"c_l", 0}}, "1");
  refused({{"c_l", 2.5}}, "integer");
  refused({{"c_l", true}}, "integer");
  refused({{"score", "zscores"}}, "zscore");
  refused({{"clustering.ep", 3}}, "eps");
  refused({{"clustering.eps", -1}, {"c_l", 5}}, "eps");
  refused({{"t_r", std::numeric_limits<double>::quiet_NaN()}}, "t_r is not a finite number");
  refused({{"method", ""}}, "method is empty");
  refused({{"method", "filter"}, {"c_l", 5}}, "c");
  const size_t length = 5;
  const vpr::Result result = vpr::query(database, rows_of(walks.tuesday),
                                        {{"c_l", length},
                                         {"t_r", 0.5},
                                         {"clustering.eps", 3},
                                         {"only_sequence", std::vector<std::string>{"train"}},
                                         {"threads", 1}});
  CHECK(result.best()[length - 1]->frame == length - 1);
  CHECK_THAT(vpr::evaluate(result, "aligned", {{"recall_at", std::vector<int64_t>{1, 3}}}).report,
             Catch::Contains("recall_at"));
}

TEST_CASE("wrong inputs are errors of their kind") {
  const Walks walks;
  check_refused([] { vpr::train({"missing"}); }, vpr::ErrorKind::input, "missing");
  check_refused([] { vpr::train({}); }, vpr::ErrorKind::usage, "no sequences");
  check_refused([] { vpr::load_database("missing"); }, vpr::ErrorKind::input, "missing");
  check_refused([] { vpr::load_result("missing.json"); }, vpr::ErrorKind::input, "missing.json");
  check_refused(
      [] {
        vpr::train({vpr::Descriptors{nullptr, 3, 4}});
      },
      vpr::ErrorKind::usage, "train: has no values");
  check_refused([&] { vpr::train({rows_of(walks.monday, 0, 0)}); }, vpr::ErrorKind::data, "train");
  check_refused([] { vpr::query({}, "walk"); }, vpr::ErrorKind::usage, "the database is empty");
  check_refused([] { vpr::Result().best(); }, vpr::ErrorKind::usage, "the result is empty");
  const vpr::Database database = vpr::train({rows_of(walks.monday)});
  check_refused(
      [&] {
        vpr::query(database, rows_of(walks.tuesday), {{"descriptor", "ldb"}});
      },
      vpr::ErrorKind::usage, "descriptor");
  vpr::Live live(database);
  check_refused([&] { live.add(rows_of(walks.tuesday)); }, vpr::ErrorKind::usage, "found 60");
}

TEST_CASE("work reports its progress, and stops") {
  const Walks walks;
  std::atomic<size_t> reports = 0;
  std::atomic<bool> stop = false;
  const vpr::Monitor monitor{[&](const std::string&, size_t, size_t) { ++reports; }, {}, &stop};
  vpr::train({rows_of(walks.monday)}, {}, monitor);
  CHECK(reports > 0);
  stop = true;
  check_refused([&] { vpr::train({rows_of(walks.monday)}, {}, monitor); },
                vpr::ErrorKind::interrupted, "");
}
