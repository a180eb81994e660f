#include <algorithm>

#include <fmt/format.h>

#include "base/text.h"
#include "recordings/sequence.h"
#include "truth/readers.h"

namespace vpr {

namespace {

/// 16 bytes each. A matrix of 10 000 x 10 000 has a few runs per row, unless it is noise.
constexpr size_t kMaxRuns = size_t{1} << 24;

constexpr size_t kMaxGrownSequences = 10000;
/// Query frames times training sequences, if only the file states their numbers.
constexpr size_t kMaxGrownRows = size_t{1} << 25;

FrameCount frame_count(size_t frames) {
  return frames == kUnknownFrames ? FrameCount{0, true} : FrameCount{frames, false};
}

}  // namespace

size_t only_searched_sequence(const GroundTruthScope& scope, std::string_view what) {
  const auto& sequences = scope.sequences;
  const auto is_searched = &GroundTruthScope::TrainSequence::searched;
  const auto count = std::ranges::count(sequences, true, is_searched);
  if (count != 1)
    throw Error(ErrorKind::usage,
                "{} needs exactly one training sequence, but there are {}. Use pairs with a "
                "sequence column, or a result or database of one sequence",
                what, count);
  return static_cast<size_t>(std::ranges::find(sequences, true, is_searched) - sequences.begin());
}

GroundTruthBuilder::GroundTruthBuilder(const GroundTruthArgument& argument, std::string_view format,
                                       const GroundTruthScope& scope,
                                       InconsistentPairs inconsistent, const Monitor& monitor)
    : argument_(argument),
      format_(format),
      scope_(scope),
      inconsistent_(inconsistent),
      monitor_(monitor),
      query_(frame_count(scope.query.frames)),
      location_{argument.path.string()} {
  for (const auto& sequence : scope.sequences)
    train_.push_back(frame_count(sequence.sequence.frames));
  pairs_.resize(query_.frames);
}

size_t GroundTruthBuilder::find_sequence(std::string_view name) {
  if (name.empty()) fail("has no sequence. Name it, or omit the column sequence in all rows");
  for (size_t s = 0; s < scope_.sequences.size(); ++s)
    if (scope_.sequences[s].sequence.name == name) return s;
  if (query_.grows && scope_.sequences.size() < kMaxGrownSequences) {  // their number is unknown
    const bool is_first =
        scope_.sequences.size() == 1 && scope_.sequences.front().sequence.name.empty();
    if (is_first) {
      scope_.sequences.front().sequence.name = name;
    } else {
      scope_.sequences.push_back({{std::string(name), kUnknownFrames}});
      train_.push_back({0, true});
    }
    return scope_.sequences.size() - 1;
  }
  if (scope_.sequences.size() == 1 && scope_.sequences.front().sequence.name == kScoreColumns)
    fail(
        "the columns of the scores are one sequence, so \"{}\" is unknown. Omit the column "
        "sequence, and count references through all training sequences",
        name);
  fail("the result has no training sequence \"{}\"", name);
}

void GroundTruthBuilder::require_frames(FrameCount& side, std::string_view name, size_t frames) {
  if (side.grows ? frames > kMaxGrownFrames : frames != side.frames)
    fail("is for {} {} frames, {}", frames, name,
         side.grows ? "which is too many" : fmt::format("but there are {}", side.frames));
  side = {frames, false};
}

void GroundTruthBuilder::require_query_frames(size_t frames) {
  require_frames(query_, "query", frames);
  pairs_.resize(frames);
}

void GroundTruthBuilder::note(FindingKind kind, uint64_t count, const std::string& what) {
  if (inconsistent_ == InconsistentPairs::refuse && kind != FindingKind::duplicate)
    location_.fail(what);
  GroundTruthFinding& finding = findings_[static_cast<size_t>(kind)];
  finding.count += count;
  if (finding.examples.size() < kMaxExamples)
    finding.examples.push_back(
        location_.unit.empty() ? what
                               : fmt::format("{} {}: {}", location_.unit, location_.number, what));
}

void GroundTruthBuilder::set_query_range(const SequenceArgument& source) {
  const auto in_range = frame_count(source.range);
  if (in_range && !query_.grows && *in_range != query_.frames)
    fail("its range has {}, but the query has {}", counted(*in_range, "frame"), query_.frames);
  if (source.range.is_all()) query_hint_ = range_hint(source.path);
}

void GroundTruthBuilder::report_out_of_range(std::string_view what, std::string_view text,
                                             const FrameCount& side) {
  const std::string there = side.grows         ? ""
                            : side.frames == 0 ? "; there are no frames"
                            : side.frames == 1 ? "; there is 1 frame (0)"
                                               : fmt::format("; there are {} frames (0 to {})",
                                                             side.frames, side.frames - 1);
  note(FindingKind::out_of_range, 1,
       fmt::format(
           "{} {} is out of range{}{}", what, shortened(text), there,
           &side == &query_ && inconsistent_ == InconsistentPairs::refuse ? query_hint_ : ""));
}

bool GroundTruthBuilder::accept(size_t index, FrameCount& side, std::string_view what) {
  if (index < side.frames) return true;
  if (side.grows && index < kMaxGrownFrames) {
    side.frames = index + 1;
    return true;
  }
  if (side.grows) fail("{} {} is too large; pass the numbers of frames", what, index);
  report_out_of_range(what, std::to_string(index), side);
  return false;
}

void GroundTruthBuilder::append(size_t query, const GroundTruth::Pair& pair) {
  check_stop();
  auto& pairs = pairs_[query];
  if (!pairs.empty()) {
    GroundTruth::Pair& back = pairs.back();
    if (back.sequence == pair.sequence && back.label == pair.label &&
        size_t{back.last()} + 1 == pair.first) {
      back.further += pair.further + 1;
      return;
    }
  }
  if (++runs_ > kMaxRuns)
    fail("labels more than {} runs of frames. Use fewer frames, or check the format", kMaxRuns);
  pairs.push_back(pair);
}

void GroundTruthBuilder::add(size_t query, size_t sequence, size_t first, size_t last,
                             PlaceLabel label) {
  const bool is_good = accept(query, query_, "query") &&
                       accept(first, train_[sequence], "reference") &&
                       accept(last, train_[sequence], "reference");
  if (!is_good) return;
  if (pairs_.size() <= query) pairs_.resize(query + 1);
  append(query, {static_cast<uint32_t>(sequence), static_cast<uint32_t>(first), label,
                 static_cast<uint32_t>(last - first)});
}

void GroundTruthBuilder::add_beyond_end(size_t query, size_t sequence, size_t reference) {
  append(query, {static_cast<uint32_t>(sequence), static_cast<uint32_t>(reference)});
}

// The kept runs are contiguous; reports those that `pair`, which begins before all of their ends,
// repeats.
void GroundTruthBuilder::report_overlaps(size_t query, std::span<const GroundTruth::Pair> kept,
                                         const GroundTruth::Pair& pair) {
  size_t k = kept.size();
  while (k > 0 && kept[k - 1].sequence == pair.sequence && kept[k - 1].last() >= pair.first) --k;
  for (; k < kept.size() && kept[k].first <= pair.last(); ++k) {
    const uint32_t first = std::max(kept[k].first, pair.first);
    const uint32_t last = std::min(kept[k].last(), pair.last());
    const bool agree = pair.label == kept[k].label;
    note(agree ? FindingKind::duplicate : FindingKind::contradiction, last - first + 1,
         fmt::format("the pair of query {} and reference {} is {}", query, first,
                     agree ? "listed more than once" : "labeled both same and ignore"));
  }
}

void GroundTruthBuilder::join(size_t query) {
  auto& pairs = pairs_[query];
  if (!std::ranges::is_sorted(pairs)) std::ranges::sort(pairs);
  size_t kept = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    GroundTruth::Pair pair = pairs[i];
    if (kept > 0 && pairs[kept - 1].sequence == pair.sequence) {
      GroundTruth::Pair& back = pairs[kept - 1];
      if (pair.first <= back.last()) {
        report_overlaps(query, std::span(pairs).first(kept), pair);
        if (pair.last() <= back.last()) continue;
        pair.further = pair.last() - back.last() - 1;
        pair.first = back.last() + 1;
      }
      if (pair.label == back.label && pair.first == back.last() + 1) {
        back.further += pair.further + 1;
        continue;
      }
    }
    pairs[kept++] = pair;
  }
  pairs.resize(kept);
}

InspectedGroundTruth GroundTruthBuilder::finish(std::string protocol) {
  pairs_.resize(query_.frames);
  at({}, 0);
  const bool grows = query_.grows ||
                     std::ranges::any_of(train_, [](const FrameCount& side) { return side.grows; });
  if (grows && train_.size() > kMaxGrownRows / std::max<size_t>(query_.frames, 1))
    fail(
        "names {} query frames and {} training sequences, which is too many. Pass the "
        "sequences with --query and --train",
        query_.frames, train_.size());
  for (size_t query = 0; query < pairs_.size(); ++query) {
    check_stop();
    join(query);
  }
  InspectedGroundTruth result;
  scope_.query.frames = query_.frames;
  for (size_t s = 0; s < train_.size(); ++s) scope_.sequences[s].sequence.frames = train_[s].frames;
  result.scope = std::move(scope_);
  result.truth = {std::move(pairs_), argument_.tolerance_frames, std::move(protocol), true,
                  std::move(asked_), std::move(labels_),         is_sample_};
  result.findings = findings_;
  return result;
}

void require_writable(uint64_t count, uint64_t most, std::string_view what) {
  if (count > most)
    throw Error(ErrorKind::data,
                "the file would hold {} {}; the limit is {}. Check the largest frame numbers, or "
                "use fewer frames",
                count, what, most);
}

}  // namespace vpr
