#include "truth/ground_truth.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/named_table.h"
#include "truth/builder.h"
#include "truth/formats.h"
#include "truth/presets.h"

namespace vpr {

namespace {

InspectedGroundTruth read_recorded(GroundTruthArgument argument, const GroundTruthScope& scope,
                                   InconsistentPairs inconsistent, const Monitor& monitor) {
  if (argument.tolerance_frames < 0)
    throw Error(ErrorKind::usage, fmt::format("the tolerance must be 0 frames or more, found {}",
                                              argument.tolerance_frames));
  const GroundTruthPreset* preset = find_preset(argument.format);
  if (preset != nullptr) argument = preset_argument(*preset, argument, scope);
  const GroundTruthFormat& format =
      argument.format.empty() ? detect_format(argument.path) : find_format(argument.format);
  require_options(format, argument);
  GroundTruthBuilder builder(argument, scope, inconsistent, monitor);
  const std::string protocol = format.read(builder);
  InspectedGroundTruth result =
      builder.finish(preset == nullptr ? protocol : preset_protocol(*preset, protocol));
  result.format = format.name;
  return result;
}

// The scope of the files: whole recordings.
GroundTruthScope recorded_scope(GroundTruthScope scope) {
  const auto whole = [](Sequence& sequence) {
    sequence.frames = sequence.recorded_frames();
    sequence.selection = {};
  };
  whole(scope.query);
  for (auto& train : scope.sequences) whole(train.sequence);
  return scope;
}

// Copies the labels of each recorded frame to all frames that repeat it.
InspectedGroundTruth read(const GroundTruthArgument& argument, const GroundTruthScope& scope,
                          InconsistentPairs inconsistent, const Monitor& monitor) {
  InspectedGroundTruth result =
      read_recorded(argument, recorded_scope(scope), inconsistent, monitor);
  if (const Selection& selection = scope.query.selection; !selection.is_all()) {
    result.truth.pairs = selected(std::move(result.truth.pairs), selection);
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

// Refuses an argument that is not a file but differs from a known word by one or two typing errors.
void refuse_mistyped_word(const std::string& text) {
  std::vector<std::string> words = names_of(ground_truth_presets());
  words.insert(words.begin(), "aligned");
  const std::string best = nearest(text, words);
  std::error_code error;
  if (edit_distance(text, best) <= 2 && !std::filesystem::exists(text, error))
    throw Error(
        ErrorKind::usage,
        fmt::format("the ground truth {} is neither a file nor a known name; did you mean {}?",
                    text, best));
}

// Appends a run, or extends the last one.
void append(std::vector<LabelRun>& runs, const LabelRun& run) {
  if (!runs.empty() && runs.back().label == run.label && run.first <= runs.back().last + 1)
    runs.back().last = std::max(runs.back().last, run.last);
  else
    runs.push_back(run);
}

// Runs of one label, extended by `reach` frames at both ends within the sequence.
std::vector<LabelRun> widened_runs(std::span<const GroundTruth::Pair> pairs, size_t frames,
                                   PlaceLabel label, int64_t reach) {
  std::vector<LabelRun> runs;
  for (const GroundTruth::Pair& pair : pairs) {
    if (pair.label != label) continue;
    const int64_t first = std::max<int64_t>(0, pair.first - reach);
    const int64_t end = std::min(static_cast<int64_t>(frames), pair.last() + reach + 1);
    if (first < end)
      append(runs, {static_cast<size_t>(first), static_cast<size_t>(end - 1), label});
  }
  return runs;
}

using Pair = GroundTruth::Pair;

// The selected frame nearest to a run without selected frames; `next` is the first one after it.
uint32_t nearest_selected(const std::vector<uint32_t>& sources, const LabelRun& run, size_t next) {
  if (next == sources.size()) return static_cast<uint32_t>(next - 1);
  if (next == 0) return 0;
  const bool is_before = run.first - sources[next - 1] <= sources[next] - run.last;
  return static_cast<uint32_t>(is_before ? next - 1 : next);
}

// Converts the runs of a recording to its selected frames.
void add_selected(std::vector<Pair>& row, uint32_t sequence, const std::vector<LabelRun>& runs,
                  const std::vector<uint32_t>& sources) {
  for (const LabelRun& run : runs) {
    const auto first = std::ranges::lower_bound(sources, run.first);
    const auto end = std::ranges::upper_bound(sources, run.last);
    const auto index = static_cast<uint32_t>(first - sources.begin());
    if (first != end)
      row.push_back({sequence, index, run.label, static_cast<uint32_t>(end - first - 1)});
    else if (run.label == PlaceLabel::same)
      row.push_back({sequence, nearest_selected(sources, run, index), run.label, 0});
  }
}

// Sorted and without duplicates; a frame with both labels is `same`.
std::vector<Pair> without_overlaps(std::vector<Pair> row, size_t sequence_frames) {
  GroundTruth one;
  std::sort(row.begin(), row.end());
  one.pairs = {std::move(row)};
  std::vector<Pair> clean;
  if (one.pairs[0].empty()) return clean;
  const uint32_t sequence = one.pairs[0].front().sequence;
  for (const LabelRun& run : label_runs(one, 0, sequence, sequence_frames))
    clean.push_back({sequence, static_cast<uint32_t>(run.first), run.label,
                     static_cast<uint32_t>(run.last - run.first)});
  return clean;
}

}  // namespace

std::span<const GroundTruth::Pair> GroundTruth::pairs_of(size_t query, size_t sequence) const {
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
  for (const LabelRun& run : label_runs(*this, query, sequence, labels.size()))
    std::ranges::fill(labels.subspan(run.first, run.last - run.first + 1), run.label);
}

bool GroundTruth::has_match(size_t query) const {
  return std::any_of(pairs[query].begin(), pairs[query].end(),
                     [](const Pair& pair) { return pair.label == PlaceLabel::same; });
}

GroundTruth unknown_ground_truth(const GroundTruthScope& scope) {
  GroundTruth truth;
  truth.is_known = false;
  truth.protocol = "none";
  std::vector<GroundTruth::Pair> all;
  for (size_t s = 0; s < scope.sequences.size(); ++s)
    if (const size_t frames = scope.sequences[s].sequence.frames;
        scope.sequences[s].searched && frames > 0)
      all.push_back(
          {static_cast<uint32_t>(s), 0, PlaceLabel::ignore, static_cast<uint32_t>(frames - 1)});
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
  const bool is_word = text == "aligned" || find_preset(text) != nullptr;
  if (!is_word) refuse_mistyped_word(text);
  return is_word ? GroundTruthArgument{text, {}, tolerance_frames}
                 : GroundTruthArgument{"", text, tolerance_frames};
}

std::vector<LabelRun> label_runs(const GroundTruth& truth, size_t query, size_t sequence,
                                 size_t frames) {
  const auto pairs = truth.pairs_of(query, sequence);
  const auto same = widened_runs(pairs, frames, PlaceLabel::same, truth.tolerance_frames);
  std::vector<LabelRun> runs;
  auto next = same.begin();
  size_t free = 0;  // after the existing runs, which take precedence
  for (const LabelRun& ignored : widened_runs(pairs, frames, PlaceLabel::ignore, 0)) {
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
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    std::vector<Pair> all;
    for (size_t s = 0; s < scope.sequences.size(); ++s) {
      const Sequence& sequence = scope.sequences[s].sequence;
      const auto runs = label_runs(truth, query, s, sequence.recorded_frames());
      std::vector<Pair> row;
      if (!sequence.selection.is_all()) {
        add_selected(row, static_cast<uint32_t>(s), runs, sequence.selection.sources);
      } else {
        for (const LabelRun& run : runs)
          row.push_back({static_cast<uint32_t>(s), static_cast<uint32_t>(run.first), run.label,
                         static_cast<uint32_t>(run.last - run.first)});
      }
      row = without_overlaps(std::move(row), sequence.frames);
      all.insert(all.end(), row.begin(), row.end());
    }
    truth.pairs[query] = std::move(all);
  }
  truth.tolerance_frames = 0;
}

}  // namespace vpr
