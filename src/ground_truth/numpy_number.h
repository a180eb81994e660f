// Numbers as NumPy arrays hold them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace vpr {

/// Bytes of a number of a type ("i8", "u2", "b1", "f8"); 0 for a type that is not known here.
size_t numpy_number_size(std::string_view type);

/// The little-endian number at `bytes`; nothing if it isn't whole, or too large.
std::optional<int64_t> load_numpy_number(std::string_view type, const char* bytes);

/// A real number that is whole, up to 2^53.
std::optional<int64_t> whole_number_of(double value);

}  // namespace vpr
