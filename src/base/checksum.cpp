#include "base/checksum.h"

#include <fmt/format.h>
#include <xxhash.h>

#include "base/error.h"

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

struct ChecksumStream::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

ChecksumStream::ChecksumStream() : state_(std::make_unique<State>()) {
  if (state_->xxh == nullptr) throw std::bad_alloc();
  XXH3_128bits_reset(state_->xxh);
}

ChecksumStream::~ChecksumStream() = default;

void ChecksumStream::add(std::span<const std::byte> bytes) {
  XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size());
}

std::string ChecksumStream::text() const { return as_text(XXH3_128bits_digest(state_->xxh)); }

}  // namespace vpr
