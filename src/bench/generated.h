// Data to time with where no recording is given.
#pragma once

#include <cstdint>
#include <vector>

#include "describe/descriptor_rows.h"
#include "describe/ldb.h"
#include "fabmap/vocabulary.h"

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

/// Vectors as imported ones are stored.
struct GeneratedVectors {
  DescriptorShape shape;
  std::vector<uint8_t> bytes;

  DescriptorRows rows() const { return {shape, bytes}; }
};

/// A walk in which each vector is near the one before, and, of another seed, the same walk from
/// frame `first` on with other noise. Numbers have `bits` bits, 16 or 8.
GeneratedVectors generate_vectors(size_t count, size_t length, size_t bits, uint64_t seed,
                                  uint64_t noise_seed, size_t first = 0);

/// A grey 640x480 picture with edges, corners and soft shading: panels, lines, lamps.
cv::Mat generate_frame(uint64_t seed);

/// About `per_frame` words, drawn evenly.
WordSet generate_words(size_t words, size_t per_frame, uint64_t seed);

}  // namespace vpr
