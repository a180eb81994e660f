#include "base/zip_file.h"

#include <cstring>

#include <zip.h>

#include "base/error.h"

namespace vpr {
namespace {

std::string error_text(zip_error_t& error) {
  std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

[[noreturn]] void fail(const std::string& where, const std::string& what) {
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

}  // namespace

ZipFile::ZipFile(const std::filesystem::path& path) : where_(path.string()), file_(path) {
  zip_error_t error;
  zip_error_init(&error);
  const auto bytes = file_.bytes();
  if (bytes.empty()) fail(where_, "it is empty");
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source == nullptr) fail(where_, error_text(error));
  archive_ = zip_open_from_source(source, ZIP_RDONLY, &error);
  if (archive_ == nullptr) {
    zip_source_free(source);
    fail(where_, error_text(error));
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
  if (file_ == nullptr) fail(where_, zip_strerror(archive.archive_));
}

ZipFile::Entry::~Entry() { zip_fclose(file_); }

size_t ZipFile::Entry::read(std::span<std::byte> bytes) {
  const zip_int64_t got = zip_fread(file_, bytes.data(), bytes.size());
  if (got < 0) fail(where_, zip_file_strerror(file_));
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
    zip_file_set_dostime(archive, static_cast<zip_uint64_t>(index), 0, 0x21, 0);  // 1 January 1980
  }
  if (zip_close(archive) != 0) {
    zip_discard(archive);
    require(false, "close");
  }
  return written_bytes(target);
}

}  // namespace vpr
