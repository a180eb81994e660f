// The commands of README and guide, exactly as printed, run and recognize places.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

struct Page {
  std::string commands;         ///< blocks ```sh and comments <!-- sh, in order
  Words commands_without_test;  ///< lines of other blocks that begin with one of our programs
};

Page read_page(const fs::path& path) {
  Page page;
  std::istringstream lines(read_text(path));
  enum { kText, kCommands, kComment, kOther } state = kText;
  for (std::string line; std::getline(lines, line);) {
    if (state == kText) {
      if (line == "```sh")
        state = kCommands;
      else if (line == "<!-- sh")
        state = kComment;
      else if (line.starts_with("```"))
        state = kOther;
    } else if (line == (state == kComment ? "-->" : "```")) {
      state = kText;
    } else if (state == kOther) {
      if (line.starts_with("vpr-")) page.commands_without_test.push_back(line);
    } else {
      page.commands += line + "\n";
    }
  }
  return page;
}

/// Gray values of a small image per frame: a row of float32 values with zero mean and unit length.
void write_descriptors(const fs::path& frames, const fs::path& path) {
  const cv::Size size(12, 9);
  std::vector<float> values;
  const Words names = list_folder(frames);
  size_t count = 0;
  for (const std::string& name : names) {
    if (!name.ends_with(".jpg") && !name.ends_with(".png")) continue;
    cv::Mat image = cv::imread(frames / name, cv::IMREAD_GRAYSCALE);
    cv::resize(image, image, size, 0, 0, cv::INTER_AREA);
    image.convertTo(image, CV_32F);
    image -= cv::mean(image);
    image /= cv::norm(image);
    values.insert(values.end(), image.begin<float>(), image.end<float>());
    ++count;
  }
  write_array<float>(path, values, {count, size_t(size.area())});
}

void write_video(const fs::path& frames, const fs::path& path) {
  cv::VideoWriter writer;
  for (const std::string& name : list_folder(frames)) {
    if (!name.ends_with(".jpg")) continue;
    const cv::Mat image = cv::imread(frames / name);
    if (!writer.isOpened())
      writer.open(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 8, image.size());
    writer.write(image);
  }
  REQUIRE(writer.isOpened());
}

/// The scalar products of the rows of two arrays.
void write_similarities(const fs::path& queries, const fs::path& train, const fs::path& path) {
  const auto rows = [](const fs::path& file) { return NpyArray(file).shape(); };
  const auto a = read_array<float>(queries), b = read_array<float>(train);
  const size_t n = rows(queries)[0], m = rows(train)[0], d = rows(train)[1];
  std::vector<float> products(n * m);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < m; ++j)
      for (size_t k = 0; k < d; ++k) products[i * m + j] += a[i * d + k] * b[j * d + k];
  write_array<float>(path, products, {n, m});
}

constexpr size_t kTuesdayFrames = 90;

/// The first frames of `from`, and their poses as a TUM trajectory.
void copy_walk(const fs::path& from, size_t frames, const fs::path& to) {
  fs::create_directory(to);
  std::ifstream poses(from / "poses.csv");
  std::ofstream tum(to.string() + ".tum");
  std::string line;
  std::getline(poses, line);
  size_t number = 0;
  for (const std::string& name : list_folder(from)) {
    if (!name.ends_with(".jpg") || number == frames) continue;
    fs::create_symlink(from / name, to / name);
    REQUIRE(std::getline(poses, line));
    std::istringstream fields(line);
    std::string frame, time, x, y;
    for (std::string* field : {&frame, &time, &x, &y}) std::getline(fields, *field, ',');
    tum << time << ' ' << x << ' ' << y << " 0 0 0 0 1\n";
    ++number;
  }
}

/// The recordings that the commands of every page may use.
class Recordings {
 public:
  Recordings() {
    const fs::path& root = folder_.path();
    run_ok("vpr-synth", {source_path("configs/worlds/small.json"), "-o", root / "building"});
    copy_walk(root / "building/corridor", SIZE_MAX, root / "monday");
    copy_walk(root / "building/upstairs", SIZE_MAX, root / "upstairs");
    copy_walk(root / "building/query", kTuesdayFrames, root / "tuesday");
    std::ifstream truth(root / "building/query.ground_truth.csv");
    std::ofstream pairs(root / "pairs.csv");
    pairs << "query,reference\n";
    for (std::string line; std::getline(truth, line);) {
      std::istringstream fields(line);
      std::string query, sequence, reference, label;
      for (std::string* field : {&query, &sequence, &reference, &label})
        std::getline(fields, *field, ',');
      if (sequence == "corridor" && label == "same" && std::stoul(query) < kTuesdayFrames)
        pairs << query << ',' << reference << '\n';
    }
    Json lap = Json::parse(read_text(source_path("configs/worlds/small.json")));
    lap.erase("places");
    lap["floors"] = Json::parse(
        R"([{"name": "hall", "rooms": [{"kind": "hall", "x": 0, "y": 0, "width": 10, "depth": 6}]}])");
    lap["walks"] =
        Json::parse(R"([{"name": "lap", "use": "train", "floor": "hall", "speed_m_s": 1.6,
        "path": [[1.5, 1.5], [8.5, 1.5], [8.5, 4.5], [1.5, 4.5], [1.5, 1.5], [8.5, 1.5], [8.5, 4.5]]}])");
    write_text(root / "lap.json", lap.dump());
    run_ok("vpr-synth", {root / "lap.json", "-o", root / "laps"});
    copy_walk(root / "laps/lap", SIZE_MAX, root / "lap");
    derive();
  }

  /// With two recordings and pairs of another place instead.
  Recordings(const fs::path& monday, const fs::path& tuesday, const fs::path& pairs) {
    fs::create_symlink(monday, folder_ / "monday");
    fs::create_symlink(tuesday, folder_ / "tuesday");
    fs::copy_file(pairs, folder_ / "pairs.csv");
    derive();
  }

  /// Links to all files in a new folder; runs the commands there. Returns their output.
  RunOutcome run(const std::string& commands) const {
    const TemporaryFolder folder;
    for (const std::string& name : list_folder(folder_.path()))
      fs::create_symlink(folder_ / name, folder / name);
    write_text(folder / "commands.sh",
               "set -euo pipefail\nPATH=" + program_path("vpr-query").parent_path().string() +
                   ":$PATH\n" + commands);
    const std::string in_folder = "cd '" + folder.path().string() + "' && bash commands.sh";
    const int status = std::system((in_folder + " >out 2>err </dev/null").c_str());
    return {status, read_text(folder / "out"), read_text(folder / "err")};
  }

 private:
  TemporaryFolder folder_;

  void derive() {
    for (const std::string& name : Words{"monday", "tuesday"})
      write_descriptors(folder_ / name, folder_ / (name + ".npy"));
    write_similarities(folder_ / "tuesday.npy", folder_ / "monday.npy", folder_ / "S.npy");
    write_video(folder_ / "tuesday", folder_ / "tuesday.avi");
  }
};

std::vector<fs::path> pages() {
  std::vector<fs::path> found = {source_path("README.md")};
  for (const std::string& name : list_folder(source_path("docs/guide")))
    if (name.ends_with(".md")) found.push_back(source_path("docs/guide/" + name));
  return found;
}

void check_recognized(const RunOutcome& outcome) {
  CHECK(has(outcome.out, " frames of tuesday:"));
  CHECK(has(outcome.out, "none of them incorrect"));
}

}  // namespace

TEST_CASE("the commands of README and guide run as printed") {
  const Recordings recordings;
  for (const fs::path& path : pages()) {
    const Page page = read_page(path);
    const RunOutcome outcome = recordings.run(page.commands);
    INFO(path << "\n" << page.commands << "\n" << outcome.out << "\n" << outcome.err);
    CHECK(outcome.exit_code == 0);
    if (path.filename() == "README.md") check_recognized(outcome);
    // Cameras are the only input that a test cannot have.
    for (const std::string& command : page.commands_without_test)
      CHECK_THAT(command, Catch::Contains("/dev/video"));
  }
}

TEST_CASE("the commands of README recognize a real corridor", "[real]") {
  const auto data = real_data("data/corridor");
  if (!data) return;
  const Recordings recordings(*data / "ref", *data / "query", *data / "ground_truth.csv");
  const RunOutcome outcome = recordings.run(read_page(source_path("README.md")).commands);
  INFO(outcome.out << "\n" << outcome.err);
  CHECK(outcome.exit_code == 0);
  check_recognized(outcome);
}
