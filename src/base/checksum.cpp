#include "base/checksum.h"

#include <new>

#include <fmt/format.h>
#include <xxhash.h>

namespace vpr {
namespace {

std::string as_text(XXH128_hash_t hash) {
  return fmt::format("xxh3:{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::string checksum(std::span<const std::byte> bytes) {
  return as_text(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string checksum(std::string_view text) { return checksum(std::as_bytes(std::span(text))); }

ChecksumStream::ChecksumStream()
    : state_(XXH3_createState(), [](XXH3_state_s* state) { XXH3_freeState(state); }) {
  if (state_ == nullptr) throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
}

void ChecksumStream::add(std::span<const std::byte> bytes) {
  XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
}

std::string ChecksumStream::text() const { return as_text(XXH3_128bits_digest(state_.get())); }

}  // namespace vpr
