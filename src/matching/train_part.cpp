#include "matching/train_part.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace vpr {
namespace {

// What two ranges have in common; empty ranges begin where `a` does.
ItemRange overlap(const ItemRange& a, const ItemRange& b) {
  const ItemRange both{std::max(a.first, b.first), std::min(a.last, b.last)};
  return both.first < both.last ? both : ItemRange{a.first, a.first};
}

DescriptorSpan frames_of(const DescriptorSpan& sequence, const ItemRange& frames) {
  return {sequence.rows.subspan(frames.first, frames.count()), {}};
}

std::vector<FrameRun> held_runs(std::span<const DescriptorSpan> train, const TrainPart& part) {
  std::vector<size_t> first_held;  // by sequence, among all that are held
  size_t frames = 0;
  for (const ItemRange& held : part.held) {
    first_held.push_back(frames);
    frames += held.count();
  }
  std::vector<FrameRun> runs;
  for (const FrameRun& run : readable_runs(train)) {
    const ItemRange& held = part.held[run.sequence];
    const ItemRange in = overlap(held, {run.first_in_sequence, run.first_in_sequence + run.count});
    if (in.count() > 0)
      runs.push_back(
          {first_held[run.sequence] + in.first - held.first, in.count(), run.sequence, in.first});
  }
  return runs;
}

// The readable ones of these frames of all sequences.
std::vector<DescriptorSpan> readable_part(std::span<const DescriptorSpan> sequences,
                                          const ItemRange& frames) {
  std::vector<DescriptorSpan> part;
  for (const FrameRun& run : readable_runs(sequences)) {
    const ItemRange in = overlap({run.first, run.first + run.count}, frames);
    const size_t first = run.first_in_sequence + in.first - run.first;
    if (in.count() > 0)
      part.push_back(frames_of(sequences[run.sequence], {first, first + in.count()}));
  }
  return part;
}

// Distances of bits are whole numbers: their sum over all frames is that of the processes' sums.
// Those of others are rounded once all frames are summed up, which every process does for itself.
bool has_exact_totals(const DescriptorShape& shape) { return shape.element == ElementType::bits; }

std::optional<ScoreRow> cut_to(const ItemRange& windows, const ScoreRow& row) {
  const ItemRange in = overlap({row.train_window, row.train_window + row.scores.size()}, windows);
  if (in.count() == 0) return std::nullopt;
  return part_of_row(row, in.first - row.train_window, in.count());
}

void share_totals(FrameDistances& distances, const Share& share) {
  const auto totals = std::make_shared<std::vector<uint64_t>>();
  for (size_t frame = 0; frame < distances.query_frames; ++frame)
    totals->push_back(distances.row_total(frame));
  add_up(share, "row totals", *totals);
  distances.row_total = [totals](size_t frame) { return (*totals)[frame]; };
}

}  // namespace

TrainPart own_windows(std::span<const DescriptorSpan> train, size_t longest, const Share& share) {
  const ItemRange own = own_part(share, count_frames(train));
  TrainPart part;
  size_t first = 0;
  for (const DescriptorSpan& sequence : train) {
    const size_t size = sequence.rows.size();
    const ItemRange in = overlap({first, first + size}, own);
    part.own.push_back({in.first - first, in.last - first});
    part.held.push_back(part.own.back());
    if (in.count() > 0) part.held.back().last = std::min(in.last - first + longest - 1, size);
    first += size;
  }
  return part;
}

FrameDistances part_distances(std::span<const DescriptorSpan> train, const TrainPart& part,
                              const DescriptorSpan& query,
                              std::span<const DescriptorSpan> centred_over, const Share& share) {
  if (share.is_alone()) return frame_distances(train, query, centred_over);
  std::vector<DescriptorSpan> held;
  for (size_t s = 0; s < train.size(); ++s) held.push_back(frames_of(train[s], part.held[s]));
  const bool is_exact = has_exact_totals(query.rows.shape);
  const std::vector<DescriptorSpan> centred =
      is_exact ? readable_part(centred_over, own_part(share, count_frames(centred_over)))
               : std::vector<DescriptorSpan>(centred_over.begin(), centred_over.end());
  FrameDistances distances = frame_distances(held, query, centred);
  distances.train_runs = held_runs(train, part);
  distances.centred_frames = count_windows(readable_runs(centred_over), 1);
  distances.of_query = nullptr;
  if (is_exact) share_totals(distances, share);
  return distances;
}

RowConsumer own_rows(const TrainPart& part, RowConsumer consume) {
  return [own = part.own, consume = std::move(consume)](const ScoreRow& row) {
    if (const auto cut = cut_to(own[row.sequence], row)) consume(*cut);
  };
}

}  // namespace vpr
