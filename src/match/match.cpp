#include "match/match.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "base/named_table.h"
#include "base/parallel.h"
#include "match/fastable.h"
#include "match/filter_track.h"
#include "match/lsh.h"
#include "match/row_kernels.h"

namespace vpr {

namespace {

constexpr size_t kChunkFrames = 4096;  // descriptors of a chunk stay in the second-level cache

// The first run that ends after `frame`.
std::vector<FrameStretch>::const_iterator run_from(const std::vector<FrameStretch>& runs,
                                                   size_t frame) {
  return std::partition_point(runs.begin(), runs.end(), [&](const FrameStretch& run) {
    return run.first + run.count <= frame;
  });
}

// Sums of the windows that end at train frames first and on, for the query window that ends at row
// query_end.
void window_sums(const FrameDistances& distances, size_t window_length, size_t query_end,
                 size_t first, std::span<uint32_t> sums) {
  const size_t last = first + sums.size();
  std::vector<uint16_t> row;
  for (size_t back = 0; back < window_length; ++back) {
    // No window contains frames before the first one: whole_row omits these sums.
    const size_t from = std::max(first, back);
    if (from >= last) break;
    const size_t begin = (from - back) / kBlockFrames * kBlockFrames;
    row.resize(last - back - begin + kBlockFrames);
    const auto query = static_cast<uint32_t>(query_end - back);
    distances.tile({&query, 1}, begin, last - back, row.data(), 0);
    add_to_sums(sums.subspan(from - first), row.data() + (from - back - begin));
  }
}

// OpenABLE: every cell costs window_length frame distances. Threads share a row.
WindowStage openable_stage([[maybe_unused]] const FrameDistances& distances,
                           std::span<const size_t> window_lengths, const MatchSettings& settings) {
  assert(!distances.is_in_order());
  return [lengths = std::vector(window_lengths.begin(), window_lengths.end()), settings](
             const FrameDistances& rows, const QueryFrame& frame, const StageConsumer& consume) {
    const size_t frames = rows.train_frames;
    const size_t part = std::min(round_up(frames / thread_count() + 1, kBlockFrames), kChunkFrames);
    for (size_t l = 0; l < lengths.size(); ++l) {
      if (frame.consecutive_readable < lengths[l]) continue;
      std::vector<uint32_t> sums(frames);
      parallel_for(divide_up(frames, part), {}, [&](size_t p) {
        const size_t first = p * part;
        window_sums(rows, lengths[l], frame.row, first,
                    std::span(sums).subspan(first, std::min(part, frames - first)));
      });
      const std::vector<ScoreRow> row = whole_row(rows, lengths[l], frame.number, sums);
      if (!row.empty()) consume(l, row);
    }
  };
}

void match_by_hashes(const FrameDistances& distances, std::span<const size_t>,
                     const MatchSettings& settings, const Monitor& monitor,
                     const LengthRowConsumer& consume) {
  match_lsh(distances, settings, monitor, [&](const ScoreRow& piece) { consume(0, piece); });
}

constexpr std::array<SequenceMethod, 5> kMethods = {{
    {"fastable", "reuses distances between rows", false, match_strips, fastable_stage},
    {"fastable-online", "as fastable, and always one query frame after the other, as on a phone",
     false, nullptr, fastable_stage},
    {"openable", "every window distance by definition (slow)", false, nullptr, openable_stage},
    {"filter",
     "follows a path at any speed close to the trained one; accepts matches that the path "
     "confirms",
     true, nullptr, filter_stage},
    {kLshMethod, "approximate hashing: some of the near windows", false, match_by_hashes, nullptr},
}};

}  // namespace

ScoreRow part_of_row(const ScoreRow& row, size_t first, size_t count) {
  ScoreRow part = row;
  part.train_window += first;
  part.scores = row.scores.subspan(first, count);
  return part;
}

void emit_row(const FrameDistances& frames, size_t window_length, size_t query_end, size_t first,
              std::span<const uint32_t> sums, const RowConsumer& consume) {
  const size_t known = frames.past.empty() ? frames.train_frames : frames.past[query_end];
  const size_t end = std::min(first + sums.size(), known);
  for (auto run = run_from(frames.train_runs, first);
       run != frames.train_runs.end() && run->first < end; ++run) {
    const size_t from = std::max(first, run->first + window_length - 1);
    const size_t to = std::min(end, run->first + run->count);
    if (from >= to) continue;
    consume({query_end + 1 - window_length, run->sequence,
             run->first_in_sequence + (from + 1 - window_length - run->first),
             sums.subspan(from - first, to - from)});
  }
}

std::vector<ScoreRow> whole_row(const FrameDistances& frames, size_t window_length,
                                size_t query_end, std::span<const uint32_t> sums) {
  std::vector<ScoreRow> row;
  emit_row(frames, window_length, query_end, 0, sums,
           [&](const ScoreRow& piece) { row.push_back(piece); });
  return row;
}

bool ends_window(const FrameDistances& frames, size_t window_length, size_t frame) {
  const auto run = run_from(frames.query_runs, frame);
  return run != frames.query_runs.end() && frame + 1 >= run->first + window_length;
}

std::optional<size_t> least_lag(const FrameDistances& frames) {
  if (frames.past.empty()) return std::nullopt;
  size_t least = frames.query_frames;
  for (size_t query = 0; query < frames.query_frames; ++query)
    if (frames.past[query] > 0) least = std::min(least, query + 1 - frames.past[query]);
  return least;
}

std::span<const SequenceMethod> sequence_methods() { return kMethods; }

std::span<const SequenceMethod> exact_methods() {
  const auto first_other = std::ranges::find_if(
      kMethods, [](const SequenceMethod& m) { return m.has_paths || m.is_approximate(); });
  return {kMethods.begin(), first_other};
}

const SequenceMethod& find_sequence_method(std::string_view name) {
  return find_named(kMethods, "method", name);
}

WindowStage window_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                         const MatchSettings& settings) {
  assert(!settings.method->is_approximate());
  return settings.method->stage(distances, window_lengths, settings);
}

void match(const FrameDistances& distances, const MatchSettings& settings,
           std::span<const Pass> passes, const Monitor& monitor) {
  std::vector<size_t> lengths;
  for (const Pass& pass : passes) lengths.push_back(pass.window_length);
  assert(std::ranges::all_of(
      lengths, [](size_t length) { return length >= 1 && length <= kMaxWindowLength; }));
  if (std::ranges::none_of(lengths, [&](size_t length) {
        return count_windows(distances.train_runs, length) > 0 &&
               count_windows(distances.query_runs, length) > 0;
      }))
    return;
  // Pieces of a whole query arrive in any order and from several threads: no sink may need rows.
  const SequenceMethod& method = *settings.method;
  const bool needs_rows =
      distances.is_in_order() ||
      std::ranges::any_of(passes, [](const Pass& pass) { return !pass.sinks.rows.empty(); });
  if (method.match_whole != nullptr && (!needs_rows || method.is_approximate()))
    return method.match_whole(distances, lengths, settings, monitor,
                              [&](size_t length, const ScoreRow& piece) {
                                for (const RowConsumer& consume : passes[length].sinks.pieces)
                                  consume(piece);
                              });
  const WindowStage stage = window_stage(distances, lengths, settings);
  const std::vector<uint8_t> readable =
      readable_flags(distances.query_runs, distances.query_frames);
  StepCounter counter(monitor, "match", distances.query_frames);
  size_t consecutive_readable = 0;
  for (size_t frame = 0; frame < distances.query_frames; ++frame) {
    check_stop(monitor);
    consecutive_readable = readable[frame] != 0 ? consecutive_readable + 1 : 0;
    stage(distances, {frame, frame, consecutive_readable},
          [&](size_t length, std::span<const ScoreRow> row) {
            const Sinks& sinks = passes[length].sinks;
            for (const RowConsumer& consume : sinks.pieces)
              for (const ScoreRow& piece : row) consume(piece);
            for (const WholeRowConsumer& consume : sinks.rows) consume(row);
          });
    counter.add();
  }
}

void match(const FrameDistances& distances, const MatchSettings& settings, const Sinks& sinks,
           const Monitor& monitor) {
  const Pass pass{settings.window_length, sinks};
  match(distances, settings, {&pass, 1}, monitor);
}

}  // namespace vpr
