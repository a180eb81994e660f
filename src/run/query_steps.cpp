#include "run/query_steps.h"

#include <algorithm>
#include <functional>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "match/match.h"
#include "match/rates.h"
#include "match/zscore_model.h"

namespace vpr {
namespace {

constexpr size_t kMostRecognitions = 4'000'000'000;  // clusters are numbered by 32 bits
constexpr size_t kBytesPerRecognition =
    64;  // while recognitions are collected, sorted, clustered and written

}  // namespace

void check_descriptors(const DescriptorStore& trained, const DescriptorStore& asked,
                       uint64_t window_length) {
  const std::string_view name = trained.kind->name;
  if (name != asked.kind->name)
    throw Error(ErrorKind::data,
                fmt::format("frames of the database are described by {}, those of the query by {}; "
                            "describe both by the same",
                            name, asked.kind->name));
  if (trained.shape() != asked.shape())
    throw Error(
        ErrorKind::data,
        fmt::format("descriptors of the database have {} {}, those of the query {}; {}",
                    trained.shape().length, element_words(trained.shape()), asked.shape().length,
                    asked.rows().size() == trained.shape().length
                        ? "is the query's array transposed? Rows are frames"
                        : "describe both by the same"));
  // Files hold sums over a window as signed numbers of 32 bits.
  const uint64_t longest = std::numeric_limits<int32_t>::max() / largest_distance(trained.shape());
  if (window_length > longest)
    throw Error(ErrorKind::usage, fmt::format("c_l must be at most {} for frames described by {}, "
                                              "found {}",
                                              longest, name, window_length));
}

FrameDistances searched_distances(const QueryPlan& plan) {
  FrameDistances distances = frame_distances(plan.train, plan.query);
  std::erase_if(distances.train_runs,
                [&](const FrameRun& run) { return !plan.sequences[run.sequence].searched; });
  distances.past = plan.past;
  return distances;
}

bool needs_maxima(const QueryPlan& result) {
  return result.settings.distance_threshold &&
         scale_of(result.settings) == ThresholdScale::relative;
}

void set_relative_limits(QueryPlan& result, const std::vector<uint32_t>& maxima) {
  for (size_t s = 0; s < result.sequences.size(); ++s) {
    Target& sequence = result.sequences[s];
    if (!sequence.searched || sequence.windows == 0) continue;
    sequence.max_distance = maxima[s];
    sequence.distance_limit = distance_limit(*sequence.threshold, maxima[s]);
  }
}

std::optional<ResultViews> find_views(const QueryPlan& plan) {
  if (plan.learned == nullptr || plan.query.given) return std::nullopt;
  const double typical = plan.learned->typical_distance;
  ResultViews views{view_starts(plan.query, typical), {}};
  for (const DescriptorSpan& sequence : plan.train)
    views.train.push_back(view_starts(sequence, typical));
  return views;
}

RecognitionScanSettings scan_settings(const QueryPlan& result, const QueryResources& resources) {
  RecognitionScanSettings settings;
  for (const Target& sequence : result.sequences)
    settings.limits.push_back(sequence.distance_limit);
  settings.query_windows = result.query_windows;
  settings.max_recognitions =
      std::min(resources.memory_limit / kBytesPerRecognition, kMostRecognitions);
  settings.kernels = resources.kernels;
  return settings;
}

MatchSettings match_settings(const QueryPlan& plan, const QueryResources& resources) {
  MatchSettings match{
      plan.settings.window_length,      resources.memory_limit, resources.kernels, {}, {},
      parse_rates(plan.settings.rates), plan.settings.filter};
  match.method = &find_sequence_method(plan.settings.method);
  if (plan.elsewhere) match.shared_places = plan.elsewhere->shared;
  return match;
}

ResultRows::ResultRows(const QueryPlan& plan, const QueryResources& resources)
    : plan_(plan), recognitions_(scan_settings(plan, resources)) {
  if (has_paths(plan.settings.method)) {
    path_.emplace(plan.query_sequence.frames);
    margins_.resize(plan.query_sequence.frames);
  } else if (plan.elsewhere) {
    scan_.emplace(*plan.elsewhere, plan.query_windows, resources.kernels);
  }
}

Sinks ResultRows::sinks() {
  Sinks sinks{{std::ref(recognitions_)}, {}};
  if (scan_) sinks.rows.push_back(std::ref(*scan_));
  if (path_) sinks.rows.push_back([this](std::span<const ScoreRow> row) { take_path(row); });
  return sinks;
}

void ResultRows::take_path(std::span<const ScoreRow> row) {
  const PathReport& report = *row.front().path;
  const size_t frame = row.front().query_window;
  margins_[frame] = report.margin;
  path_->nowhere[frame] = static_cast<double>(int64_t{report.nowhere} - plan_.score_offset());
  if (report.rate) path_->rates[frame] = *report.rate;
  path_->tracks[frame] = report.track;
}

Result ResultRows::result() {
  if (scan_) margins_ = scan_->result().margins;
  Result result = make_result(plan_, recognitions_.result(), margins_);
  result.path = std::move(path_);
  return result;
}

}  // namespace vpr
