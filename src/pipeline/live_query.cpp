#include "pipeline/live_query.h"

#include <fmt/format.h>

#include "base/error.h"
#include "pipeline/query_steps.h"
#include "pipeline/score_basis.h"

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

}  // namespace vpr
