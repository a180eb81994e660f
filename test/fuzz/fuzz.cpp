#include "fuzz.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>

#include <sys/mman.h>
#include <unistd.h>

#include "base/zip_file.h"

namespace vpr::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPartStart = "--- ";

bool is_name(std::string_view name) {
  return !name.empty() && name.size() < 40 && name[0] != '.' &&
         name.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._") ==
             std::string_view::npos;
}

fs::path make_folder() {
  std::string name = (fs::temp_directory_path() / "vpr-fuzz-XXXXXX").string();
  require(::mkdtemp(name.data()) != nullptr);
  return name;
}

/// The folder of the process, which is removed at its end.
struct OwnFolder {
  fs::path path = make_folder();
  ~OwnFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

}  // namespace

void require(bool good) {
  if (!good) std::abort();
}

bool is_refusal(const Error& error) {
  return error.kind() == ErrorKind::usage || error.kind() == ErrorKind::input ||
         error.kind() == ErrorKind::data || error.kind() == ErrorKind::expectation;
}

fs::path memory_file(std::string_view bytes) {
  static const int kFile = ::memfd_create("fuzz", 0);
  require(kFile >= 0 && ::ftruncate(kFile, 0) == 0);
  for (size_t written = 0; written < bytes.size();) {
    const ssize_t count = ::pwrite(kFile, bytes.data() + written, bytes.size() - written,
                                   static_cast<off_t>(written));
    require(count > 0);
    written += static_cast<size_t>(count);
  }
  return "/proc/self/fd/" + std::to_string(kFile);
}

std::vector<Part> split_parts(std::string_view input) {
  std::vector<Part> parts;
  while (!input.empty()) {
    const size_t end = std::min(input.find("\n--- "), input.size());
    const std::string_view part = input.substr(0, end);
    input.remove_prefix(std::min(end + 1, input.size()));
    const size_t line = part.find('\n');
    if (!part.starts_with(kPartStart) || line == std::string_view::npos) continue;
    const std::string_view name = part.substr(kPartStart.size(), line - kPartStart.size());
    if (is_name(name) && find_part(parts, name) == nullptr)
      parts.push_back({std::string(name), std::string(part.substr(line + 1))});
  }
  return parts;
}

const std::string* find_part(const std::vector<Part>& parts, std::string_view name) {
  for (const Part& part : parts)
    if (part.name == name) return &part.bytes;
  return nullptr;
}

std::string packed(const std::vector<Part>& parts) {
  std::vector<ZipContent> contents;
  for (const Part& part : parts)
    contents.push_back(
        {part.name, [rest = std::string_view(part.bytes)](std::span<std::byte> bytes) mutable {
           const size_t count = std::min(bytes.size(), rest.size());
           std::copy_n(reinterpret_cast<const std::byte*>(rest.data()), count, bytes.begin());
           rest.remove_prefix(count);
           return count;
         }});
  return zip_archive(std::move(contents));
}

fs::path folder_of(const std::vector<Part>& parts) {
  static const OwnFolder kFolder;
  for (const auto& entry : fs::directory_iterator(kFolder.path)) fs::remove(entry.path());
  for (const Part& part : parts)
    std::ofstream(kFolder.path / part.name, std::ios::binary) << part.bytes;
  return kFolder.path;
}

}  // namespace vpr::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  vpr::fuzz::refuses([&] { vpr::fuzz::run({reinterpret_cast<const char*>(data), size}); });
  return 0;
}
