// Data to time with where no recording is given.
#pragma once

#include <cstdint>
#include <vector>

#include "descriptors/ldb.h"
#include "descriptors/vocabulary.h"

namespace cv {
class Mat;
}

namespace vpr {

/// Codes of a walk: each differs from the one before in about 60 of its bits, as neighbouring
/// frames of real recordings do.
std::vector<LdbCode> generate_walk(size_t count, uint64_t seed);

/// `count` codes from `first` on, each with `changed_bits` bits drawn and flipped: the same walk on
/// another day.
std::vector<LdbCode> walk_again(const std::vector<LdbCode>& walk, size_t first, size_t count,
                                size_t changed_bits, uint64_t seed);

/// A grey 640x480 picture with edges, corners and soft shading: panels, lines, lamps.
cv::Mat generate_frame(uint64_t seed);

/// About `per_frame` words, drawn evenly.
WordSet generate_words(size_t words, size_t per_frame, uint64_t seed);

}  // namespace vpr
