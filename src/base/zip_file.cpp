#include "base/zip_file.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include <zip.h>
#include <zlib.h>

#include "base/error.h"

namespace vpr {
namespace {

std::string error_text(zip_error_t& error) {
  std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

[[noreturn]] void fail_archive(const std::string& where, const std::string& what) {
  throw Error(ErrorKind::data, "{}: is a damaged zip archive ({})", where, what);
}

// The callback by which libzip reads a ZipContent.
zip_int64_t supply(void* state, void* data, zip_uint64_t size, zip_source_cmd_t command) {
  const auto* content = static_cast<const ZipContent*>(state);
  switch (command) {
    case ZIP_SOURCE_OPEN:
    case ZIP_SOURCE_CLOSE:
    case ZIP_SOURCE_FREE:
      return 0;
    case ZIP_SOURCE_READ:
      return static_cast<zip_int64_t>(content->fill({static_cast<std::byte*>(data), size}));
    case ZIP_SOURCE_STAT:
      zip_stat_init(static_cast<zip_stat_t*>(data));
      return sizeof(zip_stat_t);
    case ZIP_SOURCE_ERROR: {
      const int none[2] = {0, 0};
      std::memcpy(data, none, sizeof(none));
      return sizeof(none);
    }
    case ZIP_SOURCE_SUPPORTS:
      return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE,
                                            ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, -1);
    default:
      return -1;
  }
}

void require(bool good, const char* what) {
  if (!good) throw Error(ErrorKind::internal, "writing a zip archive failed: {}", what);
}

// All bytes that libzip has written to `source`.
std::string written_bytes(zip_source_t* source) {
  zip_stat_t status;
  require(zip_source_stat(source, &status) == 0 && (status.valid & ZIP_STAT_SIZE) != 0, "size");
  std::string bytes(status.size, '\0');
  require(zip_source_open(source) == 0, "open");
  const zip_int64_t got = zip_source_read(source, bytes.data(), bytes.size());
  zip_source_close(source);
  require(got == static_cast<zip_int64_t>(bytes.size()), "read");
  return bytes;
}

constexpr uint64_t kAlignment = 64;     // of the bytes of a file in its archive
constexpr uint64_t kMost = 0xffffffff;  // without zip64; itself the mark of zip64
constexpr int kVersion = 20;            // that a reader needs
constexpr int kZip64Version = 45;
constexpr int kDate = 0x21;  // 1 January 1980

/// Little-endian fields of a zip archive.
struct ZipFields {
  std::string bytes;

  ZipFields& add(int size, uint64_t value) {
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> 8 * i & 255);
    return *this;
  }
  // The fields that a file has in its own header and in the directory.
  ZipFields& add_file(bool is_large, uint64_t size, uint32_t crc, size_t name, size_t extra) {
    add(2, is_large ? kZip64Version : kVersion).add(2, 0).add(2, 0);  // no flags, stored
    add(2, 0).add(2, kDate).add(4, crc);
    add(4, is_large ? kMost : size).add(4, is_large ? kMost : size);
    return add(2, name).add(2, extra);
  }
};

}  // namespace

ZipFile::ZipFile(const std::filesystem::path& path) : where_(path.string()), file_(path) {
  zip_error_t error;
  zip_error_init(&error);
  const auto bytes = file_.bytes();
  if (bytes.empty()) fail_archive(where_, "it is empty");
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source == nullptr) fail_archive(where_, error_text(error));
  archive_ = zip_open_from_source(source, ZIP_RDONLY, &error);
  if (archive_ == nullptr) {
    zip_source_free(source);
    fail_archive(where_, error_text(error));
  }
  zip_error_fini(&error);
  const zip_int64_t count = zip_get_num_entries(archive_, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(archive_, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_RAW);
    names_.emplace_back(name == nullptr ? "" : name);
  }
}

ZipFile::~ZipFile() { zip_discard(archive_); }

ZipFile::Entry::Entry(ZipFile& archive, size_t index)
    : where_(archive.where_ + ", " + archive.names_.at(index)),
      file_(zip_fopen_index(archive.archive_, index, 0)) {
  if (file_ == nullptr) fail_archive(where_, zip_strerror(archive.archive_));
}

ZipFile::Entry::~Entry() { zip_fclose(file_); }

size_t ZipFile::Entry::read(std::span<std::byte> bytes) {
  const zip_int64_t got = zip_fread(file_, bytes.data(), bytes.size());
  if (got < 0) fail_archive(where_, zip_file_strerror(file_));
  return static_cast<size_t>(got);
}

std::string zip_archive(std::vector<ZipContent> contents) {
  zip_source_t* target = zip_source_buffer_create(nullptr, 0, 0, nullptr);
  require(target != nullptr, "target");
  zip_source_keep(target);
  const std::unique_ptr<zip_source_t, void (*)(zip_source_t*)> owner(target, zip_source_free);
  zip_t* archive = zip_open_from_source(target, ZIP_TRUNCATE, nullptr);
  if (archive == nullptr) zip_source_free(target);
  require(archive != nullptr, "open");
  for (ZipContent& content : contents) {
    zip_source_t* source = zip_source_function(archive, supply, &content);
    const zip_int64_t index = zip_file_add(archive, content.name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      zip_discard(archive);
      require(false, "add");
    }
    zip_file_set_dostime(archive, static_cast<zip_uint64_t>(index), 0, kDate, 0);
  }
  if (zip_close(archive) != 0) {
    zip_discard(archive);
    require(false, "close");
  }
  return written_bytes(target);
}

void ZipWriter::add(const std::string& name,
                    std::initializer_list<std::span<const std::byte>> parts) {
  Added added{name, position_, 0, 0};
  for (const auto part : parts) {
    if (part.empty()) continue;  // crc32_z takes a null pointer as a new beginning
    added.size += part.size();
    added.crc = static_cast<uint32_t>(
        crc32_z(added.crc, reinterpret_cast<const Bytef*>(part.data()), part.size()));
  }
  const bool is_large = added.size >= kMost;
  constexpr size_t kHeader = 30;
  ZipFields extra;
  if (is_large) extra.add(2, 1).add(2, 16).add(8, added.size).add(8, added.size);
  // Android's field of an alignment, which has any number of zeros at its end.
  const uint64_t end = position_ + kHeader + name.size() + extra.bytes.size() + 6;
  const size_t zeros = (kAlignment - end % kAlignment) % kAlignment;
  extra.add(2, 0xd935).add(2, 2 + zeros).add(2, kAlignment);
  extra.bytes.append(zeros, '\0');
  ZipFields header;
  header.add(4, 0x04034b50)
      .add_file(is_large, added.size, added.crc, name.size(), extra.bytes.size());
  const std::string start = header.bytes + name + extra.bytes;
  file_.write(start);
  for (const auto part : parts) file_.write(part);
  position_ += start.size() + added.size;
  added_.push_back(std::move(added));
}

void ZipWriter::finish() {
  ZipFields directory;
  for (const Added& added : added_) {
    const bool is_large = added.size >= kMost || added.offset >= kMost;
    ZipFields extra;
    if (is_large) extra.add(2, 1).add(2, 24).add(8, added.size).add(8, added.size);
    if (is_large) extra.add(8, added.offset);
    directory.add(4, 0x02014b50).add(2, kZip64Version);
    directory.add_file(is_large, added.size, added.crc, added.name.size(), extra.bytes.size());
    directory.add(2, 0).add(2, 0).add(2, 0).add(4, 0);  // no comment, no attributes
    directory.add(4, is_large ? kMost : added.offset);
    directory.bytes += added.name + extra.bytes;
  }
  const uint64_t size = directory.bytes.size();
  const size_t count = added_.size();
  assert(count < 65535);
  if (position_ >= kMost) {
    directory.add(4, 0x06064b50).add(8, 44).add(2, kZip64Version).add(2, kZip64Version);
    directory.add(4, 0).add(4, 0).add(8, count).add(8, count).add(8, size).add(8, position_);
    directory.add(4, 0x07064b50).add(4, 0).add(8, position_ + size).add(4, 1);
  }
  directory.add(4, 0x06054b50).add(2, 0).add(2, 0).add(2, count).add(2, count);
  directory.add(4, size).add(4, std::min(position_, kMost)).add(2, 0);
  file_.write(directory.bytes);
}

}  // namespace vpr
