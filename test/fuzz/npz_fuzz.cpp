// An archive of matrices as ground truth: raw bytes, and parts packed with valid checksums.
#include <algorithm>

#include "base/zip_file.h"
#include "fuzz.h"
#include "truth/ground_truth.h"

using namespace vpr;

namespace {

std::string pack(const std::vector<fuzz::Part>& parts) {
  std::vector<ZipContent> contents;
  for (const fuzz::Part& part : parts)
    contents.push_back(
        {part.name, [rest = std::string_view(part.bytes)](std::span<std::byte> bytes) mutable {
           const size_t count = std::min(bytes.size(), rest.size());
           std::copy_n(reinterpret_cast<const std::byte*>(rest.data()), count, bytes.begin());
           rest.remove_prefix(count);
           return count;
         }});
  return zip_archive(std::move(contents));
}

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
  const std::string packed = parts.empty() ? std::string(input) : pack(parts);
  const std::filesystem::path path = memory_file(packed);
  refuses([&] { read_files(path); });
  refuses([&] { read_matrix(path); });
}
