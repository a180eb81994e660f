// What a FAB-MAP query gives: the content of a result file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "matching/fabmap_model.h"
#include "recognition/fabmap_posterior.h"

namespace vpr {

/// Everything that can change a result. JSON keys are the names of the flags.
struct FabmapQuerySettings {
  std::string method = "fabmap";
  std::string variant = "fabmap2";
  double place_threshold = 0.99;  ///< t_p: a view is recognised above (strict)
  uint64_t window = 1;            ///< c_w: in so many frames in a row
  WordModel word_model = WordModel::tree;
  NewPlaceModel new_place = NewPlaceModel::pretrain;
  uint64_t new_place_samples = 0;  ///< pretraining frames drawn with the seed; 0: all
  double p_seen_if_there = 0.39;
  double p_seen_if_not = 0;
  int64_t lut_digits = 6;
  bool loop = false;       ///< frames of the query are places for later ones
  uint64_t loop_gap = 10;  ///< but not for so many that follow directly
  bool skip_unreadable = false;
  PosteriorSettings posterior;
};

template <class Visitor>
void visit_fields(FabmapQuerySettings& settings, Visitor&& visit) {
  visit("method", settings.method);
  visit("variant", settings.variant);
  visit("t_p", settings.place_threshold);
  visit("c_w", settings.window);
  visit("word_model", settings.word_model);
  visit("new_place", settings.new_place);
  visit("new_place_samples", settings.new_place_samples);
  visit("p_seen_if_there", settings.p_seen_if_there);
  visit("p_seen_if_not", settings.p_seen_if_not);
  visit("lut_digits", settings.lut_digits);
  visit("loop", settings.loop);
  visit("loop_gap", settings.loop_gap);
  visit("skip_unreadable", settings.skip_unreadable);
  visit("posterior", settings.posterior);
}

/// A place seen in a frame, by the likeliest of its views.
struct PlaceMatch {
  uint32_t frame = 0;
  uint32_t place = 0;
  uint32_t view = 0;
  double probability = 0;

  bool operator==(const PlaceMatch&) const = default;
};

struct FabmapResult {
  FabmapQuerySettings settings;
  std::string query_name;
  size_t query_frames = 0;
  std::vector<size_t> query_unreadable;
  size_t query_featureless = 0;     ///< frames that could be decoded, but show no word
  std::vector<std::string> places;  ///< names by index
  size_t views = 0;
  std::vector<PlaceMatch> hits;                 ///< by frame, then place; each (frame, place) once
  std::vector<std::optional<PlaceMatch>> best;  ///< per frame, of the likeliest view, ties to the
                                                ///< first; none for a frame without words
  std::vector<double> new_place;                ///< per frame; 0 for an unreadable one
};

}  // namespace vpr
