#include "matching/codes.h"

#include <cstring>

namespace vpr {
namespace {

// Appends the stretches of [0, count) between unreadable frames.
void append_runs(std::vector<FrameRun>& runs, size_t first, size_t sequence, const CodeSpan& span) {
  size_t start = 0;
  const auto close = [&](size_t end) {
    if (end > start) runs.push_back({first + start, end - start, sequence, start});
    start = end + 1;
  };
  for (const size_t frame : span.unreadable) close(frame);
  close(span.codes.size());
}

}  // namespace

CodeWords code_words(const LdbCode& code) {
  CodeWords words;
  static_assert(sizeof(words) == sizeof(code));
  std::memcpy(words.data(), code.data(), sizeof(words));
  for (size_t w = 1; w < kCodeWords; ++w) words[w] ^= words[w - 1];
  return words;
}

std::vector<FrameRun> readable_runs(const CodeSpan& sequence) {
  std::vector<FrameRun> runs;
  append_runs(runs, 0, 0, sequence);
  return runs;
}

TrainCodes make_train_codes(std::span<const CodeSpan> sequences) {
  TrainCodes train;
  train.sequences.assign(sequences.begin(), sequences.end());
  for (size_t s = 0; s < sequences.size(); ++s) {
    append_runs(train.runs, train.frame_count, s, sequences[s]);
    train.frame_count += sequences[s].codes.size();
  }
  train.blocks.resize((train.frame_count + kBlockFrames - 1) / kBlockFrames);
  size_t frame = 0;
  for (const CodeSpan& sequence : sequences) {
    for (const LdbCode& code : sequence.codes) {
      const CodeWords words = code_words(code);
      CodeBlock& block = train.blocks[frame / kBlockFrames];
      for (size_t w = 0; w < kCodeWords; ++w) block.words[w][frame % kBlockFrames] = words[w];
      ++frame;
    }
  }
  return train;
}

QueryCodes make_query_codes(const CodeSpan& sequence) {
  QueryCodes query;
  query.codes = sequence.codes;
  query.words.reserve(sequence.codes.size());
  for (const LdbCode& code : sequence.codes) query.words.push_back(code_words(code));
  append_runs(query.runs, 0, 0, sequence);
  return query;
}

size_t count_windows(std::span<const FrameRun> runs, size_t window_length) {
  size_t windows = 0;
  for (const FrameRun& run : runs) windows += run.windows(window_length);
  return windows;
}

}  // namespace vpr
