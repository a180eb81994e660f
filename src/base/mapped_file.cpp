#include "base/mapped_file.h"

#include <algorithm>
#include <cerrno>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"

namespace vpr {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error_number) {
  throw Error(ErrorKind::input, "{}: can't be read: {}", path.string(),
              system_error_text(error_number));
}

// A regular file, open for reading.
struct InputFile {
  explicit InputFile(const std::filesystem::path& path)
      : descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    if (descriptor < 0) fail(path, errno);
    struct stat status {};
    int error_number = ::fstat(descriptor, &status) == 0 ? 0 : errno;
    const bool is_other = error_number == 0 && !S_ISREG(status.st_mode);
    if (is_other && S_ISDIR(status.st_mode)) error_number = EISDIR;
    size = static_cast<size_t>(status.st_size);
    if (error_number == 0 && !is_other) return;
    ::close(descriptor);
    if (error_number != 0) fail(path, error_number);
    throw Error(ErrorKind::input, "{}: is not a regular file. Save its content to one",
                path.string());
  }
  ~InputFile() { ::close(descriptor); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  int descriptor;
  size_t size = 0;
};

/// Mapped files by their first address.
struct Mappings {
  struct File {
    size_t size = 0;
    std::filesystem::path path;
  };
  std::mutex mutex;
  std::map<const std::byte*, File> files;
};

Mappings& mappings() {
  static Mappings all;
  return all;
}

}  // namespace

const std::filesystem::path* mapped_file_at(const void* address) {
  const std::unique_lock lock(mappings().mutex, std::try_to_lock);
  if (!lock) return nullptr;
  const auto& files = mappings().files;
  const auto* const wanted = static_cast<const std::byte*>(address);
  auto found = files.upper_bound(wanted);
  if (found == files.begin()) return nullptr;
  --found;
  return wanted < found->first + found->second.size ? &found->second.path : nullptr;
}

MappedFile::MappedFile(const std::filesystem::path& path) {
  const InputFile file(path);
  if (file.size == 0) return;
  void* const data = ::mmap(nullptr, file.size, PROT_READ, MAP_PRIVATE, file.descriptor, 0);
  if (data == MAP_FAILED) fail(path, errno);
  data_ = static_cast<const std::byte*>(data);
  size_ = file.size;
  const std::scoped_lock lock(mappings().mutex);
  mappings().files[data_] = {size_, path};
}

MappedFile::~MappedFile() {
  if (data_ == nullptr) return;
  const std::scoped_lock lock(mappings().mutex);
  mappings().files.erase(data_);
  ::munmap(const_cast<std::byte*>(data_), size_);
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
  return read_file_start(path, std::numeric_limits<size_t>::max());
}

std::string read_file_start(const std::filesystem::path& path, size_t most) {
  const InputFile file(path);
  std::string bytes(std::min(file.size, most), '\0');
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(file.descriptor, bytes.data() + done, bytes.size() - done);
    if (got == 0) break;
    if (got > 0) done += static_cast<size_t>(got);
    if (got < 0 && errno != EINTR) fail(path, errno);
  }
  bytes.resize(done);
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    throw Error(ErrorKind::input, "{}: is encoded in UTF-16. Save it as UTF-8", path.string());
  return bytes;
}

}  // namespace vpr
