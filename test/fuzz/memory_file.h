// A file that exists only in memory, for readers that want a path.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace vpr::fuzz {

/// The path of the process's one such file, now with these bytes.
std::filesystem::path memory_file(const uint8_t* data, size_t size);

}  // namespace vpr::fuzz
