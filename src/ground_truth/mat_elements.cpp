#include "ground_truth/mat_elements.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <new>
#include <string>

#include <zlib.h>

namespace vpr {
namespace {

constexpr std::string_view kVersion5 = "MATLAB 5.0 MAT-file";
constexpr std::string_view kVersion73 = "MATLAB 7.3 MAT-file";
constexpr size_t kHeaderBytes = 128;
constexpr char kElements = 1;  // the upper byte of the version, which the library goes by
constexpr char kHdf5 = 2;
constexpr size_t kTagBytes = 8;
constexpr uint32_t kMatrix = 14;  // types of elements
constexpr uint32_t kPacked = 15;
constexpr uint32_t kFlags = 6;     // numbers of four bytes, without a sign
constexpr uint32_t kShape = 5;     // and with one
constexpr uint8_t kStructure = 2;  // kinds of matrices
constexpr uint8_t kObject = 3;
constexpr uint8_t kSparse = 5;
constexpr uint8_t kLastKind = 15;  // of those that have a shape
constexpr size_t kMostShapeBytes = 256;
constexpr size_t kMostNested = 64;
constexpr size_t kPieceBytes = 1 << 16;

/// Bytes that are read once, from the first to the last.
class Bytes {
 public:
  explicit Bytes(const GroundTruthBuilder& builder) : builder_(builder) {}
  Bytes(const Bytes&) = delete;
  Bytes& operator=(const Bytes&) = delete;
  virtual ~Bytes() = default;

  const GroundTruthBuilder& builder() const { return builder_; }

  std::string read(size_t count) {
    std::string text;
    pass(count, [&](std::string_view piece) { text += piece; });
    return text;
  }
  void skip(size_t count) {
    pass(count, [](std::string_view) {});
  }

 private:
  /// At least one byte and at most `count`, or none at the end.
  virtual std::string_view next(size_t count) = 0;

  template <class Use>
  void pass(size_t count, Use&& use) {
    while (count > 0) {
      const std::string_view piece = next(count);
      if (piece.empty()) builder_.fail("has a matrix that is damaged or cut off");
      use(piece);
      count -= piece.size();
    }
  }

  const GroundTruthBuilder& builder_;
};

class PlainBytes : public Bytes {
 public:
  PlainBytes(const GroundTruthBuilder& builder, std::string_view text)
      : Bytes(builder), text_(text) {}

 private:
  std::string_view next(size_t count) override {
    const std::string_view piece = text_.substr(0, count);
    text_.remove_prefix(piece.size());
    return piece;
  }

  std::string_view text_;
};

/// What zlib packed.
class PackedBytes : public Bytes {
 public:
  PackedBytes(const GroundTruthBuilder& builder, std::string_view packed) : Bytes(builder) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream_.avail_in = static_cast<uInt>(packed.size());  // an element has less than 4 GiB
    if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
  }
  ~PackedBytes() override { inflateEnd(&stream_); }

 private:
  std::string_view next(size_t count) override {
    builder().check_stop();
    stream_.next_out = reinterpret_cast<Bytef*>(piece_.data());
    stream_.avail_out = static_cast<uInt>(std::min(count, piece_.size()));
    inflate(&stream_, Z_NO_FLUSH);  // what is wrong gives no bytes
    return {piece_.data(),
            static_cast<size_t>(reinterpret_cast<char*>(stream_.next_out) - piece_.data())};
  }

  z_stream stream_ = {};
  std::array<char, kPieceBytes> piece_;
};

uint32_t number_at(std::string_view bytes, size_t at, bool is_little) {
  uint32_t number = 0;
  for (size_t i = 0; i < 4 && at + i < bytes.size(); ++i)
    number |= uint32_t{static_cast<uint8_t>(bytes[at + i])} << 8 * (is_little ? i : 3 - i);
  return number;
}

// Numbers, texts and matrices. Of others the library takes other lengths than they state.
bool is_known_type(uint32_t type) {
  return (type >= 1 && type <= 7) || type == 9 || (type >= 12 && type <= 18 && type != kPacked);
}

/// What a matrix says of itself before its values.
struct Claims {
  uint8_t kind = 0;
  uint64_t values = 1;      ///< 2^32 or more: too many
  uint64_t name_bytes = 0;  ///< of each field of a structure
};

uint64_t product_of(std::string_view shape, bool is_little) {
  uint64_t product = 1;
  for (size_t at = 0; at + 4 <= shape.size(); at += 4) {
    if (product >> 32 == 0) product *= number_at(shape, at, is_little);
    if (number_at(shape, at, is_little) == 0) return 0;
  }
  return product;
}

/// The parts of a matrix: flags, shape, name, and of a structure the length and the names of its
/// fields; then values, which may be matrices. A value is a byte at least.
class MatrixCheck {
 public:
  MatrixCheck(Bytes& bytes, bool is_little) : bytes_(bytes), is_little_(is_little) {}

  void require(size_t length, size_t depth = 0) {
    if (depth > kMostNested) bytes_.builder().fail("has matrices in matrices without end");
    Claims claims;
    size_t left = length;
    for (size_t part = 0; left >= kTagBytes; ++part) {
      const std::string tag = bytes_.read(kTagBytes);
      left -= kTagBytes;
      const uint32_t type = number_at(tag, 0, is_little_);
      const bool is_in_tag = type >> 16 != 0;  // its few bytes are
      const size_t size = is_in_tag ? 0 : number_at(tag, 4, is_little_);
      if (size > left || type >> 16 > 4) fail_of_length();
      if ((part == 0 && (type != kFlags || size != kTagBytes)) ||
          (part == 1 && (type & 0xffff) != kShape))
        bytes_.builder().fail("has a matrix that does not begin as one");
      if (!is_known_type(type & 0xffff))
        bytes_.builder().fail("has a matrix with a part of an unknown type");
      const size_t whole = std::min((size + kTagBytes - 1) / kTagBytes * kTagBytes, left);
      left -= whole;
      if (part == 4) require_fields(claims, is_in_tag ? type >> 16 : size, length);
      if (part > 2 && type == kMatrix) {
        require(size, depth + 1);
        bytes_.skip(whole - size);
        continue;
      }
      const std::string content =
          is_in_tag ? tag.substr(4) : bytes_.read(part < 4 ? std::min(size, kMostShapeBytes) : 0);
      bytes_.skip(is_in_tag ? 0 : whole - content.size());
      take(claims, part, content, size, left);
    }
    bytes_.skip(left);
  }

 private:
  void fail_of_length() const {
    bytes_.builder().fail("has a matrix with a part that is longer than itself");
  }

  void take(Claims& claims, size_t part, const std::string& content, size_t size, size_t left) {
    if (part == 0) claims.kind = static_cast<uint8_t>(number_at(content, 0, is_little_));
    if (part == 1) {
      if (size > kMostShapeBytes) bytes_.builder().fail("has a matrix of too many dimensions");
      claims.values = product_of(content, is_little_);
      if (claims.kind != kSparse && claims.kind <= kLastKind && claims.values > left)
        fail_of_length();
    }
    if (part == 3) claims.name_bytes = number_at(content, 0, is_little_);
  }

  /// The library has room made for each field of each structure.
  void require_fields(const Claims& claims, size_t names, size_t length) const {
    if (claims.kind != kStructure && claims.kind != kObject) return;
    if (claims.name_bytes == 0) {
      if (names > 0) fail_of_length();
      return;
    }
    if (claims.values * (names / claims.name_bytes) > length) fail_of_length();
  }

  Bytes& bytes_;
  bool is_little_ = true;
};

// An element with its tag, which is all that is packed. The library passes over what is no matrix.
void require_packed(const GroundTruthBuilder& builder, std::string_view packed, bool is_little) {
  PackedBytes bytes(builder, packed);
  const std::string tag = bytes.read(kTagBytes);
  if (number_at(tag, 0, is_little) == kMatrix)
    MatrixCheck(bytes, is_little).require(number_at(tag, 4, is_little));
}

void require_plain(const GroundTruthBuilder& builder, std::string_view element, bool is_little) {
  PlainBytes bytes(builder, element);
  MatrixCheck(bytes, is_little).require(element.size());
}

}  // namespace

void require_whole_elements(const GroundTruthBuilder& builder, std::string_view bytes) {
  // Any other bytes may be of version 4, where the library believes what is claimed.
  const bool is_mat = begins_as_mat_file(bytes) && bytes.size() >= kHeaderBytes;
  const bool is_little = is_mat && bytes[kHeaderBytes - 2] == 'I';
  const char version = is_mat ? bytes[kHeaderBytes - (is_little ? 3 : 4)] : '\0';
  if (version == kHdf5) return;
  if (version != kElements)
    builder.fail("is no MAT-file of version 5 to 7.3; save it anew in MATLAB");
  size_t at = kHeaderBytes;
  while (at + kTagBytes <= bytes.size()) {
    const uint32_t type = number_at(bytes, at, is_little);
    const size_t length = number_at(bytes, at + 4, is_little);
    if (length > bytes.size() - at - kTagBytes) break;
    const std::string_view element = bytes.substr(at + kTagBytes, length);
    if (type == kMatrix) require_plain(builder, element, is_little);
    if (type == kPacked) require_packed(builder, element, is_little);
    at += kTagBytes + length;
  }
  if (at != bytes.size()) builder.fail("is cut off, or has bytes that belong to nothing");
}

bool begins_as_mat_file(std::string_view bytes) {
  return bytes.starts_with(kVersion5) || bytes.starts_with(kVersion73);
}

}  // namespace vpr
