#include "recognition/fabmap_posterior.h"

#include <algorithm>
#include <cmath>

namespace vpr {
namespace {

double motion_prior(std::span<const double> p, size_t i, double bias) {
  const double before = i == 0 ? p[i] : p[i - 1];
  const double after = i + 1 == p.size() ? p[i] : p[i + 1];
  return (2 * (1 - bias) * before + p[i] + 2 * bias * after) / 3;
}

}  // namespace

std::vector<double> fabmap_posterior(std::span<const double> log_likelihoods, double new_place,
                                     std::span<const double> previous,
                                     const PosteriorSettings& settings) {
  const size_t views = log_likelihoods.size();
  std::vector<double> posterior = {new_place};
  posterior.insert(posterior.end(), log_likelihoods.begin(), log_likelihoods.end());
  if (settings.motion_model && views >= 2 && !previous.empty()) {
    posterior[0] += std::log(settings.new_place_prior);
    for (size_t i = 0; i < views; ++i)
      posterior[i + 1] += std::log(motion_prior(previous.subspan(1), i, settings.motion_bias));
  }
  const double most = *std::max_element(posterior.begin(), posterior.end());
  double sum = 0;
  for (double& value : posterior) {
    value = std::exp(value - most);
    sum += value;
  }
  const double floor = (1 - settings.smoothing) / static_cast<double>(views + 1);
  for (double& value : posterior) value = settings.smoothing * (value / sum) + floor;
  return posterior;
}

void ViewWindow::add(std::span<const double> posterior, double t_p, size_t views) {
  run.resize(views, 0);
  for (size_t i = 0; i < views; ++i)
    run[i] = !posterior.empty() && posterior[i + 1] > t_p ? run[i] + 1 : 0;
}

}  // namespace vpr
