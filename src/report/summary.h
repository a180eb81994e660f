// What an evaluation found, in one sentence, and what can be said without a ground truth.
#pragma once

#include <optional>
#include <string>

#include "base/json_fwd.h"
#include "evaluation/judgement.h"
#include "report/table.h"

namespace vpr {

/// Of a result: "Recognised in 17 of 111 frames, 3 of them wrong; the first right one at frame 21
/// (2.1 s)." With frames_per_second, which is above 0, the time from the first frame to it. Where
/// the ground truth is not known, all recognitions count alike. Of scores: "Best match right in 53
/// of 111 frames (47.7 %)", and recognitions only by a threshold that the user chose; one chosen
/// from the ground truth is called that.
std::string summary_sentence(const Judgement& judgement, bool is_judged,
                             std::optional<double> frames_per_second);

/// One row: the counts of a report whose ground truth is not known.
Table unjudged_table(const Json& report);

}  // namespace vpr
