#include "run/live_query.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {

namespace {

// Reduces the state to the kept rows and a new one.
void keep_rows(ZScoreState& state, const std::vector<size_t>& kept, FrameDistances distances) {
  std::vector<FrameTerms> terms;
  for (const size_t row : kept) terms.push_back(state.terms[row]);
  terms.resize(kept.size() + 1);
  state.terms = std::move(terms);
  for (size_t& view : state.views.pending)
    view = static_cast<size_t>(std::ranges::lower_bound(kept, view) - kept.begin());
  state.readable = readable_flags(distances.query_runs, distances.query_frames);
  state.distances = std::move(distances);
}

}  // namespace

LiveQuery::LiveQuery(const SequenceDatabase& database, const std::string& query_name,
                     const ResolvedSettings& settings, const QueryResources& resources,
                     const Monitor& monitor)
    : resources_(resources),
      plan_(plan_window(database, query_name, settings, resources, monitor)),
      frames_(start_live(searched_distances(plan_), plan_.basis.get())) {
  const MatchSettings& match = plan_.match;
  const FrameDistances& distances = frames_.distances;
  const size_t length = match.window_length;
  if (!match.method->has_paths && !ring_fits(distances.train_frames, length, match.memory_limit))
    throw Error(ErrorKind::usage,
                fmt::format("the distances of the last {} frames to {} training frames do not fit "
                            "--max-memory",
                            length, distances.train_frames));
  windows_ = window_stage(distances, {&length, 1}, match);
  if (match.method->has_paths) decisions_.emplace(least_margin(plan_));
}

std::optional<Result> LiveQuery::take(const ArrivedFrame& frame) {
  add_frame(frames_, frame);
  readable_frames_ = frame.is_readable ? readable_frames_ + 1 : 0;
  const QueryFrame next{frames_.last_row(), frames_.frames - 1, readable_frames_};
  if (decisions_) return take_path(next);
  ResultRows rows(plan_, resources_);
  const Sinks sinks = rows.sinks();
  windows_(frames_.distances, next, [&](size_t, std::span<const ScoreRow> row) {
    std::vector<ScoreRow> only(row.begin(), row.end());
    for (ScoreRow& piece : only) piece.query_window = 0;
    send_row(sinks, only);
  });
  if (readable_frames_ < plan_.match.window_length) return std::nullopt;
  return rows.result();
}

std::optional<Result> LiveQuery::take_path(const QueryFrame& frame) {
  last_.reset();
  if (frame.in_a_row == 0) decisions_->end_path();
  windows_(frames_.distances, frame, [&](size_t, std::span<const ScoreRow> row) {
    const PathReport& report = *row.front().path;
    Cell match = report.matches.back();
    match.query_window = 0;
    last_ = make_result(plan_, {{}, {match}}, {report.margin});
    last_->path.emplace(1);
    if (report.rate) last_->path->rates[0] = *report.rate;
    last_->path->numbers[0] = report.path;
    last_->recognitions = recognitions_of(decisions_->take(report));
  });
  return last_;
}

std::vector<Match> LiveQuery::recognitions_of(const std::vector<Cell>& recognized) const {
  std::vector<Match> recognitions;
  for (const Cell& cell : recognized) recognitions.push_back(match_of(cell, plan_));
  return recognitions;
}

std::optional<Result> LiveQuery::finish() {
  if (!decisions_ || !last_) return std::nullopt;
  last_->recognitions = recognitions_of(decisions_->finish());
  return last_->recognitions.empty() ? std::nullopt : std::move(last_);
}

LiveDistances start_live(FrameDistances raw, const ScoreBasis* basis) {
  assert(raw.query_frames == 0 && raw.of_query && (basis == nullptr || !basis->offline));
  LiveDistances live;
  live.raw = live.distances = raw;
  if (basis == nullptr) return live;
  live.state = start_zscores(std::move(raw), *basis, {});
  live.fusion = basis->fusion;
  live.fusion_state = std::make_shared<FusionState>();
  live.distances = fused(zscores(live.state), live.fusion, live.fusion_state);
  return live;
}

void add_frame(LiveDistances& live, ArrivedFrame frame) {
  const std::vector<size_t> kept = live.state ? live.state->views.pending : std::vector<size_t>{};
  const DescriptorRows rows(live.raw.query.rows.shape, live.bytes);
  std::vector<uint8_t> bytes;
  for (const size_t index : kept) bytes.insert(bytes.end(), rows[index].begin(), rows[index].end());
  bytes.insert(bytes.end(), frame.descriptor.begin(), frame.descriptor.end());
  live.bytes = std::move(bytes);
  live.unreadable.clear();  // unreadable frames are never kept
  if (!frame.is_readable) live.unreadable.push_back(kept.size());
  live.words.assign(kept.size(), {});
  live.words.push_back(std::move(frame.words));
  FrameDistances distances = live.raw.of_query(
      {DescriptorRows(rows.shape, live.bytes), live.unreadable, nullptr, live.words});
  distances.train_runs = live.raw.train_runs;
  if (live.state) keep_rows(*live.state, kept, distances);
  live.distances = live.state ? fused(zscores(live.state), live.fusion, live.fusion_state)
                              : std::move(distances);
  ++live.frames;
}

}  // namespace vpr
