// The settings of a query by FAB-MAP, plain data: results hold them, and only FAB-MAP uses them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/enum_names.h"
#include "base/json_fwd.h"

namespace vpr {

/// Whether a word depends on its parent in the Chow-Liu tree or on no other word.
enum class WordModel { tree, naive_bayes };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<WordModel> = {"tree", "naive-bayes"};

/// The likelihood of an unknown place: from the marginals of the words, or averaged over
/// pretraining frames.
enum class NewPlaceModel { mean_field, pretrain };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<NewPlaceModel> = {"mean-field",
                                                                              "pretrain"};

/// Settings of the conversion from likelihoods to probabilities.
struct PosteriorSettings {
  double smoothing = 0.99;       ///< p becomes smoothing * p + (1 - smoothing) / (views + 1)
  bool motion_model = false;     ///< neighbors of previously likely views get a higher prior
  double motion_bias = 0.5;      ///< b: 0 forward only, 1 backward only
  double new_place_prior = 0.9;  ///< with the motion model
};
VPR_FIELDS(PosteriorSettings, (smoothing, "Weight of the smoothed probability, 0 to 1."),
           (motion_model, "Prefer neighbors of the last place."),
           (motion_bias, "0: forward only, 1: backward only."),
           (new_place_prior, "Prior of a new place."))

/// The settings of FAB-MAP.
struct FabmapQuerySettings {
  std::string method = "fabmap";
  std::string variant = "fabmap2";
  double place_threshold = 0.99;  ///< t_p; the probability of a recognized view is above (strict)
  uint64_t window = 1;            ///< c_w: for this number of consecutive frames
  WordModel word_model = WordModel::tree;
  NewPlaceModel new_place = NewPlaceModel::pretrain;
  uint64_t new_place_samples = 0;  ///< pretraining frames drawn with the seed; 0: all
  double p_seen_if_there = 0.39;
  double p_seen_if_not = 0;
  int64_t lut_digits = 6;
  bool loop = false;       ///< frames of the query are places for later frames
  uint64_t loop_gap = 10;  ///< except for this number of frames directly after them
  bool skip_unreadable = false;
  PosteriorSettings posterior;

  /// With `loop`, the number of frames before `frame` that it may match.
  uint64_t searched_before(uint64_t frame) const { return frame > loop_gap ? frame - loop_gap : 0; }
};

template <class Visitor>
void visit_fields(FabmapQuerySettings& settings, Visitor&& visit) {
  visit("method", settings.method, "Matching method; default: the database's.");
  visit("variant", settings.variant);
  visit("t_p", settings.place_threshold);
  visit("c_w", settings.window);
  visit("word_model", settings.word_model);
  visit("new_place", settings.new_place);
  visit("new_place_samples", settings.new_place_samples);
  visit("p_seen_if_there", settings.p_seen_if_there, "P(word observed | word present).");
  visit("p_seen_if_not", settings.p_seen_if_not, "P(word observed | word absent).");
  visit("lut_digits", settings.lut_digits, "Digits of variant lut.", within(1, 12));
  visit("loop", settings.loop,
        "Match the query with its own past; in FAB-MAP, frames become places for later frames.");
  visit("loop_gap", settings.loop_gap,
        "Frames between a frame and its match at least; 0: loop_gap_s.");
  visit("skip_unreadable", settings.skip_unreadable);
  visit("posterior", settings.posterior, "Posterior settings.");
}

}  // namespace vpr
