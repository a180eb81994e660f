// Generated data for benchmarks without a recording.
#pragma once

#include <cstdint>
#include <vector>

#include "database/descriptor_rows.h"
#include "fabmap/vocabulary.h"

namespace cv {
class Mat;
}

namespace vpr {

/// Codes of a sequence: consecutive codes differ in about 60 bits, like neighboring frames of real
/// recordings.
std::vector<LdbCode> generate_sequence(size_t count, uint64_t seed);

/// `count` codes from `first` on, each with `changed_bits` randomly chosen bits flipped: the same
/// route on another day.
std::vector<LdbCode> repeat_sequence(const std::vector<LdbCode>& walk, size_t first, size_t count,
                                     size_t changed_bits, uint64_t seed);

/// Vectors in the format of imported ones.
struct GeneratedVectors {
  DescriptorShape shape;
  std::vector<uint8_t> bytes;

  DescriptorRows rows() const { return {shape, bytes}; }
};

/// A sequence in which each vector is close to its predecessor, or, for another seed, the same
/// sequence from frame `first` on with other noise. Values have `bits` bits, 16 or 8.
GeneratedVectors generate_vectors(size_t count, size_t length, size_t bits, uint64_t seed,
                                  uint64_t noise_seed, size_t first = 0);

/// A gray 640x480 image with edges, corners and soft shading: panels, lines, lamps.
cv::Mat generate_frame(uint64_t seed);

/// About `per_frame` words, drawn uniformly.
WordSet generate_words(size_t words, size_t per_frame, uint64_t seed);

}  // namespace vpr
