// Outcomes of queries, and their judgment, by letters.
#pragma once

#include <string>

#include "evaluate/evaluation.h"

namespace vpr::test {

/// One query frame per letter: c(orrect), w(rong), n (wrong, without a match), i(gnored),
/// u(nanswered).
inline Outcomes outcomes_of(const std::string& letters) {
  Outcomes outcomes;
  for (const char letter : letters) {
    QueryOutcome& query = outcomes.queries.emplace_back();
    query.frame = outcomes.queries.size() - 1;
    query.has_match = letter != 'n';
    query.verdict = letter == 'c'   ? Verdict::correct
                    : letter == 'u' ? Verdict::none
                    : letter == 'i' ? Verdict::ignored
                                    : Verdict::incorrect;
  }
  return outcomes;
}

/// One window per letter, c(orrect) or w(rong), with increasing distances; capital letters are
/// recognized. Best matches are at the anchor's number in the first training sequence; in the last
/// one if they are wrong.
inline Judgment judgment_of(const std::string& letters, size_t window_length,
                            std::vector<GroundTruthScope::TrainSequence> sequences) {
  Judgment judgment;
  ScoreLayout& layout = judgment.layout;
  layout.window_length = window_length;
  layout.scope = {{"", letters.size() + window_length - 1}, std::move(sequences)};
  const auto last = static_cast<uint32_t>(layout.scope.sequences.size() - 1);
  size_t column = 0;
  for (uint32_t s = 0; s <= last; ++s) {
    const size_t windows = layout.scope.sequences[s].sequence.frames - window_length + 1;
    layout.columns.push_back({s, column, windows});
    column += windows;
  }
  judgment.verdicts.assign(layout.scope.query.frames, Verdict::none);
  judgment.outcomes.window_length = window_length;
  judgment.outcomes.queries.resize(layout.scope.query.frames);
  for (size_t w = 0; w < letters.size(); ++w) {
    const bool is_right = letters[w] == 'c' || letters[w] == 'C';
    QueryOutcome& query = judgment.outcomes.at_window(w);
    query.frame = layout.anchor(w);
    query.has_match = true;
    query.verdict = is_right ? Verdict::correct : Verdict::incorrect;
    query.best = FrameMatch{is_right ? 0U : last, query.frame};
    query.key = score_key(double(w), ScoreOrder::distance);
    if (letters[w] == 'C') judgment.verdicts[query.frame] = Verdict::correct;
    if (letters[w] == 'W') judgment.verdicts[query.frame] = Verdict::incorrect;
  }
  judgment.single_best = single_best_curve(judgment.outcomes);
  return judgment;
}

}  // namespace vpr::test
