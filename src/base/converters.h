// Formats of other programs that a script of scripts/convert turns into one that programs read.
#pragma once

#include <filesystem>
#include <string_view>

namespace vpr {

/// Throws Error(usage), naming the script, if `start`, the first bytes of the file, or its
/// extension is that of a format that a script reads. `arrays_only`: only formats that hold any
/// arrays.
void refuse_unconverted(const std::filesystem::path& path, std::string_view start,
                        bool arrays_only = false);

/// Throws Error(usage), naming the script, if a script reads this format.
void refuse_unconverted_format(std::string_view format);

}  // namespace vpr
