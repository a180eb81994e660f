// Numbers with their nouns, as people say them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace vpr {

/// "1 hit", "2 hits", "0 hits". `plural`: of nouns that take more than an s.
std::string counted(uint64_t count, std::string_view noun, std::string_view plural = {});

}  // namespace vpr
