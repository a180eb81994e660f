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

// A regular file, open for reading.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path)
      : path_(path), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    if (file_ < 0) fail(path, errno);
    struct stat status {};
    int error_number = ::fstat(file_, &status) == 0 ? 0 : errno;
    if (error_number == 0 && !S_ISREG(status.st_mode))
      error_number = S_ISDIR(status.st_mode) ? EISDIR : EINVAL;
    if (error_number != 0) {
      ::close(file_);
      fail(path, error_number);
    }
    size_ = static_cast<size_t>(status.st_size);
  }
  ~InputFile() { ::close(file_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  size_t size() const { return size_; }

  const std::byte* map() const {
    void* const data = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file_, 0);
    if (data == MAP_FAILED) fail(path_, errno);
    return static_cast<const std::byte*>(data);
  }

  size_t read(char* bytes) const {
    size_t done = 0;
    while (done < size_) {
      const ssize_t got = ::read(file_, bytes + done, size_ - done);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail(path_, errno);
      if (got == 0) break;
      done += static_cast<size_t>(got);
    }
    return done;
  }

 private:
  const std::filesystem::path& path_;
  int file_;
  size_t size_ = 0;
};

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
  const InputFile file(path);
  if (file.size() == 0) return;
  data_ = file.map();
  size_ = file.size();
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

std::string read_whole_file(const std::filesystem::path& path) {
  const InputFile file(path);
  std::string bytes(file.size(), '\0');
  bytes.resize(file.read(bytes.data()));
  return bytes;
}

}  // namespace vpr
