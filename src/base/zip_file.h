// Zip archives, such as NumPy's .npz files: entries are read in sequence, lengths are not trusted.
// Equal content is written as equal bytes, with the earliest date that zip supports.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "base/mapped_file.h"
#include "base/output.h"

struct zip;
struct zip_file;

namespace vpr {

/// The files of an archive, stored or deflated. Throws Error(input) if it cannot be read,
/// Error(data) if it is not a zip archive.
class ZipFile {
 public:
  explicit ZipFile(const std::filesystem::path& path);
  ~ZipFile();
  ZipFile(const ZipFile&) = delete;
  ZipFile& operator=(const ZipFile&) = delete;

  /// The names of all files, in the order of the archive.
  const std::vector<std::string>& names() const { return names_; }

  /// One file, read from its beginning. The archive must outlive it.
  class Entry {
   public:
    Entry(ZipFile& archive, size_t index);
    ~Entry();
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;
    /// Reads at most bytes.size() bytes; returns 0 at the end. Throws Error(data) if they are
    /// damaged; a wrong checksum is detected at the end.
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

/// A file to add to an archive: `fill` writes its next bytes and returns their number, 0 at the
/// end.
struct ZipContent {
  std::string name;
  std::function<size_t(std::span<std::byte> bytes)> fill;
};

/// The bytes of an archive with these files, deflated. Throws Error(internal) if libzip fails.
std::string zip_archive(std::vector<ZipContent> contents);

/// Writes an archive whose files are not deflated. Each begins at a multiple of 64 bytes, so that
/// it can be mapped into memory. Sizes from 4 GiB are written as zip64.
class ZipWriter {
 public:
  explicit ZipWriter(Output& file) : file_(file) {}
  /// Writes a file of these parts. `name`: at most 65535 bytes of ASCII.
  void add(const std::string& name, std::initializer_list<std::span<const std::byte>> parts);
  /// Writes the directory, once, after all files.
  void finish();

 private:
  struct Added {
    std::string name;
    uint64_t offset = 0;
    uint64_t size = 0;
    uint32_t crc = 0;
  };

  Output& file_;
  uint64_t position_ = 0;
  std::vector<Added> added_;
};

}  // namespace vpr
