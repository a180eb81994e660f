#include "query/run_query.h"

#include <algorithm>
#include <functional>

#include "base/stopwatch.h"
#include "query/path_decisions.h"

namespace vpr {
namespace {

constexpr size_t kMostRecognitions = 4'000'000'000;  // clusters have 32-bit numbers
// Memory per recognition while recognitions are collected, sorted, clustered and written.
constexpr size_t kBytesPerRecognition = 64;

std::optional<ResultKeyframes> find_keyframes(const QueryPlan& plan) {
  if (!plan.typical_distance) return std::nullopt;
  ResultKeyframes keyframes{keyframe_starts(plan.query, *plan.typical_distance), {}};
  for (const DescribedFrames& sequence : plan.train)
    keyframes.train.push_back(keyframe_starts(sequence, *plan.typical_distance));
  return keyframes;
}

// Compares the result of an approximate search with an exact one.
SearchRecall recall_of(const Result& result, const FrameDistances& distances, const QueryPlan& plan,
                       const Monitor& monitor) {
  RecognitionScan scan(scan_settings(plan));
  MatchSettings exact_match = plan.match;
  exact_match.method = exact_methods().data();
  match(distances, exact_match, {{std::ref(scan)}}, monitor);
  const RecognitionScanResult exact = scan.result();
  SearchRecall recall;
  recall.recognitions = exact.recognitions.size();
  recall.found_recognitions = result.recognitions.size();
  for (size_t window = 0; window < exact.best.size(); ++window) {
    if (!exact.best[window]) continue;
    ++recall.windows;
    const auto& best = result.best[window];
    if (best && best->score == match_of(*exact.best[window], plan).score) ++recall.found_best;
  }
  return recall;
}

}  // namespace

FrameDistances searched_distances(const QueryPlan& plan) {
  FrameDistances distances = frame_distances(plan.train, plan.query);
  std::erase_if(distances.train_runs, [&](const FrameStretch& run) {
    return !plan.result.sequences[run.sequence].searched;
  });
  distances.past = plan.result.past;
  return distances;
}

RecognitionScanSettings scan_settings(const QueryPlan& plan) {
  RecognitionScanSettings settings;
  for (const ComparedSequence& sequence : plan.result.sequences)
    settings.limits.push_back(sequence.distance_limit);
  settings.query_windows = plan.result.query_windows;
  settings.max_recognitions =
      std::min(plan.match.memory_limit / kBytesPerRecognition, kMostRecognitions);
  return settings;
}

Match match_of(const Cell& cell, const QueryPlan& plan) {
  const int64_t offset = plan.result.score().offset(plan.match.window_length);
  return {cell.query_window, cell.sequence, cell.train_window, 0,
          static_cast<double>(cell.score - offset)};
}

bool has_margin(const Result& result, const Match& best, std::optional<double> margin) {
  const std::optional<double> least = result.sequences[best.sequence].margin;
  return least && margin && *margin >= *least;
}

Result make_result(const QueryPlan& plan, const RecognitionScanResult& found,
                   const std::vector<std::optional<uint32_t>>& margins) {
  Result result = plan.result;
  for (const auto& best : found.best)
    result.best.push_back(best ? std::optional(match_of(*best, plan)) : std::nullopt);
  result.margins.assign(margins.begin(), margins.end());
  if (std::holds_alternative<ByMargin>(plan.decision)) {
    for (size_t window = 0; window < result.best.size(); ++window)
      if (const auto& best = result.best[window];
          best && has_margin(result, *best, frame_margin(result, window)))
        result.recognitions.push_back(*best);
  } else {
    result.recognitions.reserve(found.recognitions.size());
    for (const Cell& cell : found.recognitions) result.recognitions.push_back(match_of(cell, plan));
  }
  return result;
}

namespace {

/// Collects the reports of a planned query by the filter, which must outlive it, into a result.
class PathRows {
 public:
  explicit PathRows(const QueryPlan& plan)
      : plan_(plan),
        decisions_(std::get<ByPath>(plan.decision).least_margin),
        witness_(std::get<ByPath>(plan.decision).witness) {
    if (witness_) path_.witnessed.resize(plan.result.query.frames);
  }

  void operator()(std::span<const ScoreRow> row) {
    PathReport report = *row.front().path;
    const size_t frame = row.front().query_window;
    if (witness_) {
      const double margin = plan_.result.score().frame_value(report.margin, 1);
      by_margin_ = {margin, witness_->add_evidence(report, plan_.query.rows[frame], [this, frame] {
                      return plan_.features_of ? plan_.features_of(frame)
                                               : std::vector<LocalFeature>{};
                    })};
    }
    steps_[frame] = report;
    steps_[frame].matches = {};
    reversed_[frame] = *row.front().reversed;
    for (const Cell& match : report.matches) {
      found_.best[match.query_window] = match;
      path_.numbers[match.query_window] = report.path;
    }
    path_.rates[frame] = report.rate;
    decide(decisions_.take(report), frame);
  }

  Result result() {
    if (!steps_.empty() && steps_.back().path != 0) decide(decisions_.finish(), steps_.size() - 1);
    path_.keyframes = static_cast<size_t>(std::ranges::count_if(steps_, &PathReport::is_keyframe));
    const std::vector<uint32_t> settled = settled_margins(std::move(steps_));
    std::vector<std::optional<uint32_t>> margins(settled.size());
    for (size_t frame = 0; frame < margins.size(); ++frame)
      if (found_.best[frame]) margins[frame] = settled[frame];
    const uint32_t least = std::get<ByPath>(plan_.decision).least_margin;
    const std::vector<uint32_t> reversed = settled_margins(std::move(reversed_));
    path_.reversed_frames = static_cast<size_t>(
        std::ranges::count_if(reversed, [&](uint32_t margin) { return margin >= least; }));
    Result result = make_result(plan_, found_, margins);
    result.path = std::move(path_);
    return result;
  }

 private:
  void decide(const std::vector<Cell>& recognized, size_t frame) {
    for (const Cell& match : recognized) {
      path_.decided[match.query_window] = static_cast<uint32_t>(frame);
      if (witness_) path_.witnessed[match.query_window] = by_margin_;
      found_.recognitions.push_back(match);
    }
  }

  const QueryPlan& plan_;
  const size_t frames_ = plan_.result.query.frames;
  PathDecisions decisions_;
  std::optional<WitnessStage> witness_;
  std::vector<PathReport> steps_ = std::vector<PathReport>(frames_);  // without matches
  std::vector<PathReport> reversed_ = steps_;                         // against the direction
  RecognitionScanResult found_{{}, std::vector<std::optional<Cell>>(frames_)};
  ResultPath path_{frames_};
  ResultPath::Decided by_margin_;  // the last report, with a witness
};

/// Collects the rows of a planned query, which must outlive it, into a result without clusters and
/// keyframes.
class ResultRows {
 public:
  explicit ResultRows(const QueryPlan& plan) : plan_(plan), recognitions_(scan_settings(plan)) {
    if (std::holds_alternative<ByPath>(plan.decision))
      paths_.emplace(plan);
    else if (plan.exclusion_zones)
      margins_.emplace(*plan.exclusion_zones, plan.result.query_windows);
  }

  /// Valid as long as this object.
  Sinks sinks() {
    if (paths_) return {{}, {std::ref(*paths_)}};
    Sinks sinks{{std::ref(recognitions_)}, {}};
    if (margins_) sinks.rows.push_back(std::ref(*margins_));
    return sinks;
  }

  Result result() {
    if (paths_) return paths_->result();
    return make_result(plan_, recognitions_.result(),
                       margins_ ? margins_->result() : std::vector<std::optional<uint32_t>>{});
  }

 private:
  const QueryPlan& plan_;
  RecognitionScan recognitions_;
  std::optional<MarginScan> margins_;  // nullopt: there are none, or the filter reports them
  std::optional<PathRows> paths_;      // of the filter
};

}  // namespace

QueryRun run_query(QueryPlan plan, const Sinks& observers, const Monitor& monitor) {
  QueryRun run;
  FrameDistances distances = searched_distances(plan);
  Stopwatch watch;
  const auto end_step = [&](const char* name) {
    run.seconds[name] = watch.elapsed_s();
    watch = {};
  };

  // Relative thresholds need the largest of all distances first.
  const bool has_two_passes = needs_maxima(plan);
  if (has_two_passes) {
    MaximumScan scan(plan.result.sequences.size());
    match(distances, plan.match, {{std::ref(scan)}}, part_of(monitor, "pass", 0, 2));
    set_relative_limits(plan, scan.result());
    end_step("maximum");
  }
  const Monitor last_pass = has_two_passes ? part_of(monitor, "pass", 1, 2) : monitor;
  distances = scored(std::move(distances), plan.scores);
  {
    ResultRows rows(plan);
    Sinks sinks = rows.sinks();
    sinks.pieces.insert(sinks.pieces.end(), observers.pieces.begin(), observers.pieces.end());
    sinks.rows.insert(sinks.rows.end(), observers.rows.begin(), observers.rows.end());
    match(distances, plan.match, sinks, last_pass);
    run.result = rows.result();
  }
  end_step("match");

  if (plan.match.method->is_approximate()) {
    run.result.recall = recall_of(run.result, distances, plan, monitor);
    end_step("recall");
  }
  cluster(run.result, monitor);
  end_step("cluster");
  run.result.keyframes = find_keyframes(plan);
  return run;
}

}  // namespace vpr
