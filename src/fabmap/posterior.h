// FAB-MAP's posterior over views and the new place, and what of it counts as a recognition.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vpr {

/// How likelihoods become probabilities.
struct PosteriorSettings {
  double smoothing = 0.99;       ///< p becomes smoothing * p + (1 - smoothing) / (views + 1)
  bool motion_model = false;     ///< neighbours of what was likely before are likely now
  double motion_bias = 0.5;      ///< b: 0 forward only, 1 backward only
  double new_place_prior = 0.9;  ///< with the motion model
};

template <class Visitor>
void visit_fields(PosteriorSettings& settings, Visitor&& visit) {
  visit("smoothing", settings.smoothing);
  visit("motion_model", settings.motion_model);
  visit("motion_bias", settings.motion_bias);
  visit("new_place_prior", settings.new_place_prior);
}

/// Posterior of the new place (first) and of each view, from log-likelihoods, normalised by
/// log-sum-exp. `previous`: the posterior of the frame before, for the motion model; empty for the
/// first frame. Prior of view i: (2 (1 - b) p[i-1] + p[i] + 2 b p[i+1]) / 3, where an end uses
/// itself beyond the end; from two views on.
std::vector<double> fabmap_posterior(std::span<const double> log_likelihoods, double new_place,
                                     std::span<const double> previous,
                                     const PosteriorSettings& settings);

/// Counts, view by view, in how many frames in a row up to this one the posterior was above t_p.
struct ViewWindow {
  std::vector<uint32_t> run;

  /// Takes a frame's posterior (new place first). An empty one (an unreadable frame, or a frame
  /// without words) breaks every run.
  void add(std::span<const double> posterior, double t_p, size_t views);
};

}  // namespace vpr
