#include "match/methods.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/parallel.h"
#include "match/fastable_batch.h"
#include "match/fastable_online.h"
#include "match/match_filter.h"

namespace vpr {

namespace {

constexpr std::array<SequenceMethod, 4> kMethods = {{
    {"fastable", "distances re-used from row to row, the whole query at once", true, true, false,
     match_fastable},
    {"fastable-online", "the same, one query frame after the other as on a phone", true, true,
     false, match_fastable_online},
    {"openable", "every window distance by its definition (slow)", false, false, false,
     match_openable},
    {"filter", "a path through frames at any pace, believed once it was followed for a while", true,
     false, true, match_filter},
}};

constexpr size_t kChunkFrames = 4096;  // descriptors of a chunk stay in the second-level cache

// Sums of the windows that end at train frames [first, last), for the query window ending at
// query_end.
void window_sums(const FrameDistances& distances, const MatchSettings& settings, size_t query_end,
                 size_t first, size_t last, std::vector<uint32_t>& sums,
                 std::vector<uint16_t>& row) {
  sums.assign(last - first, 0);
  for (size_t back = 0; back < settings.window_length; ++back) {
    // Frames before the first one belong to no window: emit_row leaves those sums out.
    const size_t from = first < back ? back : first;
    if (from >= last) break;
    const size_t begin = (from - back) / kStretchFrames * kStretchFrames;
    row.resize(last - back - begin + kStretchFrames);
    const auto query = static_cast<uint32_t>(query_end - back);
    distances.tile({&query, 1}, begin, last - back, row.data(), 0);
    settings.kernels.accumulate(sums.data() + (from - first), row.data() + (from - back - begin),
                                last - from);
  }
}

}  // namespace

std::span<const SequenceMethod> sequence_methods() { return kMethods; }

const SequenceMethod& find_sequence_method(std::string_view name) {
  return find_named(kMethods, "method", name);
}

bool has_paths(std::string_view method) {
  return std::any_of(kMethods.begin(), kMethods.end(),
                     [&](const SequenceMethod& m) { return m.name == method && m.has_paths; });
}

void match_openable(const FrameDistances& distances, const MatchSettings& settings,
                    const Monitor& monitor, const RowConsumer& consume) {
  assert(!distances.is_in_order());
  StepCounter counter(monitor, "match", distances.query_frames);
  parallel_for(distances.query_frames, monitor, [&](size_t query_end) {
    if (ends_window(distances, settings.window_length, query_end)) {
      std::vector<uint32_t> sums;
      std::vector<uint16_t> row;
      for (size_t first = 0; first < distances.train_frames; first += kChunkFrames) {
        const size_t last = std::min(first + kChunkFrames, distances.train_frames);
        window_sums(distances, settings, query_end, first, last, sums, row);
        emit_row(distances, settings.window_length, query_end, first, sums, consume);
      }
    }
    counter.add();
  });
}

}  // namespace vpr
