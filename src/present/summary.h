// Evaluations and reports as sentences, and the words that tables add to them.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "evaluate/evaluation.h"
#include "evaluate/report.h"

namespace vpr {

/// For a result: "17 of 111 frames recognized, 3 of them incorrectly. The first is confirmed at
/// frame 21 (2.1 s)." Frames are those with a match in the ground truth, and each is judged by its
/// best accepted match; other accepted pairs that are incorrect are counted in the same sentence.
/// The time since the first frame needs recorded_fps, the constant rate of the recording. If
/// nothing is judged, with their share of all frames. For scores: "Best match correct in 53 of 111
/// frames (47.7 %)", with recognized frames only at a threshold of the user; one from the ground
/// truth is marked.
std::string summary_sentence(const Evaluation& evaluation, std::optional<double> recorded_fps);

/// "12 of 100 frames correctly, 7 incorrectly (5 of them without a match)", and accepted pairs that
/// are incorrect, if a frame has several. The whole are the frames with a match.
std::string frame_counts_text(const FrameCounts& counts, bool has_places);

/// "; incorrect also counts frames without a match", for the title of a table of reports; empty if
/// there are none among these frames.
std::string off_map_words(std::span<const Report> reports);

/// Whether a best match is not labeled where others are, so that the best report is unknown.
bool lack_labels(std::span<const Report> reports);
/// Cautions about labels of single pairs; empty if there are none.
std::string caution_of(const Report& report);

}  // namespace vpr
