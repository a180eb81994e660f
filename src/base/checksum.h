// Checksums of files and fingerprints of data: XXH3, 128 bits, written "xxh3:<32 hex digits>".
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace vpr {

/// The 128-bit XXH3 checksum of bytes as text: "xxh3:" and 32 hexadecimal digits. No bytes have
/// one, too.
std::string checksum(std::span<const std::byte> bytes);
std::string checksum(std::string_view text);

/// The checksum of bytes that arrive piece by piece; pieces may be cut anywhere.
class ChecksumStream {
 public:
  ChecksumStream();
  ~ChecksumStream();
  ChecksumStream(const ChecksumStream&) = delete;
  ChecksumStream& operator=(const ChecksumStream&) = delete;
  void add(std::span<const std::byte> bytes);
  std::string text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vpr
