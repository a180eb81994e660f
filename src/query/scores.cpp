#include "query/scores.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/error.h"
#include "match/score_kernels.h"
#include "query/query_settings.h"

namespace vpr {
namespace {

// The smallest sum that is not a recognition. The error of `estimate` is at most a rounding.
template <class IsRecognition>
uint32_t smallest_refused(double estimate, const IsRecognition& is_recognition) {
  constexpr uint32_t kMost = std::numeric_limits<uint32_t>::max();
  if (estimate >= kMost) return kMost;
  auto limit = static_cast<uint32_t>(std::max(estimate, 0.0));
  while (limit > 0 && !is_recognition(limit - 1)) --limit;
  while (limit < kMost && is_recognition(limit)) ++limit;
  return limit;
}

int64_t no_offset(size_t) { return 0; }

double distance_per_frame(double sum, size_t window_length) {
  return sum / static_cast<double>(window_length);
}

double deviations_per_frame(double sum, size_t window_length) {
  return sum / (kScoreUnit * static_cast<double>(window_length));
}

// The deviation of a mean of c_l independent distances, or z, is proportional to 1 / sqrt(c_l).
// Above every margin between floors that look alike (docs/benchmarks/why-these-defaults.md).
constexpr double kMarginShare = 0.75;
constexpr double kMarginDeviations = 5.1;

double default_distance_margin(double typical_distance, size_t window_length) {
  return kMarginShare * typical_distance / std::sqrt(static_cast<double>(window_length));
}

double default_score_margin(double, size_t window_length) {
  return kMarginDeviations / std::sqrt(static_cast<double>(window_length));
}

constexpr ScoreKind kRaw = {.order = ScoreOrder::distance,
                            .measure = "distance",
                            .window_symbol = "c_l",
                            .threshold_symbol = "t_r",
                            .number_scale = ThresholdScale::relative,
                            .frame_scale = ThresholdScale::bits,
                            .missing = -1,
                            .offset = no_offset,
                            .frame_value = distance_per_frame,
                            .margin_unit = "bits per frame",
                            .most_margin = 65535,
                            .default_margin = default_distance_margin};

constexpr ScoreKind kZScore = {.order = ScoreOrder::distance,
                               .measure = "z-score",
                               .window_symbol = "c_l",
                               .threshold_symbol = "t_r",
                               .number_scale = ThresholdScale::mean_z,
                               .frame_scale = ThresholdScale::mean_z,
                               .missing = std::numeric_limits<int32_t>::min(),
                               .needs_statistics = true,
                               .offset = score_offset,
                               .frame_value = deviations_per_frame,
                               .margin_unit = "deviations",
                               .most_margin = 64,
                               .default_margin = default_score_margin};

constexpr ScoreKind kProbability = {.order = ScoreOrder::similarity,
                                    .measure = "probability",
                                    .window_symbol = "c_w",
                                    .threshold_symbol = "t_p",
                                    .missing = -1,
                                    .offset = no_offset};

constexpr std::array<ScoreKind, kEnumNames<Score>.size() + 1> kScoreKinds = {kRaw, kZScore,
                                                                             kProbability};

void prepare_zscores(const SequenceQuerySettings& settings, const TrainStatistics* statistics,
                     ScoreBasis& basis) {
  if (statistics == nullptr)
    throw Error(ErrorKind::usage,
                "the database has no training statistics for z-scores. Train it again.");
  assert(statistics->components);
  const auto* filter = std::get_if<Filter>(&settings.rule);
  basis = make_score_basis(*statistics,
                           filter != nullptr ? filter->settings.start_weight : kStartWeight);
}

StartedStage start_zscore_stage(const std::shared_ptr<const ScoreBasis>& basis) {
  const auto state = std::make_shared<std::shared_ptr<ZScoreState>>();
  return {[=](FrameDistances input, std::span<const size_t> kept) {
            if (*state == nullptr)
              *state = start_zscores(std::move(input), *basis);
            else
              continue_zscores(**state, std::move(input), kept);
            return zscores(*state);
          },
          [=] { return *state == nullptr ? std::vector<size_t>{} : (*state)->keyframes.pending; }};
}

StartedStage start_past_stage(const std::shared_ptr<const ScoreBasis>&) {
  return {
      [](FrameDistances input, std::span<const size_t>) { return past_zscores(std::move(input)); }};
}

constexpr std::array<ScoreStage, 2> kScoreStages = {
    {{[](const SequenceQuerySettings& s) { return is_zscore(s.rule) && !s.past; }, prepare_zscores,
      start_zscore_stage},
     {[](const SequenceQuerySettings& s) { return is_zscore(s.rule) && s.past.has_value(); },
      [](const SequenceQuerySettings&, const TrainStatistics*, ScoreBasis&) {}, start_past_stage}}};

}  // namespace

std::span<const ScoreKind> score_kinds() { return kScoreKinds; }

const ScoreKind& score_kind(Score score) { return kScoreKinds[static_cast<size_t>(score)]; }

const ScoreKind& probability_kind() { return kScoreKinds.back(); }

uint32_t distance_limit(double threshold, double divisor) {
  assert(std::isfinite(threshold));
  if (!(threshold > 0)) return 0;
  if (divisor == 0) return 1;
  return smallest_refused(std::floor(threshold * divisor), [&](uint32_t distance) {
    return static_cast<double>(distance) / divisor < threshold;
  });
}

uint32_t score_limit(double threshold, size_t window_length) {
  assert(std::isfinite(threshold));
  const double estimate = std::floor(threshold * kScoreUnit * static_cast<double>(window_length)) +
                          static_cast<double>(score_offset(window_length));
  return smallest_refused(
      estimate, [&](uint32_t biased_sum) { return mean_z(biased_sum, window_length) < threshold; });
}

int64_t score_offset(size_t window_length) {
  assert(window_length <= kMaxScoredWindow);
  return static_cast<int64_t>(window_length) * kScoreBias;
}

double mean_z(uint32_t biased_sum, size_t window_length) {
  return static_cast<double>(biased_sum - score_offset(window_length)) /
         (kScoreUnit * static_cast<double>(window_length));
}

std::vector<StartedStage> ScoreStages::start() const {
  std::vector<StartedStage> started;
  for (const ScoreStage* stage : rows) started.push_back(stage->start(basis));
  return started;
}

ScoreStages stages_of(const SequenceQuerySettings& settings, const TrainStatistics* statistics) {
  ScoreStages stages;
  ScoreBasis basis;
  for (const ScoreStage& stage : kScoreStages) {
    if (!stage.is_chosen(settings)) continue;
    stage.prepare(settings, statistics, basis);
    stages.rows.push_back(&stage);
  }
  stages.basis = std::make_shared<const ScoreBasis>(std::move(basis));
  return stages;
}

FrameDistances scored(FrameDistances distances, const ScoreStages& stages) {
  if (!stages.rows.empty() && distances.past.empty()) distances = read_ahead(std::move(distances));
  for (const StartedStage& stage : stages.start())
    distances = stage.scores(std::move(distances), {});
  return distances;
}

}  // namespace vpr
