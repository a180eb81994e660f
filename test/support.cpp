#include "support.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/random.h"
#include "served.h"

namespace vpr::test {
namespace {

namespace fs = std::filesystem;

bool data_was_lacking = false;

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "vpr-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string read_text(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

std::vector<std::string> list_folder(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

void write_image(const fs::path& path, uint64_t seed, int width, int height) {
  RandomEngine engine(seed);
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at<uint8_t>(y, x) = static_cast<uint8_t>(engine());
  cv::imwrite(path.string(), image);
}

void write_video(const fs::path& path, int width, int height, const std::vector<int>& levels,
                 double fps) {
  cv::VideoWriter writer(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), fps, {width, height});
  REQUIRE(writer.isOpened());
  for (const int level : levels)
    writer.write(cv::Mat(height, width, CV_8UC3, cv::Scalar::all(level)));
}

std::vector<LdbCode> random_codes(size_t count, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<LdbCode> codes(count);
  for (LdbCode& code : codes)
    for (size_t bit = 0; bit < kLdbBits; ++bit)
      if (engine() & 1) code[bit / 8] = static_cast<uint8_t>(code[bit / 8] | 1 << bit % 8);
  return codes;
}

std::vector<LdbCode> walk_codes(size_t count, uint64_t seed, int changed_bits) {
  RandomEngine engine(seed);
  std::vector<LdbCode> codes = random_codes(1, seed + 1);
  while (codes.size() < count) {
    LdbCode code = codes.back();
    for (int i = 0; i < changed_bits; ++i) {
      const uint64_t bit = uniform_below(engine, kLdbBits);
      code[bit / 8] = static_cast<uint8_t>(code[bit / 8] ^ 1 << bit % 8);
    }
    codes.push_back(code);
  }
  codes.resize(count);
  return codes;
}

std::optional<fs::path> real_data(const std::string& folder) {
  const char* given = std::getenv("VPR_TEST_DATA");
  const fs::path root =
      given != nullptr ? fs::path(given) : fs::path(VPR_TEST_SOURCE) / "../shared";
  if (fs::exists(root / folder)) return root / folder;
  fmt::print("SKIPPED: needs the real images {} in the folder that VPR_TEST_DATA names\n", folder);
  data_was_lacking = true;
  return std::nullopt;
}

bool lacked_data() { return data_was_lacking; }

fs::path program_path(const std::string& program) { return fs::path(VPR_TEST_PROGRAMS) / program; }

fs::path source_path(const std::string& name) { return fs::path(VPR_TEST_SOURCE) / name; }

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

namespace {

std::optional<int> run_spawned(Words words, const Words& environment, const std::string& out,
                               const std::string& err) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), flags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), flags, 0600);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  Environment variables(environment);
  pid_t child = 0;
  std::optional<int> status;
  if (::posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), variables.data()) == 0)
    ::waitpid(child, &status.emplace(), 0);
  posix_spawn_file_actions_destroy(&actions);
  return status;
}

}  // namespace

RunOutcome run_program(const std::string& program, const Words& arguments,
                       const Words& environment) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const std::string err = folder / "err";
  const Words words = joined({program_path(program).string()}, arguments);
  std::optional<int> status;
  // Libraries read the environment when they are loaded.
  if (environment.empty()) status = run_served(words, out, err);
  if (!status) status = run_spawned(words, environment, out, err);
  RunOutcome outcome;
  if (status)
    outcome.exit_code = WIFEXITED(*status) ? WEXITSTATUS(*status) : 128 + WTERMSIG(*status);
  outcome.out = read_text(out);
  outcome.err = read_text(err);
  return outcome;
}

RunOutcome ok(const RunOutcome& outcome) {
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  return outcome;
}

RunOutcome run_ok(const std::string& program, const Words& arguments, const Words& environment) {
  return ok(run_program(program, arguments, environment));
}

}  // namespace vpr::test
