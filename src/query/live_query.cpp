#include "query/live_query.h"

#include <algorithm>
#include <cassert>
#include <iterator>

#include "base/error.h"
#include "match/fastable.h"

namespace vpr {

LiveQuery::LiveQuery(const SequenceDatabase& database, const std::string& query_name,
                     const SequenceQuerySettings& settings, const QueryResources& resources,
                     const Monitor& monitor)
    : plan_(plan_window(prepare(database, settings, resources, monitor), query_name, settings,
                        resources, monitor)),
      frames_(start_live(searched_distances(plan_), plan_.scores)) {
  const MatchSettings& match = plan_.match;
  const size_t length = match.window_length;
  const auto* by_path = std::get_if<ByPath>(&plan_.decision);
  if (by_path == nullptr && !ring_fits(frames_.raw.train_frames, length, match.memory_limit))
    throw Error(ErrorKind::usage,
                "the distances of the last {} frames to {} training frames do not fit --max-memory",
                length, frames_.raw.train_frames);
  windows_ = window_stage(frames_.scores, {&length, 1}, match);
  if (by_path != nullptr) {
    decisions_.emplace(by_path->least_margin);
    witness_ = by_path->witness;
  }
}

std::optional<LiveAnswer> LiveQuery::take(const ArrivedFrame& frame) {
  add_frame(frames_, frame);
  readable_frames_ = frame.is_readable ? readable_frames_ + 1 : 0;
  const QueryFrame next{frames_.last_row(), frames_.frames - 1, readable_frames_};
  if (decisions_) return take_path(next, frame);
  RecognitionScan scan(scan_settings(plan_));  // of one window
  std::optional<MarginScan> margins;
  if (plan_.exclusion_zones) margins.emplace(*plan_.exclusion_zones, 1);
  windows_(frames_.scores, next, [&](size_t, std::span<const ScoreRow> row) {
    std::vector<ScoreRow> only(row.begin(), row.end());
    for (ScoreRow& piece : only) {
      piece.query_window = 0;
      scan(piece);
    }
    if (margins) (*margins)(only);
  });
  const size_t length = plan_.match.window_length;
  if (readable_frames_ < length) return std::nullopt;
  const RecognitionScanResult found = scan.result();
  LiveAnswer answer;
  if (found.best[0]) answer.best = match_of(*found.best[0], plan_);
  if (margins && margins->result()[0])
    answer.margin = shape().score().frame_value(*margins->result()[0], length);
  if (!std::holds_alternative<ByMargin>(plan_.decision))
    answer.recognized = matches_of(found.recognitions);
  else if (answer.best && has_margin(shape(), *answer.best, answer.margin))
    answer.recognized = {*answer.best};
  const auto window = static_cast<uint32_t>(frames_.frames - length);
  if (answer.best) answer.best->query = window;
  for (Match& match : answer.recognized) match.query = window;
  return answer;
}

std::optional<LiveAnswer> LiveQuery::take_path(const QueryFrame& frame,
                                               const ArrivedFrame& arrived) {
  last_.reset();
  if (frame.consecutive_readable == 0) decisions_->end_path();
  windows_(frames_.scores, frame, [&](size_t, std::span<const ScoreRow> row) {
    PathReport report = *row.front().path;
    if (witness_)
      witness_->add_evidence(report, arrived.descriptor,
                             [features = arrived.features] { return features; });
    last_ = {match_of(report.matches.back(), plan_), shape().score().frame_value(report.margin, 1),
             report.rate, matches_of(decisions_->take(report))};
  });
  return last_;
}

std::vector<Match> LiveQuery::matches_of(const std::vector<Cell>& cells) const {
  std::vector<Match> matches;
  for (const Cell& cell : cells) matches.push_back(match_of(cell, plan_));
  return matches;
}

std::optional<LiveAnswer> LiveQuery::finish() {
  if (!decisions_ || !last_) return std::nullopt;
  last_->recognized = matches_of(decisions_->finish());
  return last_->recognized.empty() ? std::nullopt : std::move(last_);
}

LiveScores start_live(const FrameDistances& raw, const ScoreStages& stages) {
  assert(raw.query_frames == 0 && raw.of_query);
  LiveScores live{raw, stages.start(), {}, {}, raw, 0};
  for (const StartedStage& stage : live.stages)
    live.scores = stage.scores(std::move(live.scores), {});
  return live;
}

void add_frame(LiveScores& live, const ArrivedFrame& frame) {
  std::vector<size_t> kept;
  for (const StartedStage& stage : live.stages) {
    if (!stage.needed) continue;
    std::vector<size_t> both;
    std::ranges::set_union(kept, stage.needed(), std::back_inserter(both));
    kept = std::move(both);
  }
  const DescriptorShape& shape = live.raw.query.rows.shape;
  const DescriptorRows rows(shape, live.bytes);
  const DescriptorRow row = frame.descriptor.first(shape.row_bytes());
  std::vector<uint8_t> bytes;
  for (const size_t index : kept) bytes.insert(bytes.end(), rows[index].begin(), rows[index].end());
  bytes.insert(bytes.end(), row.begin(), row.end());
  live.bytes = std::move(bytes);
  live.unreadable.clear();  // unreadable frames are never kept
  if (!frame.is_readable) live.unreadable.push_back(kept.size());
  live.scores = live.raw.of_query({DescriptorRows(shape, live.bytes), live.unreadable});
  live.scores.train_runs = live.raw.train_runs;
  for (const StartedStage& stage : live.stages)
    live.scores = stage.scores(std::move(live.scores), kept);
  ++live.frames;
}

}  // namespace vpr
