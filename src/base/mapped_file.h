// A whole file as read-only memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace vpr {

/// Owns the mapping. An empty file yields an empty span.
class MappedFile {
 public:
  MappedFile() = default;
  /// Throws Error(input) if the file is missing, is not a regular file, or cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;

  std::span<const std::byte> bytes() const { return {data_, size_}; }
  std::string_view text() const { return {reinterpret_cast<const char*>(data_), size_}; }
  /// Releases the memory of these bytes, as far as they fill whole pages. They stay readable; the
  /// system reads them from the file again.
  void forget(size_t first, size_t size) const;

 private:
  const std::byte* data_ = nullptr;
  size_t size_ = 0;
};

/// Reads a file that another program may modify or truncate at the same time, which would crash a
/// process that maps it. Returns at most as many bytes as the file had when it was opened. Throws
/// as MappedFile does.
std::string read_whole_file(const std::filesystem::path& path);
/// Enough of a file to tell its format: every video has a byte in it that text does not have.
inline constexpr size_t kFileStart = 65536;
/// At most its first `most` bytes.
std::string read_file_start(const std::filesystem::path& path, size_t most);

/// The mapped file that holds this address; null if there is none, or if another thread is mapping
/// one. For handlers of SIGBUS: the file has become shorter since it was mapped.
const std::filesystem::path* mapped_file_at(const void* address);

}  // namespace vpr
