#include "run/live_query.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "base/error.h"
#include "run/query_steps.h"
#include "run/score_basis.h"

namespace vpr {

namespace {

QueryPlan checked_plan(const SequenceDatabase& database, const std::string& query_name,
                       const SequenceQuerySettings& settings, const QueryResources& resources,
                       const Monitor& monitor) {
  check_live(with_implied(settings));
  return plan_window(database, query_name, settings, resources, monitor);
}

MatchSettings match_settings(const QueryPlan& plan, const QueryResources& resources) {
  MatchSettings match{plan.settings.window_length, resources.memory_limit, resources.kernels};
  match.filter = plan.settings.filter;
  if (plan.elsewhere) match.shared_places = plan.elsewhere->shared;
  return match;
}

// What run_query matches, of no frame yet.
LiveFrames live_frames(const QueryPlan& plan) {
  const std::optional<ScoreBasis> all = score_basis(plan.learned, plan.settings);
  if (!all) return start_live(searched_distances(plan), nullptr);
  const ScoreBasis basis = searched_basis(*all, plan);
  return start_live(searched_distances(plan), &basis);
}

size_t new_index(const std::vector<size_t>& kept, size_t row) {
  return static_cast<size_t>(std::lower_bound(kept.begin(), kept.end(), row) - kept.begin());
}

std::vector<size_t> rows_to_keep(const LiveFrames& live, const std::optional<size_t>* other) {
  std::vector<size_t> rows;
  if (live.state) rows = live.state->views.pending;
  if (other != nullptr && *other) rows.push_back(**other);
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

// The state of the rows that are kept, and room for the new one.
void keep_rows(StandardizedState& state, const std::vector<size_t>& kept,
               FrameDistances distances) {
  std::vector<CommonWeights> common;
  for (const size_t row : kept) common.push_back(state.common[row]);
  common.resize(kept.size() + 1);
  state.common = std::move(common);
  for (size_t& view : state.views.pending) view = new_index(kept, view);
  state.readable = readable_flags(distances.query_runs, distances.query_frames);
  state.distances = std::move(distances);
}

}  // namespace

void check_live(const SequenceQuerySettings& settings) {
  if (settings.method != "fastable" && settings.method != "fastable-online" &&
      !has_paths(settings.method))
    throw Error(ErrorKind::usage,
                fmt::format("{} does not go frame by frame; follow a query by fastable or filter",
                            settings.method));
  if (score_kind(settings.score).is_offline)
    throw Error(ErrorKind::usage,
                fmt::format("--score {} learns from the whole query before it says anything; "
                            "follow a query with --score standardized",
                            enum_name(settings.score)));
  if (!settings.rates.empty())
    throw Error(ErrorKind::usage,
                "windows of several rates are not followed; --method filter follows any pace");
  if (decision_kind(settings.decision).accepts == nullptr && settings.distance_threshold &&
      scale_of(settings) == ThresholdScale::relative)
    throw Error(ErrorKind::usage,
                "a relative t_r is a share of the largest distance of the whole query, which is "
                "not known while frames come; give --t-r-scale bits");
}

/// What is found of one window.
struct LiveQuery::Found {
  HitScanResult matches;
  std::vector<std::optional<uint32_t>> margins;
  std::optional<ResultPath> path;
};

LiveQuery::LiveQuery(const SequenceDatabase& database, const std::string& query_name,
                     const SequenceQuerySettings& settings, const QueryResources& resources,
                     const Monitor& monitor)
    : resources_(resources),
      plan_(checked_plan(database, query_name, settings, resources, monitor)),
      frames_(live_frames(plan_)) {
  const MatchSettings match = match_settings(plan_, resources);
  if (has_paths(plan_.settings.method)) {
    filtered_ = start_filtered(frames_.distances, match);
    return;
  }
  sums_ = start_fastable(frames_.distances, match);
  if (!sums_.has_ring)
    throw Error(ErrorKind::usage,
                fmt::format("the distances of the last {} frames to {} training frames do not fit "
                            "--max-memory",
                            match.window_length, frames_.distances.train_frames));
}

void LiveQuery::match_window(const RowConsumer& consume) {
  const size_t length = plan_.settings.window_length;
  const auto sums =
      advance_fastable(sums_, frames_.distances, resources_.kernels, frames_.last_row());
  if (in_a_row_ >= length)
    emit_row(frames_.distances, length, frames_.frames - 1, 0, sums, consume);
}

void LiveQuery::match_path(Found& found, const RowConsumer& consume) {
  found.path.emplace(1);
  found.margins.resize(1);
  if (in_a_row_ == 0 || filtered_->filter.cells.places == 0) return;
  if (in_a_row_ == 1) forget_frames(*filtered_);
  filtered_->passed = frames_.frames - 1 - frames_.last_row();
  const PathReport report = take_frame(*filtered_, frames_.distances, frames_.last_row());
  found.margins[0] = report.margin;
  found.path->nowhere[0] =
      static_cast<double>(static_cast<int64_t>(report.nowhere) - plan_.score_offset());
  if (report.rate) found.path->rates[0] = *report.rate;
  found.path->tracks[0] = report.track;
  emit_row(frames_.distances, 1, frames_.frames - 1, 0, filtered_->row, consume);
}

std::optional<Result> LiveQuery::take(const FrameRow& frame) {
  add_frame(frames_, frame, filtered_ ? &filtered_->view : nullptr);
  in_a_row_ = frame.is_readable ? in_a_row_ + 1 : 0;
  Found found;
  HitScan scan(scan_settings(plan_, resources_));
  std::optional<MarginScan> margins;
  if (!filtered_) margins.emplace(*plan_.elsewhere, 1, resources_.kernels);
  const auto consume = [&](ScoreRow piece) {
    piece.query_window = 0;
    const uint32_t least = resources_.kernels.minimum(piece.scores.data(), piece.scores.size());
    scan.take(piece, least);
    if (margins) margins->take(piece, least);
  };
  if (filtered_)
    match_path(found, consume);
  else
    match_window(consume);
  if (in_a_row_ < plan_.settings.window_length) return std::nullopt;
  found.matches = scan.result();
  if (margins) found.margins = margins->result().margins;
  Result result = make_result(plan_, found.matches, found.margins);
  result.path = std::move(found.path);
  return result;
}

LiveFrames start_live(FrameDistances raw, const ScoreBasis* basis) {
  assert(raw.query_frames == 0 && raw.of_query && (basis == nullptr || !basis->offline));
  LiveFrames live;
  live.raw = raw;
  if (basis != nullptr) {
    live.state = start_standardized(std::move(raw), *basis, {});
    live.fusion = basis->fusion;
    live.fusion_state = std::make_shared<FusionState>();
  }
  live.distances =
      live.state ? fused(standardized(live.state), live.fusion, live.fusion_state) : live.raw;
  return live;
}

void add_frame(LiveFrames& live, FrameRow frame, std::optional<size_t>* other) {
  const std::vector<size_t> kept = rows_to_keep(live, other);
  const DescriptorRows rows(live.raw.query.rows.shape, live.bytes);
  std::vector<uint8_t> bytes;
  for (const size_t index : kept) bytes.insert(bytes.end(), rows[index].begin(), rows[index].end());
  bytes.insert(bytes.end(), frame.descriptor.begin(), frame.descriptor.end());
  live.bytes = std::move(bytes);
  live.unreadable.clear();  // nothing is kept of a frame that can't be read
  if (!frame.is_readable) live.unreadable.push_back(kept.size());
  live.words.assign(kept.size(), {});
  live.words.push_back(std::move(frame.words));
  FrameDistances distances = live.raw.of_query(
      {DescriptorRows(rows.shape, live.bytes), live.unreadable, nullptr, live.words});
  if (other != nullptr && *other) *other = new_index(kept, **other);
  if (live.state) keep_rows(*live.state, kept, distances);
  live.distances = live.state ? fused(standardized(live.state), live.fusion, live.fusion_state)
                              : std::move(distances);
  ++live.frames;
}

}  // namespace vpr
