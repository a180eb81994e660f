// A whole file as read-only memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace vpr {

/// Owns the mapping. An empty file gives an empty span.
class MappedFile {
 public:
  MappedFile() = default;
  /// Throws Error(input) when the file is missing, not a regular file, or can't be read.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;

  std::span<const std::byte> bytes() const { return {data_, size_}; }
  std::string_view text() const { return {reinterpret_cast<const char*>(data_), size_}; }
  /// Gives the memory of these bytes back, as far as they fill whole pages; they stay readable, and
  /// are read from the file again.
  void forget(size_t first, size_t size) const;

 private:
  const std::byte* data_ = nullptr;
  size_t size_ = 0;
};

/// The bytes of a file that another program may change or truncate meanwhile, which would kill a
/// process that maps it: as many as it had when it was opened, or fewer. Throws as MappedFile does.
std::string read_whole_file(const std::filesystem::path& path);

}  // namespace vpr
