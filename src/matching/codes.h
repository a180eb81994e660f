// Codes in the layouts that the Hamming kernels read, and the stretches in which windows may lie.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "descriptors/ldb.h"

namespace vpr {

inline constexpr size_t kCodeWords = kLdbBytes / 8;
inline constexpr size_t kBlockFrames = 8;

/// A code as the kernels take it: word w holds the prefix parity code[0] ^ ... ^ code[w]. Hamming
/// distances of codes can be computed from them with fewer operations (see hamming_kernels.cpp).
using CodeWords = std::array<uint64_t, kCodeWords>;

/// Eight frames, word by word, so that a SIMD lane is a frame and nothing is summed across lanes.
struct alignas(64) CodeBlock {
  std::array<std::array<uint64_t, kBlockFrames>, kCodeWords> words;
};

/// Readable frames in a row, of one sequence. Windows lie within a run and never cross its end: an
/// unreadable frame, like the end of a sequence, ends a run.
struct FrameRun {
  size_t first = 0;  ///< among all frames of the set
  size_t count = 0;
  size_t sequence = 0;
  size_t first_in_sequence = 0;

  size_t windows(size_t window_length) const {
    return count < window_length ? 0 : count - window_length + 1;
  }
};

/// What one sequence adds to a set: its codes and the frames among them that were unreadable.
struct CodeSpan {
  std::span<const LdbCode> codes;
  std::span<const size_t> unreadable;  ///< rising
};

/// The frames of one or more sequences, one after the other. Only `runs` says where a sequence
/// ends.
struct TrainCodes {
  std::vector<CodeBlock> blocks;  ///< padded with zero codes to whole blocks
  size_t frame_count = 0;
  std::vector<FrameRun> runs;       ///< rising
  std::vector<CodeSpan> sequences;  ///< as given: somebody else's
};

struct QueryCodes {
  std::vector<CodeWords> words;
  std::vector<FrameRun> runs;
  std::span<const LdbCode> codes;  ///< as given: somebody else's
};

TrainCodes make_train_codes(std::span<const CodeSpan> sequences);
QueryCodes make_query_codes(const CodeSpan& sequence);

/// The stretches of one sequence between its unreadable frames.
std::vector<FrameRun> readable_runs(const CodeSpan& sequence);

CodeWords code_words(const LdbCode& code);

/// Windows of `window_length` frames in all runs; 0 where every run is shorter.
size_t count_windows(std::span<const FrameRun> runs, size_t window_length);

}  // namespace vpr
