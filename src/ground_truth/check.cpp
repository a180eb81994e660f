#include "ground_truth/check.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "ground_truth/label_runs.h"

namespace vpr {
namespace {

constexpr size_t kMostExamples = 5;
constexpr uint64_t kMostCompared = uint64_t{1} << 26;  // pairs whose other direction is looked up

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
      if (summary.one_sided_examples.size() < kMostExamples)
        summary.one_sided_examples.push_back(fmt::format(
            "query {} and reference {} are the same place, query {} and reference {} are not",
            query, reference, reference, query));
    }
  }
}

// Frames in any of the runs, which are sorted.
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

GroundTruthSummary summarise(const InspectedGroundTruth& ground_truth, const Monitor& monitor) {
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
      for (const LabelRun& run : label_runs(truth, query, s, sequences[s].frames)) {
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
    summary.train_frames += sequences[s].frames;
    summary.references_without_match += sequences[s].frames - covered_frames(matched[s]);
  }
  if (sequences.size() == 1 && sequences[0].frames == truth.pairs.size() &&
      summary.same <= kMostCompared) {
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

}  // namespace vpr
