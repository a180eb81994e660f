#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "recordings/frames.h"
#include "recordings/live_source.h"
#include "recordings/sequence.h"
#include "recordings/sequence_source.h"
#include "support.h"
#include "truth/frame_times.h"

using namespace vpr;

namespace {

/// Images with these names.
struct Recording {
  test::TemporaryFolder folder;

  explicit Recording(const std::vector<std::string>& names = {}) {
    for (const std::string& name : names) test::write_image(folder / name, 1);
  }
  SequenceArgument argument(const std::string& range = "") const {
    return parse_sequence_argument(folder.path().string() + range);
  }
  /// Other sources of times than the images.
  struct Times {
    std::filesystem::path file = {};
    std::optional<double> recorded_fps = {};
  };
  SequenceArgument rated(const Times& times, std::optional<double> fps,
                         const std::string& range = "") {
    return selected(argument(range), {"", fps, times.recorded_fps, {}}, times.file, 1, {});
  }
};

std::vector<std::string> names_of(const SequenceArgument& argument) {
  std::vector<std::string> names;
  for (const auto& file : open_sequence(argument).files) names.push_back(file.stem().string());
  return names;
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("names are times if they are clock readings") {
  for (const char* name : {"1305031102.175304.png", "0.04.png", "1403636579763555584.png",
                           "1305031102.png", "12.5.jpg"})
    CHECK(is_named_by_time(name));
  for (const char* name :
       {"7.png", "000012.png", "0000000123.png", "frame.12.png", ".5.png", "a.png", "1.2.3.png"})
    CHECK_FALSE(is_named_by_time(name));
}

TEST_CASE("a folder of images with times as names is resampled by time") {
  Recording seconds(
      {"1305031102.0.png", "1305031102.1.png", "1305031102.2.png", "1305031102.3.png"});
  CHECK(seconds.rated({}, {}).sequence.fps == Approx(10));
  CHECK(seconds.rated({}, {}).sequence.selection.is_all());
  const SequenceArgument slow = seconds.rated({}, 5);
  CHECK(names_of(slow) == Names{"1305031102.0", "1305031102.2"});
  CHECK(slow.sequence.fps == Approx(5));
  CHECK(names_of(seconds.rated({}, 5, "@1:")) == Names{"1305031102.1", "1305031102.3"});
  CHECK(seconds.rated({}, {}, "@::2").sequence.fps == Approx(5));
  Recording nanoseconds(
      {"1403636579763555584.png", "1403636579813555584.png", "1403636579863555584.png"});
  CHECK(nanoseconds.rated({}, {}).sequence.fps == Approx(20));
  CHECK(names_of(nanoseconds.rated({}, 10)) == Names{"1403636579763555584", "1403636579863555584"});
  // Its own rate or a higher one selects all frames.
  CHECK(seconds.rated({}, 10).sequence.selection.is_all());
  const SequenceArgument fast = seconds.rated({}, 30);
  CHECK(fast.sequence.selection.is_all());
  CHECK(fast.sequence.fps == Approx(10));
}

TEST_CASE("times from a list, or a constant rate, thin a folder") {
  Recording walk({"0.png", "1.png", "2.png", "3.png", "4.png", "5.png"});
  test::write_text(walk.folder / "times.txt", "0\n0.1\n0.2\n0.8\n0.9\n1\n");
  CHECK(names_of(walk.rated({walk.folder / "times.txt"}, 5)) == Names{"0", "2", "3", "5"});
  CHECK(names_of(walk.rated({{}, 10.0}, 5)) == Names{"0", "2", "4"});
  CHECK(names_of(walk.rated({{}, 30.0}, 10, "@1:")) == Names{"1", "4"});
  CHECK(walk.rated({{}, 30.0}, {}, "@::2").sequence.fps == Approx(15));
  // A list takes precedence over the stated rate.
  CHECK(walk.rated({walk.folder / "times.txt", 30.0}, {}).sequence.fps == Approx(10));
}

TEST_CASE("frames with unknown times, or times that do not increase, cannot be resampled") {
  Recording walk({"0.png", "1.png", "2.png"});
  CHECK_FALSE(walk.rated({}, {}).sequence.fps);
  CHECK(test::error_kind([&] { walk.rated({}, 5); }) == ErrorKind::usage);
  CHECK(test::has(test::error_text([&] { walk.rated({}, 5); }),
                  "the times of its frames are unknown"));
  test::write_text(walk.folder / "falling.txt", "0\n0.2\n0.1\n");
  CHECK(test::error_kind([&] { walk.rated({walk.folder / "falling.txt"}, 5); }) == ErrorKind::data);
  CHECK(test::has(test::error_text([&] { walk.rated({walk.folder / "falling.txt"}, 5); }),
                  "falling.txt, line 3"));
  test::write_text(walk.folder / "few.txt", "0\n0.2\n");
  CHECK(test::has(test::error_text([&] { walk.rated({walk.folder / "few.txt"}, 5); }),
                  "has 2 times"));
  // Decimal names are in the order of time.
  Recording decimal({"1.9.png", "1.11.png"});
  CHECK(decimal.rated({}, {}).sequence.fps);
  Recording one({"12.5.png"});
  CHECK_FALSE(one.rated({}, {}).sequence.fps);
  const SequenceArgument kept = one.rated({}, 5);
  CHECK(kept.sequence.selection.is_all());
  CHECK_FALSE(kept.sequence.fps);
}

TEST_CASE("a video is resampled by its own times, and frames keep their numbers") {
  Recording recording;
  const std::string path = recording.folder / "walk.avi";
  test::write_video(path, 64, 48, std::vector<int>(12, 90), 20);
  const auto names = [&](const std::string& range, std::optional<double> fps) {
    const SequenceArgument argument =
        selected(parse_sequence_argument(path + range), {"", fps, {}, {}}, {}, 1, Monitor());
    const Sequence frames =
        for_each_frame(open_sequence(argument), PixelFormat::gray, Unreadable::fail, Monitor(),
                       [](size_t, const cv::Mat&) {});
    if (fps) {
      REQUIRE_FALSE(frames.selection.is_all());
      CHECK(frames.selection.selected_fps == *fps);
      CHECK(frames.fps == Approx(*fps));
    }
    return frames.frame_names;
  };
  CHECK(names("", 5) == Names{"#0", "#4", "#8"});
  CHECK(names("@2:10", 5) == Names{"#2", "#6"});
  CHECK(names("@2:", 10) == Names{"#2", "#4", "#6", "#8", "#10"});
  CHECK(names("", {}).size() == 12);
  CHECK(selected({path, {}}, {}, {}, 1, {}).sequence.fps == Approx(20));
}

TEST_CASE("live frames are resampled like those of a complete recording") {
  Recording walk;
  Names images;
  int64_t time = 1'305'031'102'000;
  for (int i = 0; i < 40; ++i) {
    images.push_back(fmt::format("{}.{:03}.png", time / 1000, time % 1000));
    test::write_image(walk.folder / images.back(), 1);
    time += 20 + 37 * i % 90;
  }
  std::string list;
  for (const std::string& image : images) list += image + "\n";
  test::write_text(walk.folder / "list.txt", list);
  for (const double fps : {1.0, 4.0, 9.5, 12.0}) {
    auto source = open_resampled_source(
        open_live_source({walk.folder / "list.txt", {}}, Unreadable::fail), fps, {});
    Names came;
    while (const auto frame = source.next({})) came.push_back(frame->file.stem().string());
    CHECK(came == names_of(walk.rated({}, fps)));
  }
  Recording named({"a.png", "b.png"});
  test::write_text(named.folder / "list.txt", "a.png\nb.png\n");
  const auto open = [&](std::optional<double> recorded_fps) {
    return open_resampled_source(
        open_live_source({named.folder / "list.txt", {}}, Unreadable::fail), 5, recorded_fps);
  };
  CHECK(test::error_kind([&] { open({}).next({}); }) == ErrorKind::usage);
  CHECK(open(10).next({})->name == "a.png");
}

TEST_CASE(
    "times of a phone's clock, in nanoseconds since its start, give the rate of live frames") {
  Names images;
  for (int64_t i = 0; i < 9; ++i)
    images.push_back(fmt::format("{}.png", 170'000'000'000'000 + i * 125'000'000));
  Recording walk(images);
  std::string list;
  for (const std::string& image : images) list += image + "\n";
  test::write_text(walk.folder / "list.txt", list);
  auto source = open_resampled_source(
      open_live_source({walk.folder / "list.txt", {}}, Unreadable::fail), 2, {});
  size_t count = 0;
  while (source.next({})) ++count;
  CHECK(count == names_of(walk.rated({}, 2)).size());
  CHECK(count == 3);
}
