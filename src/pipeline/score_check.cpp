#include "pipeline/score_check.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "matching/methods.h"

namespace vpr {
namespace {

void check_raw(const SequenceQuerySettings& settings) {
  if (settings.threshold_scale == ThresholdScale::mean_z)
    throw Error(ErrorKind::usage,
                "t_r_scale mean-z is for standardized scores; add --score standardized, or give "
                "relative, mean or bits");
  if (settings.safety_margin != 0)
    throw Error(ErrorKind::usage,
                "the safety margin is for standardized scores; raw distances have "
                "--safety-factor");
  if (!settings.distance_threshold) return;
  const double threshold = *settings.distance_threshold;
  if (threshold < 0)
    throw Error(ErrorKind::usage, fmt::format("t_r must not be negative, found {}", threshold));
  if (threshold > 1 && scale_of(settings) == ThresholdScale::relative)
    throw Error(ErrorKind::usage,
                fmt::format("t_r is relative to the largest distance, where {} accepts everything; "
                            "for bits a frame give --t-r {} --t-r-scale bits, else a share, as in "
                            "--t-r 0.6",
                            threshold, threshold));
  if (threshold > 1 && scale_of(settings) == ThresholdScale::mean)
    throw Error(
        ErrorKind::usage,
        fmt::format("t_r is a share of what a window differs by on average, where {} accepts "
                    "what is farther than usual; give one below 1, as in --t-r 0.85",
                    threshold));
}

void check_standardized(const SequenceQuerySettings& settings) {
  const ThresholdScale scale = scale_of(settings);
  if (scale != ThresholdScale::mean_z)
    throw Error(ErrorKind::usage,
                fmt::format("t_r_scale {} means nothing for standardized scores, which have no "
                            "bits; leave it out, or give mean-z, as in --t-r -1.5",
                            enum_name(scale)));
  if (settings.distance_threshold && *settings.distance_threshold > 0)
    throw Error(ErrorKind::usage,
                fmt::format("t_r of standardized scores is a mean z, where {} accepts places that "
                            "are farther than usual; give one below 0, as in --t-r -1.5",
                            *settings.distance_threshold));
  if (!find_sequence_method(settings.method).has_scores)
    throw Error(ErrorKind::usage, fmt::format("{} has no standardized scores; take fastable or "
                                              "fastable-online",
                                              settings.method));
  if (settings.safety_factor)
    throw Error(ErrorKind::usage,
                "the safety factor is for raw distances; t_r of standardized scores, which may be "
                "negative, has --safety-margin");
  if (!std::isfinite(settings.safety_margin) || std::abs(settings.safety_margin) > 64)
    throw Error(ErrorKind::usage, fmt::format("the safety margin must be from -64 to 64, found {}",
                                              settings.safety_margin));
  if (settings.window_length > kMaxScoredWindow)
    throw Error(ErrorKind::usage,
                fmt::format("c_l must be at most {} with standardized scores, found {}",
                            kMaxScoredWindow, settings.window_length));
  check_standardization(settings.standardization);
}

}  // namespace

void check_score(const SequenceQuerySettings& settings) {
  if (settings.score == Score::raw)
    check_raw(settings);
  else
    check_standardized(settings);
}

}  // namespace vpr
