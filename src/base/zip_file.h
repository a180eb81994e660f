// Zip archives, as NumPy's .npz files are: read one after the other, never trusted.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/mapped_file.h"

struct zip;
struct zip_file;

namespace vpr {

/// Files of an archive, stored or deflated. Throws Error(input) if it can't be read, Error(data) if
/// it is no archive.
class ZipFile {
 public:
  explicit ZipFile(const std::filesystem::path& path);
  ~ZipFile();
  ZipFile(const ZipFile&) = delete;
  ZipFile& operator=(const ZipFile&) = delete;

  /// Their names, in the order of the archive.
  const std::vector<std::string>& names() const { return names_; }

  /// One file, from its beginning. It must not outlive the archive.
  class Entry {
   public:
    Entry(ZipFile& archive, size_t index);
    ~Entry();
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;
    /// At most as many bytes as there is room for; 0 at the end. Throws Error(data) if they are
    /// damaged; that the checksum is wrong shows at the end.
    size_t read(std::span<std::byte> bytes);

   private:
    std::string where_;
    zip_file* file_;
  };

 private:
  std::string where_;
  MappedFile file_;
  zip* archive_ = nullptr;
  std::vector<std::string> names_;
};

/// A file to be put into an archive: `fill` writes its next bytes and returns how many there were,
/// 0 at the end.
struct ZipContent {
  std::string name;
  std::function<size_t(std::span<std::byte> bytes)> fill;
};

/// The bytes of an archive with these files, deflated, with the earliest date that zip knows: equal
/// content gives equal bytes. Throws Error(internal) if libzip fails.
std::string zip_archive(std::vector<ZipContent> contents);

}  // namespace vpr
