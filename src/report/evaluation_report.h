// Evaluation reports (vpr.report/1): counts, best match, and the protocol in words.
#pragma once

#include <string>

#include "base/json_fwd.h"
#include "pipeline/evaluate.h"
#include "report/run_info.h"
#include "report/table.h"

namespace vpr {

/// Everything of a report but "machine" and "timing", of a result or of scores alone.
Json report_json(const Evaluation& evaluation, const RunInfo& run, const Monitor& monitor = {});

/// "counts" of a report, or of a cell of a sweep.
Json counts_json(const Counts& counts);
/// Counts of best matches as reports hold them.
Json best_match_json(const BestMatchCounts& counts);
/// What the ground truth is, in words.
Json protocol_json(const GroundTruth& truth);

/// One row: the setting and its counts.
Table report_table(const Json& report);

/// The first 20 places of a sequence result, with the right and wrong hits of each; empty for other
/// reports, and where there is none.
std::string recognitions_text(const Json& report);

/// One row: the counts by view. Only for a report that has them ("by_view").
Table view_table(const Json& report);

/// "method on query", for titles: the name that the user gave; else the method, and the score
/// where it is not raw distances.
std::string evaluation_title(const Json& report);
/// The same, and c_l and t_r, or c_w and t_p.
std::string title_with_settings(const Json& report);

/// What the references of a report's matches are: frames, or places of FAB-MAP.
std::string reference_word(const Json& report);

/// What the scores of a report's matches are, with their unit.
std::string score_words(const Json& report);

}  // namespace vpr
