#include "memory_file.h"

#include <cstdlib>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

namespace vpr::fuzz {

std::filesystem::path memory_file(const uint8_t* data, size_t size) {
  static const int kFile = ::memfd_create("fuzz", 0);
  if (kFile < 0 || ::ftruncate(kFile, 0) != 0) std::abort();
  for (size_t written = 0; written < size;) {
    const ssize_t count =
        ::pwrite(kFile, data + written, size - written, static_cast<off_t>(written));
    if (count <= 0) std::abort();
    written += static_cast<size_t>(count);
  }
  return "/proc/self/fd/" + std::to_string(kFile);
}

}  // namespace vpr::fuzz
