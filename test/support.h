// Helpers for tests of several folders.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/monitor.h"
#include "base/npy.h"
#include "base/simd.h"
#include "match/frame_distances.h"

namespace vpr::test {

/// An empty folder that is removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void write_text(const std::filesystem::path& path, const std::string& text);
std::string read_text(const std::filesystem::path& path);
bool has(const std::string& text, std::string_view part);
/// Names of everything in a folder, hidden files included, sorted.
std::vector<std::string> list_folder(const std::filesystem::path& folder);

/// Writes a .npy file of one or two dimensions with the values in C order; `is_column_major` writes
/// them in Fortran order.
template <class T>
void write_array(const std::filesystem::path& path, const std::vector<T>& values,
                 const std::vector<size_t>& shape, bool is_column_major = false) {
  std::string header = npy_header(npy_type<T>(), shape);
  std::vector<T> stored = values;
  if (is_column_major) {
    header.replace(header.find("False,"), 6, "True, ");
    for (size_t i = 0; i < values.size(); ++i)
      stored[i % shape[1] * shape[0] + i / shape[1]] = values[i];
  }
  write_text(path, header + std::string(reinterpret_cast<const char*>(stored.data()),
                                        stored.size() * sizeof(T)));
}

/// The values of a .npy file.
template <class T>
std::vector<T> read_array(const std::filesystem::path& path) {
  const NpyArray array(path);
  const auto values = array.values<T>(array.shape().size());
  return {values.begin(), values.end()};
}

/// Writes a gray image with seeded content.
void write_image(const std::filesystem::path& path, uint64_t seed, int width = 40, int height = 30);

/// Writes a Motion JPEG video (.avi) with one frame of a single gray level per level.
void write_video(const std::filesystem::path& path, int width, int height,
                 const std::vector<int>& levels, double fps = 10);

/// Descriptors of any kind, one after the other.
struct Vectors {
  DescriptorShape shape;
  std::vector<uint8_t> bytes;

  DescribedFrames span(std::span<const size_t> unreadable = {}) const {
    return {{shape, bytes}, unreadable};
  }
};

std::vector<LdbCode> random_codes(size_t count, uint64_t seed);
/// A sequence in which consecutive codes differ in about `changed_bits` bits.
std::vector<LdbCode> walk_codes(size_t count, uint64_t seed, int changed_bits = 60);

/// Selects one of simd_targets() during its lifetime, then the best one again.
class ChosenTarget {
 public:
  explicit ChosenTarget(const std::string& name) { use_simd_target(name); }
  ~ChosenTarget() { use_simd_target(""); }
  ChosenTarget(const ChosenTarget&) = delete;
  ChosenTarget& operator=(const ChosenTarget&) = delete;
};

/// The real image sequences, in $VPR_TEST_DATA or next to the project; without them, prints why the
/// test is skipped and returns nullopt.
std::optional<std::filesystem::path> real_data(const std::string& folder);
bool lacked_data();

using Words = std::vector<std::string>;

Words joined(Words words, const Words& more);

struct RunOutcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};
/// Runs one of the programs without a shell. `environment`: NAME=VALUE.
RunOutcome run_program(const std::string& program, const Words& arguments,
                       const Words& environment = {});
/// Requires exit code 0.
RunOutcome ok(const RunOutcome& outcome);
RunOutcome run_ok(const std::string& program, const Words& arguments,
                  const Words& environment = {});
std::filesystem::path program_path(const std::string& program);
std::filesystem::path source_path(const std::string& name);

/// A monitor that keeps its warnings.
struct Warnings {
  std::vector<std::string> said;
  Monitor monitor;

  Warnings() {
    monitor.warn = [this](const std::string& sentence) { said.push_back(sentence); };
  }
  Warnings(const Warnings&) = delete;
  Warnings& operator=(const Warnings&) = delete;
};

/// The kind of the Error that `work` throws, or nullopt.
template <class Work>
std::optional<ErrorKind> error_kind(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.kind();
  }
  return std::nullopt;
}

/// The message of the Error that `work` throws; empty if it throws none.
template <class Work>
std::string error_text(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace vpr::test
