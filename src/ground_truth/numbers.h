// Numbers in text files, as strict as they can be.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace vpr {

/// The frame that `text` names: digits, maybe after a minus. Nothing if it is no whole number.
struct FrameText {
  bool in_range = false;  ///< neither negative nor too large for 64 bits
  size_t value = 0;
};
std::optional<FrameText> parse_frame(std::string_view text);

/// A finite number with a decimal point, for every locale; a leading + is allowed. Nothing
/// otherwise.
std::optional<double> parse_real(std::string_view text);

/// The cells of a line, divided by commas, blanks around them left out, or by blanks where the line
/// has no comma.
std::vector<std::string_view> cells_of(std::string_view line);

}  // namespace vpr
