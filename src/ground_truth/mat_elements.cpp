#include "ground_truth/mat_elements.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <new>
#include <optional>
#include <string>

#include <zlib.h>

namespace vpr {
namespace {

constexpr std::string_view kVersion5 = "MATLAB 5.0 MAT-file";
constexpr std::string_view kVersion73 = "MATLAB 7.3 MAT-file";
constexpr size_t kHeaderBytes = 128;
constexpr size_t kTagBytes = 8;
constexpr uint32_t kMatrix = 14;
constexpr uint32_t kCompressed = 15;
constexpr size_t kChunkBytes = 1 << 16;

uint32_t number_at(std::string_view bytes, size_t at, bool is_little) {
  uint32_t number = 0;
  for (size_t i = 0; i < 4; ++i)
    number |= uint32_t{static_cast<uint8_t>(bytes[at + i])} << 8 * (is_little ? i : 3 - i);
  return number;
}

/// The parts of a matrix, whose bytes come in pieces of any length.
class PartWalk {
 public:
  PartWalk(const GroundTruthBuilder& builder, size_t matrix_bytes, bool is_little)
      : builder_(builder), left_(matrix_bytes), is_little_(is_little) {}

  void feed(std::string_view bytes) {
    while (!bytes.empty() && left_ > 0) {
      const size_t wanted = part_left_ > 0 ? part_left_ : kTagBytes - tag_.size();
      const std::string_view piece = bytes.substr(0, std::min(wanted, left_));
      bytes.remove_prefix(piece.size());
      left_ -= piece.size();
      if (part_left_ > 0) {
        part_left_ -= piece.size();
      } else {
        tag_ += piece;
        if (tag_.size() == kTagBytes) start_part();
      }
    }
  }

  bool is_complete() const { return left_ == 0; }

 private:
  void start_part() {
    const bool is_in_tag = number_at(tag_, 0, is_little_) >> 16 != 0;  // its few bytes are
    const size_t length = is_in_tag ? 0 : number_at(tag_, 4, is_little_);
    if (length > left_) builder_.fail("has a matrix with a part that is longer than itself");
    part_left_ = (length + kTagBytes - 1) / kTagBytes * kTagBytes;
    tag_.clear();
  }

  const GroundTruthBuilder& builder_;
  size_t left_ = 0;  ///< bytes of the matrix that have not come
  bool is_little_ = true;
  std::string tag_;       ///< as much as has come of that of the next part
  size_t part_left_ = 0;  ///< bytes of the part, and of what fills it up, that have not come
};

/// What zlib packed, piece by piece.
class Inflater {
 public:
  explicit Inflater(std::string_view packed) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream_.avail_in = static_cast<uInt>(packed.size());  // an element has less than 4 GiB
    if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  /// Empty at the end, or where something is wrong.
  std::string_view next() {
    stream_.next_out = reinterpret_cast<Bytef*>(chunk_.data());
    stream_.avail_out = static_cast<uInt>(chunk_.size());
    if (state_ == Z_OK) state_ = inflate(&stream_, Z_NO_FLUSH);
    return {chunk_.data(), chunk_.size() - stream_.avail_out};
  }

 private:
  z_stream stream_ = {};
  int state_ = Z_OK;
  std::array<char, kChunkBytes> chunk_;
};

// An element with its tag, which is all that is packed. The library passes over what is no matrix.
void require_packed(const GroundTruthBuilder& builder, std::string_view packed, bool is_little) {
  Inflater inflater(packed);
  std::string tag;
  std::optional<PartWalk> walk;
  for (std::string_view bytes = inflater.next(); !bytes.empty(); bytes = inflater.next()) {
    builder.check_stop();
    if (!walk) {
      const std::string_view piece = bytes.substr(0, kTagBytes - tag.size());
      tag += piece;
      bytes.remove_prefix(piece.size());
      if (tag.size() < kTagBytes) continue;
      if (number_at(tag, 0, is_little) != kMatrix) return;
      walk.emplace(builder, number_at(tag, 4, is_little), is_little);
    }
    walk->feed(bytes);
  }
  if (!walk || !walk->is_complete())
    builder.fail("has a packed matrix that is damaged or cut off");
}

}  // namespace

void require_whole_elements(const GroundTruthBuilder& builder, std::string_view bytes) {
  if (bytes.starts_with(kVersion73)) return;
  // Any bytes may be of version 4, where the library believes what is claimed.
  if (!bytes.starts_with(kVersion5))
    builder.fail("is no MAT-file of version 5 to 7.3; save it anew in MATLAB");
  const bool is_little = bytes.size() >= kHeaderBytes && bytes[kHeaderBytes - 2] == 'I';
  size_t at = kHeaderBytes;
  while (at + kTagBytes <= bytes.size()) {
    const uint32_t type = number_at(bytes, at, is_little);
    const size_t length = number_at(bytes, at + 4, is_little);
    const std::string_view element = bytes.substr(at + kTagBytes, length);
    at += kTagBytes + length;
    if (at > bytes.size()) break;
    if (type == kMatrix) PartWalk(builder, length, is_little).feed(element);
    if (type == kCompressed) require_packed(builder, element, is_little);
  }
  if (at != bytes.size()) builder.fail("is cut off, or has bytes that belong to nothing");
}

bool begins_as_mat_file(std::string_view bytes) {
  return bytes.starts_with(kVersion5) || bytes.starts_with(kVersion73);
}

}  // namespace vpr
