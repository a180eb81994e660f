// Which words speak for and against the best places of one frame, and where they are.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "match/fusion.h"
#include "run/fabmap_query.h"

namespace vpr {

/// One place that a frame was taken for, or could have been.
struct PlaceExplanation {
  Match match;
  std::string place;
  std::string view;                   ///< "<group>: <name of the frame>"
  double log_odds = 0;                ///< of the view against a new place by mean field
  std::vector<WordEvidence> for_it;   ///< strongest first
  std::vector<WordEvidence> against;  ///< strongest first
};

/// Why a frame was recognized as what it was.
struct Explanation {
  size_t frame = 0;
  double new_place = 0;  ///< its posterior
  std::vector<PlaceExplanation> places;
};

/// Words on each side, and places, that are listed.
inline constexpr size_t kExplainedWords = 8;
inline constexpr size_t kExplainedPlaces = 3;

/// `searched`: the database, or with_query's. `posterior`: of the frame, new place first; of each
/// place the likeliest view counts. No places for an unreadable frame (an empty posterior).
Explanation explain_frame(const FabmapDatabase& searched, const WordSet& words, size_t frame,
                          std::span<const double> posterior, const FabmapQuerySettings& settings);

/// The features of one frame and their words.
struct FrameFeatures {
  cv::Mat gray;
  std::vector<cv::Point2f> points;
  std::vector<uint32_t> words;  ///< per point
};

/// Decodes one frame of a sequence and describes it. Throws Error(input) if the sequence has no
/// such frame, or it can't be decoded.
FrameFeatures locate_words(const SequenceSource& sequence, size_t frame,
                           const FabmapDatabase& database, const Monitor& monitor);

}  // namespace vpr
