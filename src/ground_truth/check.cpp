#include "ground_truth/check.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/error.h"
#include "ground_truth/label_runs.h"

namespace vpr {
namespace {

constexpr size_t kMostExamples = 5;

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

}  // namespace

GroundTruthSummary summarise(const InspectedGroundTruth& ground_truth, const Monitor& monitor) {
  const GroundTruth& truth = ground_truth.truth;
  const auto& sequences = ground_truth.scope.sequences;
  GroundTruthSummary summary;
  summary.query_frames = truth.pairs.size();
  std::vector<uint64_t> matches(truth.pairs.size());
  const bool is_square = sequences.size() == 1 && sequences[0].frames == truth.pairs.size();
  if (is_square) summary.one_sided = 0;
  for (size_t s = 0; s < sequences.size(); ++s) {
    summary.train_frames += sequences[s].frames;
    std::vector<bool> is_matched;  // as far as any is
    for (size_t query = 0; query < truth.pairs.size(); ++query) {
      check_stop(monitor);
      const std::vector<LabelRun> runs = label_runs(truth, query, s, sequences[s].frames);
      for (const LabelRun& run : runs) {
        const uint64_t count = run.last - run.first + 1;
        (run.label == PlaceLabel::same ? summary.same : summary.ignored) += count;
        if (run.label != PlaceLabel::same) continue;
        matches[query] += count;
        is_matched.resize(std::max(is_matched.size(), run.last + 1));
        std::fill(is_matched.begin() + static_cast<ptrdiff_t>(run.first),
                  is_matched.begin() + static_cast<ptrdiff_t>(run.last) + 1, true);
      }
      if (is_square) count_one_sided(summary, truth, runs, query);
    }
    summary.references_without_match +=
        sequences[s].frames -
        static_cast<uint64_t>(std::count(is_matched.begin(), is_matched.end(), true));
  }
  for (const uint64_t count : matches) {
    if (count == 0) ++summary.queries_without_match;
    summary.most_matches = std::max(summary.most_matches, count);
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
