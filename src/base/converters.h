// File formats that the programs do not read, and the scripts in scripts/convert that convert them.
#pragma once

#include <filesystem>
#include <string_view>

namespace vpr {

/// Throws Error(usage) with the name of the script if `start`, the first bytes of the file, or the
/// extension belongs to a format that a script converts. `arrays_only`: check only formats that
/// hold arrays of any kind.
void refuse_convertible(const std::filesystem::path& path, std::string_view start,
                        bool arrays_only = false);

/// Throws Error(usage) with the name of the script if a script converts this format.
void refuse_convertible_format(std::string_view format);

}  // namespace vpr
