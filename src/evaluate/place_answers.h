// Answers of a person to the places of a result.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "query/result.h"
#include "query/score_layout.h"
#include "truth/ground_truth.h"

namespace vpr {

/// The columns of a file of answers.
inline constexpr const char* kAnswerColumns = "place,query,sequence,train,same";

/// At most this many query frames are judged by one answer.
inline constexpr size_t kPartFrames = 50;

/// A part of a place along the path, which one answer judges.
struct PlacePart {
  size_t place = 0;                    ///< index of the cluster
  std::vector<uint32_t> recognitions;  ///< by query frame
  size_t frames = 0;                   ///< query frames with a recognition
  /// The anchors that are shown: those of the place's representative or, if the place has several
  /// parts, of the middle recognition.
  MatchedFrame middle;
};

/// The parts of all places, in their order: a place is cut where its speed or its score changes,
/// and stretches of more than kPartFrames query frames are cut evenly. Throws as require_places
/// does.
std::vector<PlacePart> parts_of_places(const Result& result);

/// The first four columns of the row of a part: the number of its place, counted from 1, the query
/// frame, the training sequence and the training frame of its middle.
std::string answer_row(const Result& result, const PlacePart& part);

/// Throws Error(usage) for a result without clusters, as of FAB-MAP.
void require_places(const Result& result);

/// A label per part: `same` or `different` by the column "same" (yes or no), `ignore` without a
/// row. A row of the representative of a place is of the part nearest to it. Throws as
/// require_places does, Error(input) if the file cannot be read, and Error(data), with the line, if
/// it has no answer, has two for a part, or a row is not a part of `result`.
std::vector<PlaceLabel> read_place_answers(const std::filesystem::path& path, const Result& result,
                                           const std::vector<PlacePart>& parts);

}  // namespace vpr
