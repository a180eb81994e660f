#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/mapped_file.h"
#include "bench/benches.h"
#include "bench/generated.h"
#include "database/frame_descriptors.h"
#include "database/whole_frame.h"
#include "recordings/frames.h"

namespace vpr {
namespace {

/// Encoded files and decoded frames.
struct Frames {
  std::vector<std::vector<uint8_t>> files;
  std::vector<cv::Mat> gray;
};

Frames load_frames(const std::optional<SequenceSource>& images, uint64_t count, uint64_t seed) {
  Frames frames;
  if (images && images->files.empty())
    throw Error(ErrorKind::usage, "{}: is a video; use a folder or list of images",
                images->argument.path.string());
  for (uint64_t i = 0; i < count; ++i) {
    if (images) {
      if (i == images->files.size()) break;
      frames.gray.push_back(decode_image(images->files[i], PixelFormat::gray));
      const std::string bytes = read_whole_file(images->files[i]);
      frames.files.emplace_back(bytes.begin(), bytes.end());
    } else {
      cv::imencode(".jpg", generate_frame(seed + i), frames.files.emplace_back());
      frames.gray.push_back(cv::imdecode(frames.files.back(), cv::IMREAD_GRAYSCALE));
    }
  }
  return frames;
}

// Times training with all threads: decoding alone, and decoding with describing.
void add_whole_sequence(BenchResult& result, const SequenceSource& images, const Effort& effort,
                        const Monitor& monitor) {
  const size_t files = images.files.size();
  const auto add = [&](const std::string& work, const std::function<void()>& run) {
    result.rows.push_back({work,
                           {{"files", files}},
                           "frame",
                           time_repeatedly(effort, run, monitor, static_cast<double>(files))});
  };
  add("decode all", [&] {
    for_each_frame(images, PixelFormat::gray, Unreadable::fail, {}, [](size_t, const cv::Mat&) {});
  });
  add("decode and describe all",
      [&] { descriptor_kinds().front().describe(images, {}, Unreadable::fail, {}); });
}

}  // namespace

BenchResult bench_describe(const DescribeBenchSettings& settings,
                           const std::optional<SequenceSource>& images, uint64_t seed,
                           const Monitor& monitor) {
  check_values("frames", {settings.frames}, 1, 10'000);
  check_seconds(settings.seconds);
  check_feature_settings(settings.feature_settings);
  std::vector<FeatureKind> kinds;
  for (const std::string& name : settings.feature_kinds)
    value_from_json(Json(name), kinds.emplace_back(), "feature_kinds", "feature_kinds");
  BenchResult result{"describe", value_to_json(settings)};
  const Frames frames = load_frames(images, settings.frames, seed);
  size_t next = 0;
  StepCounter counter(monitor, "measure", 5 + kinds.size());
  const auto add = [&](const std::string& work, auto&& run) {
    const auto run_next = [&] {
      run(next);
      next = (next + 1) % frames.gray.size();
    };
    BenchRow& row = result.rows.emplace_back(
        BenchRow{work,
                 {{"width", frames.gray[0].cols}, {"height", frames.gray[0].rows}},
                 "frame",
                 time_repeatedly({settings.seconds}, run_next, monitor)});
    row.values.emplace_back("fps", 1000 / row.time.median_ms);
    counter.add();
  };
  add("decode", [&](size_t i) { cv::imdecode(frames.files[i], cv::IMREAD_GRAYSCALE); });
  add("resize", [&](size_t i) {
    cv::Mat small;
    cv::resize(frames.gray[i], small, {64, 64}, 0, 0, cv::INTER_LINEAR_EXACT);
  });
  add("ldb", [&](size_t i) { describe_ldb(frames.gray[i]); });
  add("thumbnail", [&](size_t i) { describe_thumbnail(frames.gray[i]); });
  add("hog", [&](size_t i) { describe_hog(frames.gray[i]); });
  for (const FeatureKind kind : kinds) {
    FeatureSettings feature = settings.feature_settings;
    feature.kind = kind;
    int found = 0;
    for (const cv::Mat& frame : frames.gray) found += find_features(frame, feature).rows;
    add(std::string(enum_name(kind)), [&](size_t i) { find_features(frames.gray[i], feature); });
    result.rows.back().values.emplace_back(
        "features", static_cast<double>(found) / static_cast<double>(frames.gray.size()));
  }
  if (images) add_whole_sequence(result, *images, {settings.seconds}, monitor);
  return result;
}

}  // namespace vpr
