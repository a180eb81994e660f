// The visual words of a frame.
#pragma once

#include <cstdint>
#include <vector>

namespace vpr {

/// Word ids, rising, each once: what a frame or view shows.
using WordSet = std::vector<uint32_t>;

}  // namespace vpr
