#include "base/mapped_file.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"

namespace vpr {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error_number) {
  throw Error(ErrorKind::input,
              fmt::format("{}: can't be read: {}", path.string(), system_error_text(error_number)));
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) fail(path, errno);
  struct stat status {};
  int error_number = ::fstat(file, &status) == 0 ? 0 : errno;
  if (error_number == 0 && !S_ISREG(status.st_mode))
    error_number = S_ISDIR(status.st_mode) ? EISDIR : EINVAL;
  if (error_number == 0 && status.st_size > 0) {
    const auto size = static_cast<size_t>(status.st_size);
    void* data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
    if (data == MAP_FAILED) {
      error_number = errno;
    } else {
      data_ = static_cast<const std::byte*>(data);
      size_ = size;
    }
  }
  ::close(file);
  if (error_number != 0) fail(path, error_number);
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(const_cast<std::byte*>(data_), size_);
}

void MappedFile::forget(size_t first, size_t size) const {
  const auto page = static_cast<size_t>(::sysconf(_SC_PAGESIZE));
  const size_t begin = (first + page - 1) / page * page;
  const size_t end = std::min(first + size, size_) / page * page;
  if (begin < end) ::madvise(const_cast<std::byte*>(data_) + begin, end - begin, MADV_DONTNEED);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

}  // namespace vpr
