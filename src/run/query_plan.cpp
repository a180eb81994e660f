// What of a query is known before any distance is: plan_query.
#include <algorithm>
#include <cassert>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"
#include "match/rates.h"
#include "run/advice.h"
#include "run/fuse.h"
#include "run/loop_query.h"
#include "run/margin_plan.h"
#include "run/query.h"
#include "run/query_steps.h"
#include "run/score_basis.h"
#include "run/thresholds.h"
#include "run/train.h"

namespace vpr {
namespace {

void check_names(std::span<const TrainSequence> sequences, const SequenceQuerySettings& settings) {
  std::vector<std::string> names;
  for (const TrainSequence& train : sequences) names.push_back(train.sequence.name);
  for (const std::string& name : settings.only_sequences)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error(ErrorKind::usage, fmt::format("the database has no sequence \"{}\"; it has {}",
                                                name, fmt::join(names, ", ")));
}

bool is_searched(const SequenceQuerySettings& settings, const std::string& name) {
  const auto& only = settings.only_sequences;
  return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
}

void plan_windows(QueryPlan& plan, const Monitor& monitor) {
  const uint64_t length = plan.settings.window_length;
  const Sequence& query = plan.query_sequence;
  if (count_windows(readable_runs(plan.query), length) == 0)
    throw Error(ErrorKind::usage,
                fmt::format("the query {} has {}, and no {} readable ones in a row (c_l); "
                            "give a smaller --c-l",
                            query.name, counted(query.frames, "frame"), length));
  plan.query_windows = query.frames - length + 1;
  if (!query.unreadable.empty())
    warn(monitor, fmt::format("{}: {} of {} {} and will never match", query.name,
                              query.unreadable.size(), counted(query.frames, "frame"),
                              plan.query.given ? "have no score" : "can't be decoded"));
}

void plan_sequences(QueryPlan& plan, std::span<const TrainSequence> sequences,
                    const Monitor& monitor) {
  const uint64_t length = plan.settings.window_length;
  bool any = false;
  for (size_t s = 0; s < plan.train.size(); ++s) {
    Target& target = plan.sequences.emplace_back();
    target.sequence = sequences[s].sequence;
    target.sequence.frame_names.clear();  // a live query has a result for each frame
    target.windows = count_windows(readable_runs(plan.train[s]), length);
    target.searched = is_searched(plan.settings, target.sequence.name);
    if (!target.searched) continue;
    any = any || target.windows > 0;
    if (target.windows == 0)
      warn(monitor, fmt::format("{}: has no {} readable frames in a row (c_l), so it can't be "
                                "recognized",
                                target.sequence.name, length));
  }
  if (!any)
    throw Error(ErrorKind::usage,
                fmt::format("no training sequence has {} readable frames in a row; give a smaller "
                            "--c-l",
                            length));
}

ThresholdTable compute_table(const SequenceDatabase& database, const MatchSettings& match,
                             double safety_factor, const Monitor& monitor) {
  return {match.window_length, safety_factor,
          find_closest_windows(descriptor_spans(database), match, monitor)};
}

// What the database holds, or else computed. Closest windows of several rates depend on the
// settings, and are computed for each query.
ThresholdTable automatic_table(const QueryPlan& plan, const SequenceDatabase& database,
                               const QueryResources& resources, const Monitor& monitor) {
  const SequenceQuerySettings& settings = plan.settings;
  MatchSettings match{settings.window_length, resources.memory_limit, resources.kernels};
  match.rates = parse_rates(settings.rates);
  if (!match.rates.empty())
    return compute_table(database, match, settings.safety_factor.value_or(1), monitor);
  const ThresholdTable* stored = find_thresholds(database.thresholds, settings.window_length);
  if (stored == nullptr && is_left_to_queries(plan.train))
    warn(monitor, fmt::format("the database has no automatic t_r for c_l {}: computing it, which "
                              "takes a while; vpr-tune threshold DB --c-l {} --write keeps it",
                              settings.window_length, settings.window_length));
  const double factor = database.thresholds.empty() ? 1 : database.thresholds.front().safety_factor;
  ThresholdTable table =
      stored != nullptr ? *stored : compute_table(database, match, factor, monitor);
  table.safety_factor = settings.safety_factor.value_or(table.safety_factor);
  return table;
}

// A threshold that no windows of other places stand behind.
void warn_of_guess(const std::string& sequence, const SequenceQuerySettings& settings,
                   const Monitor& monitor) {
  warn(monitor,
       fmt::format(
           "{}: no windows of {} frames show other places, so its automatic t_r is the "
           "largest that one may be, which accepts wrong places; set a smaller --c-l, or use "
           "--method filter",
           sequence, settings.window_length));
}

void plan_automatic_thresholds(QueryPlan& plan, const SequenceDatabase& database,
                               const QueryResources& resources, const Monitor& monitor) {
  check_automatic(database, plan.settings);
  const AutomaticThresholds automatic =
      automatic_thresholds(database, automatic_table(plan, database, resources, monitor), monitor);
  warn_of_overlaps(database, automatic.table, monitor);
  for (size_t s = 0; s < plan.sequences.size(); ++s) {
    Target& sequence = plan.sequences[s];
    if (!sequence.searched || !automatic.sequences[s]) continue;
    sequence.threshold = automatic.sequences[s]->value;
    if (!automatic.table.closest[s]) warn_of_guess(sequence.sequence.name, plan.settings, monitor);
  }
}

void plan_thresholds(QueryPlan& plan, const SequenceDatabase& database,
                     const QueryResources& resources, const Monitor& monitor) {
  const SequenceQuerySettings& settings = plan.settings;
  if (!settings.distance_threshold && plan.query.given) return;  // there is no automatic one
  if (!settings.distance_threshold && !settings.loop)
    return plan_automatic_thresholds(plan, database, resources, monitor);
  for (Target& sequence : plan.sequences) {
    sequence.threshold = settings.distance_threshold;
    sequence.scale = scale_of(settings);
  }
}

// Limits that need no distances: automatic thresholds, and numbers that are not relative.
void plan_limits(QueryPlan& plan) {
  const uint64_t length = plan.settings.window_length;
  for (size_t s = 0; s < plan.train.size(); ++s) {
    Target& sequence = plan.sequences[s];
    if (!sequence.threshold) continue;
    if (sequence.scale == ThresholdScale::bits)
      sequence.distance_limit = distance_limit(*sequence.threshold, static_cast<double>(length));
    if (sequence.scale == ThresholdScale::mean_z)
      sequence.distance_limit = score_limit(*sequence.threshold, length);
  }
}

// Limits of all pairs, or margins of best matches.
void plan_decision(QueryPlan& plan, const SequenceDatabase& database,
                   const QueryResources& resources, const Monitor& monitor) {
  if (plan.settings.decision == Decision::margin)
    return plan_margins(plan, database, resources, monitor);
  plan_thresholds(plan, database, resources, monitor);
  plan_limits(plan);
}

// What is known without a frame of the query. `asked`: as its frames are described.
QueryPlan begin_plan(const SequenceDatabase& database, const DescriptorStore& asked,
                     const DescriptorSpan& query, const Sequence& sequence,
                     const std::string& query_name, const ResolvedSettings& settings) {
  check_names(database.sequences, *settings);
  check_descriptors(database.descriptors, asked, settings->window_length);
  QueryPlan plan;
  plan.settings = *settings;
  plan.query = query;
  plan.train = descriptor_spans(database);
  plan.learned = database.statistics ? &*database.statistics : nullptr;
  plan.query_sequence = sequence;
  plan.query_sequence.name = query_name;
  plan.query_sequence.frames = query.rows.size();
  return plan;
}

void finish_plan(QueryPlan& plan, const SequenceDatabase& database, const QueryResources& resources,
                 const Monitor& monitor) {
  const SequenceQuerySettings& settings = plan.settings;
  plan_sequences(plan, database.sequences, monitor);
  const bool has_widths = !(plan.query.given || settings.loop) || settings.margin_width;
  if (has_widths) plan.elsewhere = plan_elsewhere(database, settings, resources.kernels, monitor);
  plan_decision(plan, database, resources, monitor);
  if (score_kind(settings.score).needs_statistics && plan.learned != nullptr)
    plan.statistics = {plan.learned->settings, plan.learned->typical_distance};
}

}  // namespace

SequenceDatabase open_database(const std::string& path, const ResolvedSettings& settings,
                               const std::string& fabmap, const Monitor& monitor) {
  SequenceDatabase database = read_sequence_database(path);
  if (settings.has(kFollowChoice) && database.descriptors.kind->is_imported)
    throw Error(ErrorKind::data,
                fmt::format("{}: holds descriptors that were imported, and frames that come can't "
                            "be described so",
                            path));
  // A sweep sets thresholds and margins itself.
  const bool is_swept = settings.has(kSweepChoice);
  if (!is_swept) check_automatic(database, *settings);
  if (score_kind(settings->score).needs_statistics) ensure_statistics(database, monitor);
  fuse_views(database, *settings, fabmap);
  if (!is_swept) warn_of_automatic(*settings, monitor);
  return database;
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
  QueryPlan plan =
      begin_plan(database, query.descriptors, query.span(), query.sequence, query_name, settings);
  plan_windows(plan, monitor);
  finish_plan(plan, database, resources, monitor);
  return plan;
}

QueryPlan plan_loop(const SequenceDatabase& walk, const DescriptorSet& query,
                    const std::string& query_name, const ResolvedSettings& settings,
                    std::span<const int64_t> times_ns, const QueryResources& resources,
                    const Monitor& monitor) {
  assert(settings->loop && query.sequence.selection.is_all());
  QueryPlan plan =
      begin_plan(walk, query.descriptors, query.span(), query.sequence, query_name, settings);
  plan.settings.descriptor = query.descriptors.kind->name;
  plan.past = past_frames(loop_gap_of(*settings), times_ns, query.rows().size());
  plan_windows(plan, monitor);
  finish_plan(plan, walk, resources, monitor);
  if (plan.past.back() < plan.settings.window_length)
    warn(monitor, fmt::format("{}: no window of {} frames is so long before another; give a "
                              "smaller --loop-gap",
                              query_name, plan.settings.window_length));
  return plan;
}

QueryPlan plan_window(const SequenceDatabase& database, const std::string& query_name,
                      const ResolvedSettings& settings, const QueryResources& resources,
                      const Monitor& monitor) {
  assert(!settings->loop);
  const DescriptorSpan no_frame{{database.descriptors.rows().shape, {}}, {}};
  QueryPlan plan = begin_plan(database, database.descriptors, no_frame, {}, query_name, settings);
  plan.query_sequence.frames = plan.settings.window_length;
  plan.query_windows = 1;
  finish_plan(plan, database, resources, monitor);
  return plan;
}

}  // namespace vpr
