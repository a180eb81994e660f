#include "truth/check.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/text.h"
#include "truth/ground_truth.h"

namespace vpr {

namespace {

constexpr size_t kMaxExamples = 5;
// maximum number of pairs for the check of symmetry
constexpr uint64_t kMaxCompared = uint64_t{1} << 26;

const GroundTruthFinding& finding(const InspectedGroundTruth& ground_truth, FindingKind kind) {
  return ground_truth.findings[static_cast<size_t>(kind)];
}

void count_one_sided(GroundTruthSummary& summary, const GroundTruth& truth,
                     const std::vector<LabelRun>& runs, size_t query) {
  for (const LabelRun& run : runs) {
    if (run.label != PlaceLabel::same) continue;
    for (size_t reference = run.first; reference <= run.last; ++reference) {
      if (truth.label(reference, 0, query) == PlaceLabel::same) continue;
      ++*summary.one_sided;
      if (summary.one_sided_examples.size() < kMaxExamples)
        summary.one_sided_examples.push_back(fmt::format(
            "query {} and reference {} are the same place, but query {} and reference {} are not",
            query, reference, reference, query));
    }
  }
}

// The number of frames in the union of the runs; sorts them.
uint64_t covered_frames(std::vector<LabelRun>& runs) {
  std::ranges::sort(runs, {}, &LabelRun::first);
  uint64_t covered = 0;
  size_t end = 0;
  for (const LabelRun& run : runs) {
    if (run.last < end) continue;
    covered += run.last + 1 - std::max(end, run.first);
    end = run.last + 1;
  }
  return covered;
}

}  // namespace

GroundTruthSummary summarize(const InspectedGroundTruth& ground_truth, const Monitor& monitor) {
  const GroundTruth& truth = ground_truth.truth;
  const auto& sequences = ground_truth.scope.sequences;
  GroundTruthSummary summary;
  summary.query_frames = truth.pairs.size();
  std::vector<std::vector<LabelRun>> matched(sequences.size());
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    check_stop(monitor);
    uint64_t matches = 0;
    const auto& row = truth.pairs[query];
    for (auto pair = row.begin(); pair != row.end();) {
      const size_t s = pair->sequence;
      for (const LabelRun& run : label_runs(truth, query, s, sequences[s].sequence.frames)) {
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
    summary.references_without_match += sequences[s].sequence.frames - covered_frames(matched[s]);
  }
  if (sequences.size() == 1 && sequences[0].sequence.frames == truth.pairs.size() &&
      summary.same <= kMaxCompared) {
    summary.one_sided = 0;
    for (size_t query = 0; query < truth.pairs.size(); ++query) {
      check_stop(monitor);
      count_one_sided(summary, truth, label_runs(truth, query, 0, truth.pairs.size()), query);
    }
  }
  return summary;
}

void require_undamaged(const InspectedGroundTruth& ground_truth, const std::string& name) {
  const GroundTruthFinding& outside = finding(ground_truth, FindingKind::out_of_range);
  const GroundTruthFinding& both = finding(ground_truth, FindingKind::contradiction);
  if (outside.count == 0 && both.count == 0) return;
  throw Error(ErrorKind::data,
              fmt::format("{}: is damaged: {} out of range and {} with both labels "
                          "(first: {})",
                          name, counted(outside.count, "pair"), both.count,
                          (outside.count > 0 ? outside : both).examples.front()));
}

std::string ground_truth_fingerprint(const GroundTruth& truth, const GroundTruthScope& scope,
                                     const Monitor& monitor) {
  std::vector<uint64_t> place_among_searched;
  uint64_t searched = 0;
  for (const auto& sequence : scope.sequences)
    place_among_searched.push_back(sequence.searched ? searched++ : searched);
  ChecksumStream sum;
  const auto add = [&](const auto& numbers) { sum.add(std::as_bytes(std::span(numbers))); };
  add(std::array<uint64_t, 1>{truth.pairs.size()});
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    check_stop(monitor);
    const auto& row = truth.pairs[query];
    for (size_t i = 0; i < row.size();) {
      const size_t s = row[i].sequence;
      i += truth.pairs_of(query, s).size();
      if (!scope.sequences[s].searched) continue;
      for (const LabelRun& run : label_runs(truth, query, s, scope.sequences[s].sequence.frames))
        add(std::array<uint64_t, 5>{query, place_among_searched[s], run.first, run.last,
                                    static_cast<uint64_t>(run.label)});
    }
  }
  return sum.text();
}

}  // namespace vpr
