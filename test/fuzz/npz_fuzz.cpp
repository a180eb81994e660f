// An archive of matrices as ground truth: raw bytes, and parts packed with valid checksums.
#include "base/zip_file.h"
#include "fuzz.h"
#include "truth/ground_truth.h"

using namespace vpr;

namespace {

void read_files(const std::filesystem::path& path) {
  ZipFile archive(path);
  std::vector<std::byte> bytes(1000);
  for (size_t i = 0; i < archive.names().size(); ++i) {
    ZipFile::Entry entry(archive, i);
    for (int piece = 0; piece < 100 && entry.read(bytes) > 0; ++piece) {
    }
  }
}

void read_matrix(const std::filesystem::path& path) {
  GroundTruthArgument argument;
  argument.format = "matrix";
  argument.path = path;
  inspect_ground_truth(argument, {{"", kUnknownFrames}, {{"", kUnknownFrames}}});
}

}  // namespace

void fuzz::run(std::string_view input) {
  const std::vector<Part> parts = split_parts(input);
  const std::string archive = parts.empty() ? std::string(input) : fuzz::packed(parts);
  const std::filesystem::path path = memory_file(archive);
  refuses([&] { read_files(path); });
  refuses([&] { read_matrix(path); });
}
