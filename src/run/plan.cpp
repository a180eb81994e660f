#include "run/plan.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"
#include "decide/overlapping_sequences.h"
#include "evaluate/loops.h"
#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/fastable.h"
#include "match/lsh.h"
#include "match/zscores.h"
#include "run/thresholds.h"
#include "run/train.h"
#include "truth/times.h"

namespace vpr {
namespace {

using SequencePairs = std::vector<std::pair<size_t, size_t>>;

constexpr std::string_view kAllDiffer = "none";
constexpr const char* kNoFabmap =
    "fusion_weight needs FAB-MAP's database of the training sequences, as in --fuse FABMAP.vprdb";
constexpr size_t kMostRecognitions = 4'000'000'000;  // clusters have 32-bit numbers
// Memory per recognition while recognitions are collected, sorted, clustered and written.
constexpr size_t kBytesPerRecognition = 64;

std::vector<std::string> names_of(std::span<const TrainSequence> sequences) {
  std::vector<std::string> names;
  for (const TrainSequence& train : sequences) names.push_back(train.sequence.name);
  return names;
}

void check_names(std::span<const TrainSequence> sequences, const SequenceQuerySettings& settings) {
  const std::vector<std::string> names = names_of(sequences);
  for (const std::string& name : settings.only_sequences)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error(ErrorKind::usage, fmt::format("the database has no sequence \"{}\"; it has {}",
                                                name, fmt::join(names, ", ")));
}

void check_descriptors(const DescriptorStore& trained, const DescriptorStore& queried,
                       uint64_t window_length) {
  const std::string_view name = trained.kind->name;
  if (name != queried.kind->name)
    throw Error(ErrorKind::data,
                fmt::format("the descriptors differ: the database has {}, the query {}. Describe "
                            "both alike.",
                            name, queried.kind->name));
  if (trained.shape() != queried.shape())
    throw Error(
        ErrorKind::data,
        fmt::format("descriptors of the database have {} {}, descriptors of the query {}. {}",
                    trained.shape().length, element_noun(trained.shape()), queried.shape().length,
                    queried.rows().size() == trained.shape().length
                        ? "Is the query's array transposed? Rows are frames."
                        : "Describe both alike."));
  check_sums(trained, window_length);
}

void plan_windows(QueryPlan& plan, const Monitor& monitor) {
  const size_t length = plan.match.window_length;
  const Sequence& query = plan.query_sequence;
  if (count_windows(readable_runs(plan.query), length) == 0)
    throw Error(ErrorKind::usage,
                fmt::format("the query {} has {}, but not {} consecutive readable ones (c_l). Use "
                            "a smaller --c-l.",
                            query.name, counted(query.frames, "frame"), length));
  plan.query_windows = query.frames - length + 1;
  if (!query.unreadable.empty())
    warn(monitor, fmt::format("{}: {} of {} {} and will never match", query.name,
                              query.unreadable.size(), counted(query.frames, "frame"),
                              plan.query.given ? "have no score" : "cannot be decoded"));
}

bool is_searched(const SequenceQuerySettings& settings, const std::string& name) {
  const auto& only = settings.only_sequences;
  return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
}

void plan_sequences(QueryPlan& plan, std::span<const TrainSequence> sequences,
                    const Monitor& monitor) {
  const size_t length = plan.match.window_length;
  bool any = false;
  for (size_t s = 0; s < plan.train.size(); ++s) {
    ComparedSequence& compared = plan.sequences.emplace_back();
    compared.sequence = without_frame_names(sequences[s].sequence);
    compared.windows = count_windows(readable_runs(plan.train[s]), length);
    compared.searched = is_searched(plan.settings, compared.sequence.name);
    if (!compared.searched) continue;
    any = any || compared.windows > 0;
    if (compared.windows == 0)
      warn(monitor, fmt::format("{}: cannot be recognized without {} consecutive readable frames "
                                "(c_l)",
                                compared.sequence.name, length));
  }
  if (!any)
    throw Error(ErrorKind::usage,
                fmt::format("no training sequence has {} consecutive readable frames. Use a "
                            "smaller --c-l.",
                            length));
}

// The exclusion radius of every sequence: the setting, the stored or the computed one.
std::vector<uint32_t> radii_of(const SequenceDatabase& database,
                               const std::optional<uint64_t>& radius, const Monitor& monitor) {
  const std::vector<DescribedFrames> spans = descriptor_spans(database);
  std::vector<uint32_t> radii;
  for (size_t s = 0; s < spans.size(); ++s) {
    const auto& stored = database.sequences[s].exclusion_radius;
    const size_t chosen = radius ? *radius : stored ? *stored : exclusion_radius(spans[s], monitor);
    radii.push_back(static_cast<uint32_t>(std::min(chosen, spans[s].rows.size())));
  }
  return radii;
}

SequencePairs overlapping_sequences(const SequenceDatabase& database, const RowKernels& kernels,
                                    const Monitor& monitor) {
  if (database.overlapping_sequences) return *database.overlapping_sequences;
  return find_overlapping_sequences(descriptor_spans(database),
                                    radii_of(database, std::nullopt, monitor), kernels, monitor);
}

// Parses "A=B". Names may contain "=".
std::pair<size_t, size_t> pair_of(const std::string& text, const std::vector<std::string>& names) {
  const auto index_of = [&](std::string_view name) {
    return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  for (size_t at = text.find('='); at != std::string::npos; at = text.find('=', at + 1)) {
    const size_t a = index_of(std::string_view(text).substr(0, at));
    const size_t b = index_of(std::string_view(text).substr(at + 1));
    if (a < names.size() && b < names.size() && a != b) return std::minmax(a, b);
  }
  throw Error(ErrorKind::usage,
              fmt::format("same_place \"{}\" is neither {} nor a pair A=B of training sequences; "
                          "the database has {}",
                          text, kAllDiffer, fmt::join(names, ", ")));
}

SequencePairs declared_pairs(const SequenceDatabase& database,
                             const std::vector<std::string>& same_place) {
  SequencePairs pairs;
  if (same_place.size() == 1 && same_place.front() == kAllDiffer) return pairs;
  for (const std::string& text : same_place)
    pairs.push_back(pair_of(text, names_of(database.sequences)));
  return pairs;
}

// The margin of every sequence: the setting, or the default of the score.
void plan_margins(QueryPlan& plan, const SequenceDatabase& database, const Monitor& monitor) {
  const auto& setting = plan.settings.margin;
  for (size_t s = 0; s < plan.sequences.size(); ++s) {
    ComparedSequence& compared = plan.sequences[s];
    if (!compared.searched || compared.windows == 0) continue;
    compared.margin =
        setting
            ? *setting
            : score_kind(plan.settings.score)
                  .default_margin(typical_distance(database.sequences[s], plan.train[s], monitor),
                                  plan.match.window_length);
  }
}

// The table of the database, or a new one. Closest windows of several rates depend on the settings
// and are computed for each query.
ThresholdTable automatic_table(const QueryPlan& plan, const SequenceDatabase& database,
                               const Monitor& monitor) {
  const size_t length = plan.match.window_length;
  MatchSettings match{length, plan.match.memory_limit, plan.match.kernels};
  match.rates = plan.match.rates;
  const ThresholdTable* stored =
      match.rates.empty() ? find_thresholds(database.thresholds, length) : nullptr;
  if (stored == nullptr && match.rates.empty() && is_left_to_queries(plan.train))
    warn(monitor, fmt::format("the database has no automatic t_r for c_l {}: computing it, which "
                              "takes a while; vpr-tune threshold DB --c-l {} --write stores it",
                              length, length));
  const bool has_factor = match.rates.empty() && !database.thresholds.empty();
  const double factor = has_factor ? database.thresholds.front().safety_factor : 1;
  ThresholdTable table =
      stored != nullptr
          ? *stored
          : ThresholdTable{length, factor,
                           find_closest_windows(descriptor_spans(database), match, monitor)};
  table.safety_factor = plan.settings.safety_factor.value_or(table.safety_factor);
  return table;
}

void plan_automatic_thresholds(QueryPlan& plan, const SequenceDatabase& database,
                               const Monitor& monitor) {
  check_automatic(database, plan.settings);
  const ThresholdTable table = automatic_table(plan, database, monitor);
  std::vector<std::string> without;  // sequences that have windows, but no t_r
  bool any = false;
  for (size_t s = 0; s < plan.sequences.size(); ++s) {
    ComparedSequence& sequence = plan.sequences[s];
    if (!sequence.searched || sequence.windows == 0) continue;
    sequence.threshold = automatic_threshold(table, s);
    any = any || sequence.threshold;
    if (!sequence.threshold) without.push_back(sequence.sequence.name);
  }
  if (!any)
    throw Error(ErrorKind::usage,
                fmt::format("the automatic t_r needs two training sequences with windows of {} "
                            "frames (c_l). Use a smaller --c-l, or a number, as in --t-r 0.6.",
                            table.window_length));
  if (!without.empty())
    warn(monitor, fmt::format("{}: cannot be recognized without an automatic t_r, because no other "
                              "training sequence has a window to compare with",
                              fmt::join(without, ", ")));
  warn_of_overlaps(database, table, monitor);
}

// Thresholds, and the limits that need no distances: of automatic thresholds, and of numbers that
// are not relative.
void plan_thresholds(QueryPlan& plan, const SequenceDatabase& database, const Monitor& monitor) {
  const SequenceQuerySettings& settings = plan.settings;
  const size_t length = plan.match.window_length;
  if (settings.distance_threshold || settings.loop) {
    for (ComparedSequence& sequence : plan.sequences) {
      sequence.threshold = settings.distance_threshold;
      sequence.scale = scale_of(settings);
    }
  } else if (!plan.query.given) {  // a matrix has no automatic threshold
    plan_automatic_thresholds(plan, database, monitor);
  }
  for (ComparedSequence& sequence : plan.sequences) {
    if (!sequence.threshold) continue;
    if (sequence.scale == ThresholdScale::bits)
      sequence.distance_limit = distance_limit(*sequence.threshold, static_cast<double>(length));
    if (sequence.scale == ThresholdScale::mean_z)
      sequence.distance_limit = score_limit(*sequence.threshold, length);
  }
}

// The plan without windows, sequences and limits. `queried`: the descriptors of the query.
QueryPlan begin_plan(const SequenceDatabase& database, const DescriptorStore& queried,
                     const DescribedFrames& query, const Sequence& sequence,
                     const std::string& query_name, const ResolvedSettings& settings,
                     const QueryResources& resources) {
  check_names(database.sequences, *settings);
  check_descriptors(database.descriptors, queried, settings->window_length);
  QueryPlan plan;
  plan.settings = *settings;
  plan.query = query;
  plan.train = descriptor_spans(database);
  plan.query_sequence = sequence;
  plan.query_sequence.name = query_name;
  plan.query_sequence.frames = query.rows.size();
  plan.match = {settings->window_length, resources.memory_limit, resources.kernels,
                settings->lsh,           resources.seed,         parse_rates(settings->rates),
                settings->filter};
  plan.is_approximate = settings->method == kLshMethod;
  plan.match.method = &find_sequence_method(plan.is_approximate ? "fastable" : settings->method);
  const TrainStatistics* statistics = database.statistics ? &*database.statistics : nullptr;
  if (auto basis = score_basis(statistics, *settings))
    plan.basis = std::make_shared<const ScoreBasis>(*std::move(basis));
  const bool has_zscores = score_kind(settings->score).needs_statistics;
  if (settings->loop && has_zscores) plan.past_zscores = settings->zscore;
  if (statistics != nullptr && !query.given) plan.typical_distance = statistics->typical_distance;
  if (statistics != nullptr && has_zscores)
    plan.statistics = {statistics->settings, statistics->typical_distance};
  return plan;
}

void plan_decision(QueryPlan& plan, const SequenceDatabase& database, const Monitor& monitor) {
  if (plan.settings.decision == Decision::margin)
    plan_margins(plan, database, monitor);
  else
    plan_thresholds(plan, database, monitor);
}

void finish_plan(QueryPlan& plan, const SequenceDatabase& database, const Monitor& monitor) {
  const SequenceQuerySettings& settings = plan.settings;
  plan_sequences(plan, database.sequences, monitor);
  if (!(plan.query.given || settings.loop) || settings.exclusion_frames) {
    plan.exclusion_zones = make_exclusion_zones(
        radii_of(database, settings.exclusion_frames, monitor),
        settings.same_place.empty() ? overlapping_sequences(database, plan.match.kernels, monitor)
                                    : declared_pairs(database, settings.same_place));
    plan.match.overlapping_sequences = plan.exclusion_zones->shared;
  }
  plan_decision(plan, database, monitor);
}

// Replaces the recognitions by the best matches with at least the margin of their sequence.
void decide_by_margin(Result& result) {
  result.recognitions.clear();
  for (size_t window = 0; window < result.best.size(); ++window) {
    const auto& best = result.best[window];
    if (!best) continue;
    const std::optional<double> least = result.sequences[best->sequence].margin;
    const std::optional<double> margin = frame_margin(result, window);
    if (least && margin && *margin >= *least) result.recognitions.push_back(*best);
  }
}

}  // namespace

void check_sums(const DescriptorStore& descriptors, uint64_t window_length) {
  const uint64_t longest =
      std::numeric_limits<int32_t>::max() / largest_distance(descriptors.shape());
  if (window_length > longest)
    throw Error(ErrorKind::usage, fmt::format("c_l must be at most {} for {} descriptors, found {}",
                                              longest, descriptors.kind->name, window_length));
}

void ensure_statistics(SequenceDatabase& database, const Monitor& monitor) {
  const std::vector<DescribedFrames> spans = descriptor_spans(database);
  if (!database.statistics) database.statistics = compute_statistics(spans, {}, monitor);
  if (!database.statistics->components)
    database.statistics->components =
        compute_components(spans, database.statistics->typical_distance, monitor);
}

void ensure_exclusion_zones(SequenceDatabase& database, const RowKernels& kernels,
                            const Monitor& monitor) {
  const std::vector<uint32_t> radii = radii_of(database, std::nullopt, monitor);
  for (size_t s = 0; s < radii.size(); ++s) database.sequences[s].exclusion_radius = radii[s];
  database.overlapping_sequences = overlapping_sequences(database, kernels, monitor);
}

std::optional<ScoreBasis> score_basis(const TrainStatistics* statistics,
                                      const SequenceQuerySettings& settings) {
  const ScoreKind& kind = score_kind(settings.score);
  if (!kind.needs_statistics || settings.loop) return std::nullopt;
  if (statistics == nullptr)
    throw Error(ErrorKind::usage,
                "the database has no training statistics for z-scores. Train it again.");
  assert(statistics->components);
  ZScoreSettings zscore = settings.zscore;
  if (has_paths(settings.method)) zscore.start_weight = settings.filter.start_weight;
  ScoreBasis basis = make_score_basis(zscore, kind.is_offline, *statistics);
  if (settings.fusion_weight) {
    if (statistics->fused == nullptr) throw Error(ErrorKind::usage, kNoFabmap);
    basis.fusion =
        make_fusion_basis(statistics->fused, *settings.fusion_weight, statistics->settings);
  }
  return basis;
}

SequenceDatabase open_database(const std::string& path, const ResolvedSettings& settings,
                               const std::string& fabmap, const Monitor& monitor) {
  SequenceDatabase database = read_sequence_database(path);
  if (settings.has(kLiveChoice) && database.descriptors.kind->is_imported)
    throw Error(ErrorKind::data,
                fmt::format("{}: holds imported descriptors, which cannot be computed for frames "
                            "that arrive",
                            path));
  // A sweep sets thresholds and margins itself.
  if (!settings.has(kSweepChoice)) check_automatic(database, *settings);
  if (score_kind(settings->score).needs_statistics) ensure_statistics(database, monitor);
  if (!fabmap.empty())
    fuse_views(database, read_fabmap_database(fabmap), fabmap);
  else if (settings->fusion_weight)
    throw Error(ErrorKind::usage, kNoFabmap);
  return database;
}

void warn_of_rates(const SequenceDatabase& database, std::optional<double> query_fps,
                   const SequenceQuerySettings& settings, const Monitor& monitor) {
  constexpr double kAlike = 1.1;
  const bool has_windows = settings.window_length > 1 && settings.rates.empty();
  if (!query_fps || !has_windows || has_paths(settings.method)) return;
  for (const TrainSequence& train : database.sequences) {
    const Sequence& sequence = train.sequence;
    if (!sequence.fps || !is_searched(settings, sequence.name)) continue;
    const auto [slow, fast] = std::minmax(*sequence.fps, *query_fps);
    if (fast <= kAlike * slow) continue;
    return warn(monitor,
                fmt::format("the query has {:.3g} frames per second, the training sequence {} has "
                            "{:.3g}: their windows have different durations. Use --fps {:.3g} for "
                            "{}, or --method filter, which estimates the rate.",
                            *query_fps, sequence.name, *sequence.fps, slow,
                            slow == *query_fps ? "vpr-train" : "the query"));
  }
}

DescriptorSet describe_query(const SequenceArgument& query, const SequenceDatabase& database,
                             const ResolvedSettings& settings, const Monitor& monitor) {
  DescriptorSet described =
      describe_frames(open_sequence(query), database, settings->skip_unreadable, monitor);
  warn_of_rates(database, described.sequence.fps, *settings, monitor);
  return described;
}

QueryPlan plan_query(const SequenceDatabase& database, const DescriptorSet& query,
                     const std::string& query_name, const ResolvedSettings& settings,
                     const QueryResources& resources, const Monitor& monitor) {
  assert(!settings->loop);
  QueryPlan plan = begin_plan(database, query.descriptors, query.span(), query.sequence, query_name,
                              settings, resources);
  plan_windows(plan, monitor);
  finish_plan(plan, database, monitor);
  return plan;
}

QueryPlan with_limit(const QueryPlan& plan, const SequenceDatabase& database,
                     const ResolvedSettings& settings, const Monitor& monitor) {
  QueryPlan changed = plan;
  changed.settings = *settings;
  for (ComparedSequence& sequence : changed.sequences) {
    sequence.threshold.reset();
    sequence.scale = ThresholdScale::bits;
    sequence.distance_limit = 0;
    sequence.margin.reset();
  }
  plan_decision(changed, database, monitor);
  return changed;
}

QueryPlan plan_loop(const SequenceDatabase& database, const DescriptorSet& query,
                    const std::string& query_name, const ResolvedSettings& settings,
                    std::span<const int64_t> times_ns, const QueryResources& resources,
                    const Monitor& monitor) {
  assert(settings->loop && query.sequence.selection.is_all());
  QueryPlan plan = begin_plan(database, query.descriptors, query.span(), query.sequence, query_name,
                              settings, resources);
  plan.settings.descriptor = query.descriptors.kind->name;
  LoopGap gap{std::nullopt, settings->loop_gap};
  if (gap.frames == 0) gap.nanoseconds = std::llround(settings->loop_gap_s * double{kSecond});
  plan.past = past_frames(gap, times_ns, query.rows().size());
  plan_windows(plan, monitor);
  finish_plan(plan, database, monitor);
  if (plan.past.back() < plan.match.window_length)
    warn(monitor, fmt::format("{}: no two windows of {} frames are that far apart. Use a smaller "
                              "--gap.",
                              query_name, plan.match.window_length));
  return plan;
}

QueryPlan plan_window(const SequenceDatabase& database, const std::string& query_name,
                      const ResolvedSettings& settings, const QueryResources& resources,
                      const Monitor& monitor) {
  assert(!settings->loop);
  const DescribedFrames no_frame{{database.descriptors.rows().shape, {}}, {}};
  QueryPlan plan =
      begin_plan(database, database.descriptors, no_frame, {}, query_name, settings, resources);
  plan.query_sequence.frames = plan.match.window_length;
  plan.query_windows = 1;
  finish_plan(plan, database, monitor);
  return plan;
}

FrameDistances searched_distances(const QueryPlan& plan) {
  FrameDistances distances = frame_distances(plan.train, plan.query);
  std::erase_if(distances.train_runs,
                [&](const FrameRun& run) { return !plan.sequences[run.sequence].searched; });
  distances.past = plan.past;
  return distances;
}

FrameDistances scored(FrameDistances distances, const QueryPlan& plan, const Monitor& monitor) {
  if (plan.past_zscores) return past_zscores(std::move(distances), *plan.past_zscores);
  if (plan.basis) return zscores(std::move(distances), *plan.basis, monitor);
  return distances;
}

bool needs_maxima(const QueryPlan& plan) {
  return std::any_of(plan.sequences.begin(), plan.sequences.end(),
                     [](const ComparedSequence& sequence) {
                       return sequence.threshold && sequence.scale == ThresholdScale::relative;
                     });
}

void set_relative_limits(QueryPlan& plan, const std::vector<uint32_t>& maxima) {
  for (size_t s = 0; s < plan.sequences.size(); ++s) {
    ComparedSequence& sequence = plan.sequences[s];
    if (!sequence.searched || sequence.windows == 0) continue;
    sequence.max_distance = maxima[s];
    sequence.distance_limit = distance_limit(*sequence.threshold, maxima[s]);
  }
}

RecognitionScanSettings scan_settings(const QueryPlan& plan, const QueryResources& resources) {
  RecognitionScanSettings settings;
  for (const ComparedSequence& sequence : plan.sequences)
    settings.limits.push_back(sequence.distance_limit);
  settings.query_windows = plan.query_windows;
  settings.max_recognitions =
      std::min(resources.memory_limit / kBytesPerRecognition, kMostRecognitions);
  settings.kernels = resources.kernels;
  return settings;
}

Match match_of(const Cell& cell, const QueryPlan& plan) {
  return {cell.query_window, cell.sequence, cell.train_window, 0,
          static_cast<double>(cell.score - plan.score_offset())};
}

Result make_result(const QueryPlan& plan, const RecognitionScanResult& found,
                   const std::vector<std::optional<uint32_t>>& margins) {
  Result result;
  result.settings = plan.settings;
  result.query = plan.query_sequence;
  result.query_windows = plan.query_windows;
  result.sequences = plan.sequences;
  result.statistics = plan.statistics;
  result.recognitions.reserve(found.recognitions.size());
  for (const Cell& cell : found.recognitions) result.recognitions.push_back(match_of(cell, plan));
  for (const auto& best : found.best)
    result.best.push_back(best ? std::optional(match_of(*best, plan)) : std::nullopt);
  const std::vector<Rate>& rates = plan.match.rates;
  for (size_t window = 0; !rates.empty() && window < found.best.size(); ++window) {
    const auto& best = found.best[window];
    result.best_rates.push_back(best ? ratio_of(rates[best->rate])
                                     : std::numeric_limits<double>::quiet_NaN());
  }
  result.margins.assign(margins.begin(), margins.end());
  if (plan.settings.decision == Decision::margin) decide_by_margin(result);
  return result;
}

}  // namespace vpr
