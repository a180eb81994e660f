// Files of checksums, one line per frame, which show the first frame that changed.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace vpr::test {

/// The result for one frame.
struct FrameChecksum {
  std::string frame;  ///< its name, one or more words
  std::string text;   ///< one or several checksums
};

/// The contents of test/golden/NAME.crc without lines that start with #.
std::vector<FrameChecksum> read_checksums(const std::string& name);

/// Empty if both are equal; otherwise a sentence with the first changed frame, the number of
/// changed frames, and how to accept them. `name`: of the file.
std::string first_change(const std::string& name, const std::vector<FrameChecksum>& expected,
                         const std::vector<FrameChecksum>& found);

/// Compares with the file; with VPR_GOLDEN=write, as in scripts/generate.sh, writes it instead.
void check_golden(const std::string& name, const std::string& what,
                  const std::vector<FrameChecksum>& found);

/// The first eight digits of a checksum (base/checksum.h).
std::string short_checksum(std::span<const std::byte> bytes);

/// The short checksum of integers, as stored in memory.
template <class T>
std::string short_checksum(const std::vector<T>& values) {
  static_assert(std::is_integral_v<T>);
  return short_checksum(std::as_bytes(std::span(values)));
}

}  // namespace vpr::test
