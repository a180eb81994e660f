#include "fabmap/posterior.h"

#include <algorithm>
#include <cmath>

#include "base/exponentials.h"

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
  std::vector<double> posterior(views + 1);
  posterior[0] = new_place;
  std::copy(log_likelihoods.begin(), log_likelihoods.end(), posterior.begin() + 1);
  if (settings.motion_model && views >= 2 && !previous.empty()) {
    posterior[0] += std::log(settings.new_place_prior);
    for (size_t i = 0; i < views; ++i)
      posterior[i + 1] += std::log(motion_prior(previous.subspan(1), i, settings.motion_bias));
  }
  const double share = settings.smoothing / exponentiate(posterior);
  const double floor = (1 - settings.smoothing) / static_cast<double>(views + 1);
  for (double& value : posterior) value = share * value + floor;
  return posterior;
}

void ViewWindow::add(std::span<const double> posterior, double t_p, size_t views) {
  run.resize(views, 0);
  for (size_t i = 0; i < views; ++i)
    run[i] = !posterior.empty() && posterior[i + 1] > t_p ? run[i] + 1 : 0;
}

}  // namespace vpr
