// Checksums of files and fingerprints of data: XXH3, 128 bits, written "xxh3:<32 hex digits>".
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct XXH3_state_s;

namespace vpr {

/// "xxh3:" and the 128-bit XXH3 checksum of the bytes as 32 hexadecimal digits. Empty input is
/// valid.
std::string checksum(std::span<const std::byte> bytes);
std::string checksum(std::string_view text);

/// The checksum of bytes that arrive in pieces; it does not depend on the size of the pieces.
class ChecksumStream {
 public:
  ChecksumStream();
  void add(std::span<const std::byte> bytes);
  std::string text() const;

 private:
  std::unique_ptr<XXH3_state_s, void (*)(XXH3_state_s*)> state_;
};

}  // namespace vpr
