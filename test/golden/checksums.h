// Files of checksums, a line a frame, so that a change of a number shows where it starts.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace vpr::test {

/// What was computed for one frame.
struct FrameChecksum {
  std::string frame;  ///< its name, of one or more words
  std::string text;   ///< a checksum, or several
};

/// What stands in test/golden/NAME.crc; lines that start with # are left out.
std::vector<FrameChecksum> read_checksums(const std::string& name);

/// Empty if both are the same; else a sentence that names the first frame that changed, how many
/// did, and how to take the new ones. `name`: of the file.
std::string first_change(const std::string& name, const std::vector<FrameChecksum>& expected,
                         const std::vector<FrameChecksum>& found);

/// Compares with the file; with VPR_GOLDEN=write, as scripts/golden.sh calls it, writes it instead.
void check_golden(const std::string& name, const std::string& what,
                  const std::vector<FrameChecksum>& found);

/// The first eight digits of a checksum (base/checksum.h).
std::string short_checksum(std::span<const std::byte> bytes);

/// The same of whole numbers, as they lie in memory.
template <class T>
std::string short_checksum(const std::vector<T>& values) {
  static_assert(std::is_integral_v<T>);
  return short_checksum(std::as_bytes(std::span(values)));
}

}  // namespace vpr::test
