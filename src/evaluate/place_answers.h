// Answers of a person who saw images of each place of a result: the same place, or not.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "decide/result.h"
#include "truth/ground_truth.h"

namespace vpr {

/// The columns of a file of answers.
inline constexpr const char* kAnswerColumns = "place,query,sequence,train,same";

/// The first four columns of the row of a cluster: its number, counted from 1, the query frame, the
/// training sequence and the training frame; frames are the anchors of the representative.
std::string answer_row(const Result& result, size_t cluster);

/// Throws Error(usage) for a result without clusters, as of FAB-MAP.
void require_places(const Result& result);

/// A label per cluster: `same` or `different` by the column "same" (yes or no), `ignore` without a
/// row. Throws as require_places does, Error(input) if the file cannot be read, and Error(data),
/// with the line, if it has no answer, has two for a place, or a row is not a cluster of `result`.
std::vector<PlaceLabel> read_place_answers(const std::filesystem::path& path, const Result& result);

}  // namespace vpr
