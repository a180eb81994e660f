// What a database is for: the family of methods that it serves.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>

#include "base/enum_names.h"

namespace vpr {

class Archive;

enum class DatabaseFamily { sequences, fabmap };
/// As manifests and vpr-train name them.
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<DatabaseFamily> = {"fastable",
                                                                               "fabmap"};

/// Reads the manifest only. Throws Error(input) if it is missing, Error(data) if it is damaged, or
/// of a family that is not known.
DatabaseFamily database_family(const std::filesystem::path& path);

/// Throws Error(data) unless the database is of this family.
void require_family(const Archive& archive, DatabaseFamily family);

}  // namespace vpr
