#include "truth/ground_truth.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/named_table.h"
#include "base/text.h"
#include "truth/readers.h"

namespace vpr {

using Pair = GroundTruth::Pair;

namespace {

// maximum number of pairs for the check of symmetry
constexpr uint64_t kMaxCompared = uint64_t{1} << 26;

// The number of frames in the union of the runs; sorts them.
uint64_t covered_frames(std::vector<LabelStretch>& runs) {
  std::ranges::sort(runs, {}, &LabelStretch::first);
  uint64_t covered = 0;
  size_t end = 0;
  for (const LabelStretch& run : runs) {
    if (run.last < end) continue;
    covered += run.last + 1 - std::max(end, run.first);
    end = run.last + 1;
  }
  return covered;
}

// Throws Error(data) if FAB-MAP's places are not those that the ground truth counts.
void require_places(const GroundTruthArgument& argument, const GroundTruthScope& scope) {
  const auto counted_place = std::ranges::mismatch(argument.places, scope.places).in1;
  if (scope.places.empty() || counted_place == argument.places.end()) return;
  const auto names = [](std::span<const std::string> places) {
    constexpr size_t kNamed = 4;
    return fmt::format("{}{}",
                       fmt::join(places.first(std::min<size_t>(kNamed, places.size())), ", "),
                       places.size() > kNamed ? ", ..." : "");
  };
  throw Error(ErrorKind::data,
              "{}: counts the places {} of the data set, but the database has {}. Train it with "
              "the places of the data set, in their order",
              argument.path.string(), names(argument.places), names(scope.places));
}

InspectedGroundTruth read_recorded(GroundTruthArgument argument, const GroundTruthScope& scope,
                                   InconsistentPairs inconsistent, const Monitor& monitor) {
  if (argument.tolerance_frames < 0)
    throw Error(ErrorKind::usage, "the tolerance must be 0 frames or more, found {}",
                argument.tolerance_frames);
  const GroundTruthPreset* preset = find_preset(argument.format);
  if (preset != nullptr) argument = preset_argument(*preset, argument, scope);
  require_places(argument, scope);
  if (argument.tolerance_frames != 0 && scope.has_places)
    throw Error(
        ErrorKind::usage,
        "the tolerance counts training frames, but places of FAB-MAP have no order. Omit it");
  const GroundTruthFormat& format =
      argument.format.empty() ? detect_format(argument.path) : find_format(argument.format);
  require_options(format, argument);
  GroundTruthBuilder builder(argument, format.name, scope, inconsistent, monitor);
  std::string protocol = format.read(builder);
  if (preset != nullptr)
    protocol = fmt::format("{} ({}): {}", preset->name, preset->source, protocol);
  InspectedGroundTruth result = builder.finish(protocol);
  result.format = format.name;
  return result;
}

// Copies the labels of each recorded frame to all frames that repeat it.
InspectedGroundTruth read(const GroundTruthArgument& argument, const GroundTruthScope& scope,
                          InconsistentPairs inconsistent, const Monitor& monitor) {
  InspectedGroundTruth result = read_recorded(argument, recorded(scope), inconsistent, monitor);
  if (const Selection& selection = scope.query.selection; !selection.is_all()) {
    result.truth.pairs = selected(std::move(result.truth.pairs), selection);
    if (!result.truth.asked.empty())
      result.truth.asked = selected(std::move(result.truth.asked), selection);
    result.truth.protocol += ", query " + selection_text(selection);
    result.scope.query = scope.query;
  }
  const auto part = std::ranges::find_if(
      scope.sequences, [](const auto& train) { return !train.sequence.selection.is_all(); });
  if (part != scope.sequences.end()) {
    select_train_frames(result.truth, scope);
    result.truth.protocol += ", training frames " + selection_text(part->sequence.selection);
    result.scope.sequences = scope.sequences;
  }
  return result;
}

Pair pair_of(size_t sequence, const LabelStretch& run) {
  return {static_cast<uint32_t>(sequence), static_cast<uint32_t>(run.first), run.label,
          static_cast<uint32_t>(run.last - run.first)};
}

// Appends a run, or extends the last one.
void append(std::vector<LabelStretch>& runs, const LabelStretch& run) {
  if (!runs.empty() && runs.back().label == run.label && run.first <= runs.back().last + 1)
    runs.back().last = std::max(runs.back().last, run.last);
  else
    runs.push_back(run);
}

// Runs of one label, extended by `reach` frames at both ends within the sequence.
std::vector<LabelStretch> widened_runs(std::span<const Pair> pairs, size_t frames, PlaceLabel label,
                                       int64_t reach) {
  std::vector<LabelStretch> runs;
  for (const Pair& pair : pairs) {
    if (pair.label != label) continue;
    const int64_t first = std::max<int64_t>(0, pair.first - reach);
    const int64_t end = std::min(static_cast<int64_t>(frames), pair.last() + reach + 1);
    if (first < end)
      append(runs, {static_cast<size_t>(first), static_cast<size_t>(end - 1), label});
  }
  return runs;
}

// The run among the selected frames. If none of them is in the run: the selected frame nearest to a
// run of the same place, or nullopt.
std::optional<LabelStretch> selected_run(const LabelStretch& run,
                                         const std::vector<uint32_t>& sources) {
  const auto first =
      static_cast<size_t>(std::ranges::lower_bound(sources, run.first) - sources.begin());
  const auto end =
      static_cast<size_t>(std::ranges::upper_bound(sources, run.last) - sources.begin());
  if (first < end) return LabelStretch{first, end - 1, run.label};
  if (run.label != PlaceLabel::same) return std::nullopt;
  const bool is_before =
      end == sources.size() || (end > 0 && run.first - sources[end - 1] <= sources[end] - run.last);
  const size_t nearest = is_before ? end - 1 : end;
  return LabelStretch{nearest, nearest, run.label};
}

}  // namespace

std::span<const Pair> GroundTruth::pairs_of(size_t query, size_t sequence) const {
  const auto& row = pairs[query];
  return {std::ranges::lower_bound(row, sequence, {}, &Pair::sequence),
          std::ranges::upper_bound(row, sequence, {}, &Pair::sequence)};
}

PlaceLabel GroundTruth::label(size_t query, size_t sequence, size_t reference) const {
  const auto& row = pairs[query];
  const auto wanted = static_cast<int64_t>(reference);
  // Runs are sorted and disjoint: those within the tolerance are contiguous, before the first one
  // that begins after it.
  auto run = std::upper_bound(row.begin(), row.end(), wanted + tolerance_frames,
                              [&](int64_t last_reached, const Pair& pair) {
                                return pair.sequence != sequence ? sequence < pair.sequence
                                                                 : last_reached < pair.first;
                              });
  PlaceLabel found = PlaceLabel::different;
  while (run != row.begin()) {
    --run;
    if (run->sequence != sequence || run->last() + tolerance_frames < wanted) break;
    if (run->label == PlaceLabel::same) return PlaceLabel::same;
    if (run->first <= wanted && wanted <= run->last()) found = PlaceLabel::ignore;
  }
  return found;
}

void GroundTruth::label_row(size_t query, size_t sequence, std::span<PlaceLabel> labels) const {
  std::ranges::fill(labels, PlaceLabel::different);
  for (const LabelStretch& run : label_runs(*this, query, sequence, labels.size()))
    std::ranges::fill(labels.subspan(run.first, run.last - run.first + 1), run.label);
}

bool GroundTruth::has_match(size_t query) const {
  if (!asked.empty()) return !asked[query].empty();
  return std::ranges::find(pairs[query], PlaceLabel::same, &Pair::label) != pairs[query].end();
}

GroundTruthScope recorded(GroundTruthScope scope) {
  const auto select_all = [](Sequence& sequence) {
    sequence.frames = sequence.recorded_frames();
    sequence.selection = {};
  };
  select_all(scope.query);
  for (auto& train : scope.sequences) select_all(train.sequence);
  return scope;
}

GroundTruth unknown_ground_truth(const GroundTruthScope& scope) {
  GroundTruth truth;
  truth.is_known = false;
  truth.protocol = "none";
  std::vector<Pair> all;
  for (size_t s = 0; s < scope.sequences.size(); ++s)
    if (const size_t frames = scope.sequences[s].sequence.frames;
        scope.sequences[s].searched && frames > 0)
      all.push_back(pair_of(s, {0, frames - 1, PlaceLabel::ignore}));
  truth.pairs.assign(scope.query.frames, all);
  return truth;
}

GroundTruth read_ground_truth(const GroundTruthArgument& argument, const GroundTruthScope& scope,
                              const Monitor& monitor) {
  return read(argument, scope, InconsistentPairs::refuse, monitor).truth;
}

InspectedGroundTruth inspect_ground_truth(const GroundTruthArgument& argument,
                                          const GroundTruthScope& scope, const Monitor& monitor) {
  return read(argument, scope, InconsistentPairs::count, monitor);
}

GroundTruthArgument parse_ground_truth_argument(const std::string& text, int tolerance_frames) {
  std::vector<std::string> words = names_of(ground_truth_presets());
  words.insert(words.begin(), "aligned");
  const std::string word = nearest(text, words);
  if (text == word) return {text, {}, tolerance_frames};
  if (text.starts_with(word + "@"))
    throw Error(ErrorKind::usage,
                "the ground truth {} has no range: its frames are counted in the sequences as "
                "passed. Select the same part of both, as in --train monday{}",
                word, text.substr(word.size()));
  // A known word with one or two typing errors is not taken for a path.
  std::error_code error;
  if (edit_distance(text, word) <= 2 && !std::filesystem::exists(text, error))
    throw Error(ErrorKind::usage,
                "the ground truth {} is neither a file nor a known name; did you mean {}?", text,
                word);
  return {"", text, tolerance_frames};
}

std::vector<LabelStretch> label_runs(const GroundTruth& truth, size_t query, size_t sequence,
                                     size_t frames) {
  const auto pairs = truth.pairs_of(query, sequence);
  const auto same = widened_runs(pairs, frames, PlaceLabel::same, truth.tolerance_frames);
  std::vector<LabelStretch> runs;
  auto next = same.begin();
  size_t free = 0;  // after the existing runs, which take precedence
  for (const LabelStretch& ignored : widened_runs(pairs, frames, PlaceLabel::ignore, 0)) {
    for (; next != same.end() && next->first <= ignored.last; ++next) {
      const size_t first = std::max(ignored.first, free);
      if (first < next->first) append(runs, {first, next->first - 1, ignored.label});
      append(runs, *next);
      free = next->last + 1;
    }
    const size_t first = std::max(ignored.first, free);
    if (first <= ignored.last) append(runs, {first, ignored.last, ignored.label});
  }
  for (; next != same.end(); ++next) append(runs, *next);
  return runs;
}

void select_train_frames(GroundTruth& truth, const GroundTruthScope& scope) {
  GroundTruth selected;
  selected.pairs.resize(truth.pairs.size());
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    std::vector<Pair> clean;
    for (size_t s = 0; s < scope.sequences.size(); ++s) {
      const Sequence& sequence = scope.sequences[s].sequence;
      std::vector<Pair>& row = selected.pairs[query];
      row.clear();
      for (const LabelStretch& run : label_runs(truth, query, s, sequence.recorded_frames()))
        if (sequence.selection.is_all())
          row.push_back(pair_of(s, run));
        else if (const auto found = selected_run(run, sequence.selection.sources))
          row.push_back(pair_of(s, *found));
      std::ranges::sort(row);
      // Without overlaps: a frame with both labels is `same`.
      for (const LabelStretch& run : label_runs(selected, query, s, sequence.frames))
        clean.push_back(pair_of(s, run));
    }
    selected.pairs[query] = std::move(clean);
  }
  for (auto& row : truth.asked)
    for (Pair& pair : row)
      if (const auto& selection = scope.sequences[pair.sequence].sequence.selection;
          !selection.is_all())
        pair.first = static_cast<uint32_t>(
            selected_run({pair.first, pair.first, PlaceLabel::same}, selection.sources)->first);
  truth.pairs = std::move(selected.pairs);
  truth.applied_tolerance_frames = std::exchange(truth.tolerance_frames, 0);
}

GroundTruthSummary summarize(const InspectedGroundTruth& ground_truth, const Monitor& monitor) {
  const GroundTruth& truth = ground_truth.truth;
  const auto& sequences = ground_truth.scope.sequences;
  GroundTruthSummary summary;
  summary.query_frames = truth.pairs.size();
  std::vector<std::vector<LabelStretch>> matched(sequences.size());
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    check_stop(monitor);
    uint64_t matches = 0;
    const auto& row = truth.pairs[query];
    for (auto pair = row.begin(); pair != row.end();) {
      const size_t s = pair->sequence;
      for (const LabelStretch& run : label_runs(truth, query, s, sequences[s].sequence.frames)) {
        const uint64_t count = run.last - run.first + 1;
        (run.label == PlaceLabel::same ? matches : summary.ignored) += count;
        if (run.label == PlaceLabel::same) matched[s].push_back(run);
      }
      pair = std::find_if(pair, row.end(), [&](const auto& other) { return other.sequence != s; });
    }
    summary.same += matches;
    if (matches == 0) ++summary.queries_without_match;
    summary.most_matches = std::max(summary.most_matches, matches);
  }
  for (size_t s = 0; s < sequences.size(); ++s) {
    summary.train_frames += sequences[s].sequence.frames;
    summary.train_frames_without_match += sequences[s].sequence.frames - covered_frames(matched[s]);
  }
  if (sequences.size() == 1 && sequences[0].sequence.frames == truth.pairs.size() &&
      summary.same <= kMaxCompared) {
    summary.one_sided = 0;
    for (size_t query = 0; query < truth.pairs.size(); ++query) {
      check_stop(monitor);
      for (const LabelStretch& run : label_runs(truth, query, 0, truth.pairs.size()))
        for (size_t reference = run.first; reference <= run.last; ++reference) {
          if (run.label != PlaceLabel::same || truth.label(reference, 0, query) == PlaceLabel::same)
            continue;
          if ((*summary.one_sided)++ < kMaxExamples)
            summary.one_sided_examples.push_back(
                fmt::format("query {} and reference {} are the same place, but query {} and "
                            "reference {} are not",
                            query, reference, reference, query));
        }
    }
  }
  return summary;
}

void require_undamaged(const InspectedGroundTruth& ground_truth, const std::string& name) {
  const auto finding = [&](FindingKind kind) -> const GroundTruthFinding& {
    return ground_truth.findings[static_cast<size_t>(kind)];
  };
  const GroundTruthFinding& outside = finding(FindingKind::out_of_range);
  const GroundTruthFinding& both = finding(FindingKind::contradiction);
  if (outside.count == 0 && both.count == 0) return;
  throw Error(ErrorKind::data,
              "{}: is damaged: {} out of range and {} with both labels (first: {})", name,
              counted(outside.count, "pair"), both.count,
              (outside.count > 0 ? outside : both).examples.front());
}

std::string ground_truth_fingerprint(const GroundTruth& truth, const GroundTruthScope& scope,
                                     const Monitor& monitor) {
  std::vector<char> counts(scope.sequences.size());
  for (size_t s = 0; s < counts.size(); ++s) counts[s] = scope.sequences[s].searched;
  for (const auto& row : truth.pairs)
    for (const Pair& pair : row) counts[pair.sequence] = true;
  std::vector<uint64_t> places;  // among the sequences that count
  uint64_t place = 0;
  for (const char is_counted : counts) places.push_back(is_counted ? place++ : place);
  ChecksumStream sum;
  const auto add = [&](const auto& numbers) { sum.add(std::as_bytes(std::span(numbers))); };
  add(std::array<uint64_t, 1>{truth.pairs.size()});
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    check_stop(monitor);
    const auto& row = truth.pairs[query];
    for (size_t i = 0; i < row.size();) {
      const size_t s = row[i].sequence;
      i += truth.pairs_of(query, s).size();
      for (const LabelStretch& run :
           label_runs(truth, query, s, scope.sequences[s].sequence.frames))
        add(std::array<uint64_t, 5>{query, places[s], run.first, run.last,
                                    static_cast<uint64_t>(run.label)});
    }
  }
  return sum.text();
}

}  // namespace vpr
