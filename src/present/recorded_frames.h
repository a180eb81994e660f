// The frames of a recorded run, and their names, found at the paths of the run.
#pragma once

#include "evaluate/evaluation.h"
#include "files/result_file.h"
#include "present/gallery.h"

namespace vpr {

/// Adds readers of the names of frames from the query and the database of the run, for sides that
/// have none. `sequences`: number of training sequences.
void add_recorded_names(EvaluationSettings& by, const RecordedRun& run, size_t sequences);

/// Evaluates a result of a file by the names that the run has recorded (add_recorded_names), unless
/// it has places. Throws as evaluate_result does.
Evaluation evaluate_stored(const std::shared_ptr<const StoredResult>& stored,
                           std::optional<ScoreMatrix> matrix, EvaluationSettings by,
                           const Monitor& monitor);

/// The sequences of the run, as far as their frames are still the same. `has_places`: of FAB-MAP,
/// whose training frames are not searched for.
FrameSources recorded_frames(const GroundTruthScope& scope, const RecordedRun& run,
                             bool has_places);

}  // namespace vpr
