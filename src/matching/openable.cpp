#include "matching/openable.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"

namespace vpr {
namespace {

constexpr size_t kChunkFrames = 4096;  // codes of a chunk stay in the second-level cache

// Sums of the windows that end at train frames [first, last), for the query window ending at
// query_end.
void window_sums(const TrainCodes& train, const QueryCodes& query, const MatchSettings& settings,
                 size_t query_end, size_t first, size_t last, std::vector<uint32_t>& sums,
                 std::vector<uint16_t>& distances) {
  sums.assign(last - first, 0);
  for (size_t back = 0; back < settings.window_length; ++back) {
    // Frames before the first one belong to no window: emit_row leaves those sums out.
    const size_t from = first < back ? back : first;
    if (from >= last) break;
    const size_t block = (from - back) / kBlockFrames;
    const size_t end_block = (last - back + kBlockFrames - 1) / kBlockFrames;
    distances.resize((end_block - block) * kBlockFrames);
    settings.kernels.row_distances(query.words[query_end - back], train.blocks.data() + block,
                                   end_block - block, distances.data());
    settings.kernels.accumulate(sums.data() + (from - first),
                                distances.data() + (from - back - block * kBlockFrames),
                                last - from);
  }
}

}  // namespace

void match_openable(const TrainCodes& train, const QueryCodes& query, const MatchSettings& settings,
                    const Monitor& monitor, const RowConsumer& consume) {
  StepCounter counter(monitor, "match", query.words.size());
  parallel_for(query.words.size(), monitor, [&](size_t query_end) {
    if (ends_window(query, settings.window_length, query_end)) {
      std::vector<uint32_t> sums;
      std::vector<uint16_t> distances;
      for (size_t first = 0; first < train.frame_count; first += kChunkFrames) {
        const size_t last = std::min(first + kChunkFrames, train.frame_count);
        window_sums(train, query, settings, query_end, first, last, sums, distances);
        emit_row(train, settings.window_length, query_end, first, sums, consume);
      }
    }
    counter.add();
  });
}

}  // namespace vpr
