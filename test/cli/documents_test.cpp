// The commands of README and guide, exactly as printed, run and recognize places.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/text.h"
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

std::string_view without_blanks(std::string_view cell) {
  cell.remove_prefix(std::min(cell.find_first_not_of(' '), cell.size()));
  return cell.substr(0, cell.find_last_not_of(' ') + 1);
}

constexpr size_t kTuesdayFrames = 90;

std::vector<fs::path> frames_of(const fs::path& folder) {
  std::vector<fs::path> frames;
  for (const std::string& name : list_folder(folder))
    if (name.ends_with(".jpg")) frames.push_back(folder / name);
  return frames;
}

/// Links to the first frames of `from`, and their poses as a TUM trajectory.
void link_walk(const fs::path& from, size_t most, const fs::path& to) {
  fs::create_directory(to);
  std::ifstream poses(from / "poses.csv");
  std::ofstream tum(to.string() + ".tum");
  std::string line;
  std::getline(poses, line);
  for (const fs::path& frame : frames_of(from)) {
    if (most-- == 0) break;
    fs::create_symlink(frame, to / frame.filename());
    REQUIRE(std::getline(poses, line));
    const auto fields = split(line, ',');  // frame, time, x, y, ...
    tum << fields[1] << ' ' << fields[2] << ' ' << fields[3] << " 0 0 0 0 1\n";
  }
}

/// A row per frame: gray values of a small image, float32, with zero mean and unit length.
cv::Mat descriptors_of(const fs::path& folder) {
  cv::Mat rows;
  for (const fs::path& frame : frames_of(folder)) {
    cv::Mat image;
    cv::resize(cv::imread(frame, cv::IMREAD_GRAYSCALE), image, {12, 9}, 0, 0, cv::INTER_AREA);
    image.convertTo(image, CV_32F);
    image -= cv::mean(image);
    rows.push_back(cv::Mat(image / cv::norm(image)).reshape(1, 1));
  }
  return rows;
}

void write_matrix(const fs::path& path, const cv::Mat& values) {
  write_array<float>(path, {values.begin<float>(), values.end<float>()},
                     {size_t(values.rows), size_t(values.cols)});
}

void write_video(const fs::path& folder, const fs::path& path) {
  cv::VideoWriter writer;
  for (const fs::path& frame : frames_of(folder)) {
    const cv::Mat image = cv::imread(frame);
    if (!writer.isOpened())
      writer.open(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 8, image.size());
    writer.write(image);
  }
  REQUIRE(writer.isOpened());
}

/// The recordings that the commands of every page may use.
class Recordings {
 public:
  Recordings() {
    const fs::path& root = folder_.path();
    const std::string small = source_path("configs/worlds/small.json");
    const std::string at = root.string() + "/";
    run_ok("vpr-synth " + small + " -o " + at + "building");
    link_walk(root / "building/corridor", SIZE_MAX, root / "monday");
    link_walk(root / "building/upstairs", SIZE_MAX, root / "upstairs");
    link_walk(root / "building/query", kTuesdayFrames, root / "tuesday");
    std::ifstream truth(root / "building/query.ground_truth.csv");
    std::ofstream pairs(root / "pairs.csv");
    pairs << "query,reference\n";
    for (std::string line; std::getline(truth, line);) {
      const auto fields = split(line, ',');  // query, sequence, reference, label
      if (fields[1] == "corridor" && fields[3] == "same" &&
          std::stoul(std::string(fields[0])) < kTuesdayFrames)
        pairs << fields[0] << ',' << fields[2] << '\n';
    }
    Json lap = Json::parse(read_text(small));
    lap.erase("places");
    lap["floors"] = Json::parse(
        R"([{"name": "hall", "rooms": [{"kind": "hall", "x": 0, "y": 0, "width": 10, "depth": 6}]}])");
    lap["walks"] =
        Json::parse(R"([{"name": "lap", "use": "train", "floor": "hall", "speed_m_s": 1.6,
        "path": [[1.5, 1.5], [8.5, 1.5], [8.5, 4.5], [1.5, 4.5], [1.5, 1.5], [8.5, 1.5], [8.5, 4.5]]}])");
    write_text(root / "lap.json", lap.dump());
    run_ok("vpr-synth " + at + "lap.json -o " + at + "laps");
    link_walk(root / "laps/lap", SIZE_MAX, root / "lap");
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
    const cv::Mat train = descriptors_of(folder_ / "monday");
    const cv::Mat query = descriptors_of(folder_ / "tuesday");
    write_matrix(folder_ / "monday.npy", train);
    write_matrix(folder_ / "tuesday.npy", query);
    write_matrix(folder_ / "S.npy", query * train.t());
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
  CHECK(has(outcome.out, " recognized, all correctly."));
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

TEST_CASE("the report has every number of the worked example") {
  std::map<std::string, Words> rows;  // by the first cell, without its quotes
  for (const std::string& line : lines_of(read_text(source_path("docs/reference/metrics.md")))) {
    Words cells;
    for (const std::string_view cell : split(line, '|')) cells.emplace_back(without_blanks(cell));
    if (cells.size() < 3) continue;
    std::erase(cells[1], '`');
    rows[cells[1]] = {cells.begin() + 2, cells.end() - 1};
  }
  std::string matches = "query,reference,score\n";
  std::string truth = "query,reference\n";
  for (size_t frame = 0; frame < 10; ++frame) {
    if (const std::string& same = rows.at("truth").at(frame); !same.empty())
      truth += fmt::format("{},{}\n", frame, same);
    if (const std::string& best = rows.at("best match").at(frame); !best.empty())
      matches += fmt::format("{},{},{}\n", frame, best, rows.at("score").at(frame));
  }
  write_text("matches.csv", matches);
  write_text("truth.csv", truth);
  const Json report =
      printed_json("vpr-eval", {"matrix", "matches.csv", "--similarity", "--threshold", "0.55",
                                "--ground-truth", "truth.csv", "--json"});
  size_t checked = 0;
  for (const auto& [name, cells] : rows) {
    if (!name.starts_with("best_match.") && !name.starts_with("metrics.") &&
        !name.starts_with("localization."))
      continue;
    const size_t reached = name.rfind(".0.");  // a key that holds a point
    std::string pointer = "/" + name;
    std::replace(pointer.begin(),
                 reached == std::string::npos
                     ? pointer.end()
                     : pointer.begin() + static_cast<ptrdiff_t>(reached) + 2,
                 '.', '/');
    INFO(name);
    CHECK(report.at(Json::json_pointer(pointer)).get<double>() ==
          Approx(std::stod(cells.at(0))).margin(0.00005));
    ++checked;
  }
  CHECK(checked == 23);
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
