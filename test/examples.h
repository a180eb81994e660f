// Codes of several sequences for tests of matchers, queries and sweeps.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "database/descriptor_rows.h"
#include "database/frame_descriptors.h"
#include "database/sequence_database.h"

namespace vpr::test {

using CellKey = std::tuple<size_t, size_t, size_t>;  ///< query window, sequence, train window
using Cells = std::map<CellKey, uint32_t>;

struct Example {
  std::vector<std::vector<LdbCode>> train;
  std::vector<std::vector<size_t>> train_unreadable;
  std::vector<LdbCode> query;
  std::vector<size_t> query_unreadable;

  std::vector<DescribedFrames> spans() const;
};

/// Sequences with these numbers of frames; every frame is readable.
Example make_example(const std::vector<size_t>& train_frames, size_t query_frames, uint64_t seed);

/// A database of sequences "a", "b", ..., whose frames are named by their numbers; it has neither
/// thresholds nor statistics.
SequenceDatabase make_database(const std::vector<std::vector<LdbCode>>& sequences);

/// A query whose frames are named by their numbers.
DescriptorSet make_query(const std::vector<LdbCode>& codes);

/// All window pairs of two sequences, row-major, query windows x training windows; empty if either
/// sequence is shorter than a window. OpenABLE: window_length distances per cell.
std::vector<uint32_t> reference_openable(const DescriptorRows& train, const DescriptorRows& query,
                                         size_t window_length);

/// The same matrix by FastABLE's recurrence, two distances per cell (paper, section VII).
std::vector<uint32_t> reference_fastable(const DescriptorRows& train, const DescriptorRows& query,
                                         size_t window_length);

}  // namespace vpr::test
