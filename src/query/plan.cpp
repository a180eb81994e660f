#include "query/plan.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "query/thresholds.h"
#include "query/train_sequences.h"
#include "truth/times.h"

namespace vpr {

void check_descriptors(const DescriptorStore& trained, const DescriptorStore& queried) {
  const std::string_view name = trained.kind->name;
  if (name != queried.kind->name)
    throw Error(ErrorKind::data,
                "the descriptors differ: the database has {}, the query {}. Describe both alike.",
                name, queried.kind->name);
  if (trained.shape() != queried.shape())
    throw Error(ErrorKind::data,
                "descriptors of the database have {} {}, descriptors of the query {}. {}",
                trained.shape().length, element_noun(trained.shape()), queried.shape().length,
                queried.rows().size() == trained.shape().length
                    ? "Is the query's array transposed? Rows are frames."
                    : "Describe both alike.");
}

namespace {

void plan_windows(QueryPlan& plan, const Monitor& monitor) {
  const size_t length = plan.match.window_length;
  const Sequence& query = plan.result.query;
  if (count_windows(readable_runs(plan.query), length) == 0)
    throw Error(
        ErrorKind::usage,
        "the query {} has {}, but not {} consecutive readable ones (c_l). Use a smaller --c-l.",
        query.name, counted(query.frames, "frame"), length);
  plan.result.query_windows = query.frames - length + 1;
  if (!query.unreadable.empty())
    warn(monitor, "{}: {} of {} cannot be decoded and will never match", query.name,
         query.unreadable.size(), counted(query.frames, "frame"));
}

void plan_sequences(QueryPlan& plan, std::span<const TrainSequence> sequences,
                    const SequenceQuerySettings& settings, const Monitor& monitor) {
  const size_t length = plan.match.window_length;
  bool any = false;
  for (size_t s = 0; s < plan.train.size(); ++s) {
    ComparedSequence& compared = plan.result.sequences.emplace_back();
    compared.sequence = sequences[s].sequence;
    compared.sequence.frame_names.clear();
    compared.windows = count_windows(readable_runs(plan.train[s]), length);
    compared.searched = is_searched(settings, compared.sequence.name);
    if (!compared.searched) continue;
    any = any || compared.windows > 0;
    if (compared.windows == 0)
      warn(monitor, "{}: cannot be recognized without {} consecutive readable frames (c_l)",
           compared.sequence.name, length);
  }
  if (!any)
    throw Error(ErrorKind::usage,
                "no training sequence has {} consecutive readable frames. Use a smaller --c-l.",
                length);
}

// The margin of every sequence: the setting, or the default of the score.
void plan_margins(QueryPlan& plan, const PreparedDatabase& database,
                  const std::optional<double>& setting) {
  for (size_t s = 0; s < plan.result.sequences.size(); ++s) {
    ComparedSequence& compared = plan.result.sequences[s];
    if (!compared.searched || compared.windows == 0) continue;
    compared.margin = setting ? *setting
                              : plan.result.score().default_margin(database.typical_distances[s],
                                                                   plan.match.window_length);
  }
}

void plan_automatic_thresholds(QueryPlan& plan, const PreparedDatabase& database,
                               const std::optional<double>& safety_factor, const Monitor& monitor) {
  ThresholdTable table = database.thresholds.value();
  table.safety_factor = safety_factor.value_or(table.safety_factor);
  bool any = false;
  for (size_t s = 0; s < plan.result.sequences.size(); ++s) {
    ComparedSequence& sequence = plan.result.sequences[s];
    if (!sequence.searched || sequence.windows == 0) continue;
    sequence.threshold = automatic_threshold(table, s);
    any = any || sequence.threshold;
  }
  if (!any)
    throw Error(ErrorKind::usage,
                "the automatic t_r needs two training sequences with windows of {} frames (c_l). "
                "Use a smaller --c-l, or a number for --t-r.",
                table.window_length);
  if (const auto sentence =
          overlap_warning(table, database.database->sequences, code_spans(*database.database)))
    warn(monitor, *sentence);
}

// Thresholds, and the limits that need no distances: of automatic thresholds, and of numbers that
// are not relative. `threshold`: t_r of the rule.
void plan_thresholds(QueryPlan& plan, const PreparedDatabase& database,
                     const SequenceQuerySettings& settings, const std::optional<double>& threshold,
                     const std::optional<double>& safety_factor, const Monitor& monitor) {
  const size_t length = plan.match.window_length;
  if (has_automatic_threshold(settings)) {
    plan_automatic_thresholds(plan, database, safety_factor, monitor);
  } else {
    for (ComparedSequence& sequence : plan.result.sequences) {
      sequence.threshold = threshold;
      sequence.scale = *scale_of(settings);
    }
  }
  plan.decision = ByThreshold{};
  for (ComparedSequence& sequence : plan.result.sequences) {
    if (!sequence.threshold) continue;
    if (sequence.scale == ThresholdScale::bits)
      sequence.distance_limit = distance_limit(*sequence.threshold, static_cast<double>(length));
    if (sequence.scale == ThresholdScale::mean_z)
      sequence.distance_limit = score_limit(*sequence.threshold, length);
  }
}

/// Plans the decision of a rule.
struct DecisionPlanner {
  QueryPlan& plan;
  const PreparedDatabase& database;
  const SequenceQuerySettings& settings;
  const Monitor& monitor;

  void operator()(const Threshold& rule) const {
    plan_thresholds(plan, database, settings, rule.threshold, rule.safety_factor, monitor);
  }
  void operator()(const Lsh& rule) const {
    plan_thresholds(plan, database, settings, rule.threshold, rule.safety_factor, monitor);
  }
  void operator()(const Margin& rule) const {
    plan_margins(plan, database, rule.margin);
    plan.decision = ByMargin{};
  }
  void operator()(const Filter& rule) const {
    plan_margins(plan, database, rule.margin);
    const double units = std::ceil(rule.margin / plan.result.score().frame_value(1, 1));
    ByPath decision{static_cast<uint32_t>(std::max(units, 1.0))};  // 0: no margin yet
    if (FeatureChoice choose = tested_frames(*database.database, rule))
      decision.witness.emplace(std::make_shared<const TrainWitness>(database), std::move(choose),
                               decision.least_margin);
    else
      std::get<Filter>(std::get<SequenceQuerySettings>(plan.result.settings).rule).witness =
          Witness::none;
    plan.decision = std::move(decision);
  }
};

void plan_decision(QueryPlan& plan, const PreparedDatabase& database,
                   const SequenceQuerySettings& settings, const Monitor& monitor) {
  std::visit(DecisionPlanner{plan, database, settings, monitor}, settings.rule);
}

MatchSettings match_settings(const Rule& rule, const QueryResources& resources) {
  MatchSettings match{window_length_of(rule), resources.memory_limit};
  match.seed = resources.seed;
  match.method = &find_sequence_method(method_of(rule));
  if (const auto* lsh = std::get_if<Lsh>(&rule)) match.lsh = lsh->settings;
  if (const auto* filter = std::get_if<Filter>(&rule)) match.filter = filter->settings;
  return match;
}

// The plan without windows, sequences and limits. `query`: described like the database.
QueryPlan begin_plan(const PreparedDatabase& database, const DescribedFrames& query,
                     const Sequence& sequence, const std::string& query_name,
                     const SequenceQuerySettings& settings, const QueryResources& resources) {
  QueryPlan plan;
  plan.result.settings = settings;
  plan.result.query = sequence;
  plan.result.query.name = query_name;
  plan.result.query.frames = query.rows.size();
  const bool is_raw = !is_zscore(settings.rule);
  plan.query = query;
  if (is_raw) plan.query.rows = codes_of(query.rows);
  plan.train = database.train;
  plan.exclusion_zones = database.exclusion_zones;
  plan.match = match_settings(settings.rule, resources);
  if (plan.exclusion_zones) plan.match.overlapping_sequences = plan.exclusion_zones->overlaps;
  plan.match.passes = database.passes;
  const auto& stored = database.database->statistics;
  const TrainStatistics* statistics = stored ? &*stored : nullptr;
  plan.scores = stages_of(settings, statistics);
  if (statistics != nullptr)
    plan.typical_distance = is_raw
                                ? statistics->code_distance.value_or(statistics->typical_distance)
                                : statistics->typical_distance;
  if (statistics != nullptr && plan.result.score().needs_statistics)
    plan.result.statistics = {statistics->settings, statistics->typical_distance};
  return plan;
}

LoopGap loop_gap(const OwnPast& past) {
  if (const auto* frames = std::get_if<uint64_t>(&past.gap)) return {std::nullopt, *frames};
  return {std::llround(std::get<double>(past.gap) * double{kSecond}), 0};
}

}  // namespace

QueryPlan plan_query(const PreparedDatabase& database, const DescriptorSet& query,
                     const std::string& query_name, const SequenceQuerySettings& settings,
                     const QueryResources& resources, const Monitor& monitor,
                     std::span<const int64_t> times_ns) {
  check_descriptors(database.database->descriptors, query.descriptors);
  QueryPlan plan =
      begin_plan(database, query.span(), query.sequence, query_name, settings, resources);
  if (settings.past) {
    assert(query.sequence.selection.is_all());
    plan.result.past = past_frames(loop_gap(*settings.past), times_ns, query.rows().size());
  }
  plan_windows(plan, monitor);
  plan_sequences(plan, database.database->sequences, settings, monitor);
  plan_decision(plan, database, settings, monitor);
  plan.features_of = query.features_of;
  return plan;
}

QueryPlan with_limit(const QueryPlan& plan, const PreparedDatabase& database,
                     const SequenceQuerySettings& settings, const Monitor& monitor) {
  QueryPlan changed = plan;
  changed.result.settings = settings;
  for (ComparedSequence& sequence : changed.result.sequences) {
    sequence.threshold.reset();
    sequence.scale = ThresholdScale::bits;
    sequence.distance_limit = 0;
    sequence.margin.reset();
  }
  plan_decision(changed, database, settings, monitor);
  return changed;
}

QueryPlan plan_window(const PreparedDatabase& database, const std::string& query_name,
                      const SequenceQuerySettings& settings, const QueryResources& resources,
                      const Monitor& monitor) {
  assert(!settings.past);
  const DescribedFrames no_frame{{database.database->descriptors.rows().shape, {}}, {}};
  QueryPlan plan = begin_plan(database, no_frame, {}, query_name, settings, resources);
  plan.result.query.frames = plan.match.window_length;
  plan.result.query_windows = 1;
  plan_sequences(plan, database.database->sequences, settings, monitor);
  plan_decision(plan, database, settings, monitor);
  return plan;
}

bool needs_maxima(const QueryPlan& plan) {
  return std::ranges::any_of(plan.result.sequences, [](const ComparedSequence& sequence) {
    return sequence.threshold && sequence.scale == ThresholdScale::relative;
  });
}

void set_relative_limits(QueryPlan& plan, const std::vector<uint32_t>& maxima) {
  for (size_t s = 0; s < plan.result.sequences.size(); ++s) {
    ComparedSequence& sequence = plan.result.sequences[s];
    if (!sequence.searched || sequence.windows == 0) continue;
    sequence.max_distance = maxima[s];
    sequence.distance_limit = distance_limit(*sequence.threshold, maxima[s]);
  }
}

}  // namespace vpr
