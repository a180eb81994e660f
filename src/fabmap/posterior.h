// FAB-MAP's posterior over views and the new place, and the runs of frames above t_p.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vpr {

/// Settings of the conversion from likelihoods to probabilities.
struct PosteriorSettings {
  double smoothing = 0.99;       ///< p becomes smoothing * p + (1 - smoothing) / (views + 1)
  bool motion_model = false;     ///< neighbors of previously likely views get a higher prior
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

/// Posterior of the new place (first) and of each view, from log-likelihoods, normalized by
/// log-sum-exp. `previous`: the posterior of the previous frame, for the motion model; empty for
/// the first frame. The prior of view i, for at least two views, is (2 (1 - b) p[i-1] + p[i] + 2 b
/// p[i+1]) / 3, where the first and last view replace their missing neighbor.
std::vector<double> fabmap_posterior(std::span<const double> log_likelihoods, double new_place,
                                     std::span<const double> previous,
                                     const PosteriorSettings& settings);

/// For each view, counts the consecutive frames up to the current one with a posterior above t_p.
struct ViewWindow {
  std::vector<uint32_t> run;

  /// Adds the posterior of a frame (new place first). An empty posterior (an unreadable frame, or a
  /// frame without words) ends every run.
  void add(std::span<const double> posterior, double t_p, size_t views);
};

}  // namespace vpr
