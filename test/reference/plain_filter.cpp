#include "reference/plain_filter.h"

#include <algorithm>
#include <cmath>

#include "match/filter_track.h"
#include "match/score_kernels.h"

namespace vpr {
namespace {

double likelihood(const FilterSettings& settings, uint16_t score) {
  const double z = (static_cast<double>(score) - kScoreBias) / kScoreUnit;
  return std::exp(-settings.sharpness * (std::min(z, 8.0) - settings.unmatched));
}

// The mass that steps within the run bring to a cell at a rate, before the observation.
double stepped(const PlainFilter& filter, const CellRun& run, size_t rate, size_t to) {
  const FilterRate& steps = filter_rates()[rate];
  double sum = 0;
  for (size_t s = 0; s < kSteps; ++s) {
    const size_t step = kFirstSteps[rate] + s;
    if (to < run.first + step) continue;
    double all = 0;
    for (const std::vector<double>& masses : filter.rates) all += masses[to - step];
    sum += steps.steps[s] * ((1 - filter.settings.rate_change) * filter.rates[rate][to - step] +
                             filter.settings.rate_change * steps.prior * all);
  }
  return sum;
}

bool is_same_path(const PlainView& before, const PlainView& view, const FilterSettings& settings) {
  const double gap = static_cast<double>(view.cell) - static_cast<double>(before.cell);
  return view.sequence == before.sequence &&
         std::abs(gap) <= static_cast<double>(settings.near_keyframes);
}

// In keyframes: the mean of the query's and the training sequence's number.
double path_length(std::span<const PlainView> path) {
  const double passed =
      static_cast<double>(path.back().cell) - static_cast<double>(path.front().cell);
  return (static_cast<double>(path.size()) + std::max(passed, 0.0)) / 2;
}

// In scores, as the function below.
double present_support(const PlainView& view) {
  double mean = 0;
  for (const int32_t support : view.supports) mean = std::floor((mean + support) / 2);
  return mean;
}

double mean_support(const PlainView& view) {
  const std::span<const int32_t> all = view.supports;
  const std::span<const int32_t> last = all.last(std::min<size_t>(all.size(), 24));
  double sum = 0;
  for (const int32_t support : last) sum += support;
  return sum / static_cast<double>(last.size());
}

// In deviations.
double path_evidence(const PlainView& view) {
  double evidence = 0;
  for (const int32_t support : view.supports) {
    const double added = static_cast<double>(support) / kScoreUnit - kUnrelatedSupport;
    evidence = std::max(0.0, evidence + std::max(-kMostEvidence, std::min(kMostEvidence, added)));
  }
  return evidence;
}

// Uses the last 16 keyframes before the last one.
double margin_share(std::span<const PlainView> path) {
  const std::span<const PlainView> before = path.first(path.size() - 1);
  const std::span<const PlainView> last = before.last(std::min<size_t>(before.size(), 16));
  double sum = 0;
  for (const PlainView& view : last) sum += view.margin;
  return last.empty() ? 1 : path.back().margin / (sum / static_cast<double>(last.size()));
}

bool is_present(std::span<const PlainView> path, const FilterSettings& settings) {
  const PlainView& view = path.back();
  if (mean_support(view) <= 0 || view.margin == 0) return false;
  const double excess = path.size() > 1 ? std::max(view.excess, 0.0) : 0;
  return present_support(view) / mean_support(view) +
             std::min(margin_share(path), kMostMarginShare) - kChangeWeight * excess >=
         settings.present_support;
}

bool is_long(std::span<const PlainView> path, const FilterSettings& settings) {
  return path_length(path) >= 2 * static_cast<double>(settings.confirm_keyframes);
}

bool has_margin(const PlainView& view, double least) {
  return view.margin >= std::floor(least * kScoreUnit + 0.5);
}

bool is_confirmable(std::span<const PlainView> path, const FilterSettings& settings) {
  const PlainView& view = path.back();
  if (!is_present(path, settings)) return false;
  const bool has_whole = has_margin(view, settings.confirm_margin);
  if (has_whole && path_evidence(view) >= settings.confirm_evidence) return true;
  const double support = mean_support(view) / kScoreUnit;
  if (has_whole && support >= settings.support &&
      path_length(path) >= static_cast<double>(settings.confirm_keyframes))
    return true;
  return is_long(path, settings) && has_margin(view, 0.8 * settings.confirm_margin) &&
         support >= 0.8 * settings.support;
}

}  // namespace

PlainFilter start_plain_filter(const FilterCells& cells, const FilterSettings& settings) {
  PlainFilter filter{cells, settings, {}, std::vector<double>(cells.size()), 0.5};
  for (const FilterRate& rate : filter_rates()) {
    std::vector<double>& masses = filter.rates.emplace_back(cells.size());
    for (const CellRun& run : cells.runs)
      for (size_t c = run.first; c < run.first + run.count; ++c)
        masses[c] = 0.5 * rate.prior / static_cast<double>(cells.places);
  }
  return filter;
}

void advance_plain_filter(PlainFilter& filter, std::span<const uint16_t> scores) {
  const FilterSettings& settings = filter.settings;
  const double stays = (1 - settings.enter) * (1 - settings.jump);
  const double lands = ((1 - filter.off_map) * (1 - settings.enter) * settings.jump +
                        filter.off_map * settings.leave) /
                       static_cast<double>(filter.cells.places);
  PlainFilter next = filter;
  next.off_map = filter.off_map * (1 - settings.leave) + (1 - filter.off_map) * settings.enter;
  double total = next.off_map;
  for (const CellRun& run : filter.cells.runs)
    for (size_t to = run.first; to < run.first + run.count; ++to) {
      next.masses[to] = 0;
      for (size_t r = 0; r < kRates; ++r) {
        next.rates[r][to] = likelihood(settings, scores[filter.cells.frames[to]]) *
                            (stays * stepped(filter, run, r, to) + lands * filter_rates()[r].prior);
        next.masses[to] += next.rates[r][to];
      }
      total += next.masses[to];
    }
  next.off_map /= total;
  for (double& mass : next.masses) mass /= total;
  for (std::vector<double>& rate : next.rates)
    for (double& mass : rate) mass /= total;
  filter = std::move(next);
}

double plain_value(const PlainFilter& filter, size_t cell) {
  return -std::log(filter.masses[cell]) / filter.settings.sharpness;
}

double plain_nowhere_value(const PlainFilter& filter) {
  return -std::log(filter.off_map) / filter.settings.sharpness;
}

double plain_path_margin(std::span<const std::vector<uint16_t>> scores, size_t best, size_t places,
                         const FilterSettings& settings) {
  const size_t cells = scores.front().size();
  FilterCells around{{}, {{0, cells, 0, cells}}, places};
  for (size_t c = 0; c < cells; ++c) around.frames.push_back(static_cast<uint32_t>(c));
  PlainFilter filter = start_plain_filter(around, settings);
  for (const std::vector<uint16_t>& view : scores) advance_plain_filter(filter, view);
  double least = plain_value(filter, best);
  for (size_t c = 0; c < cells; ++c)
    if (std::max(c, best) - std::min(c, best) <= settings.near_keyframes)
      least = std::min(least, plain_value(filter, c));
  return std::max(0.0, plain_nowhere_value(filter) - least);
}

std::vector<uint8_t> plain_confirmed(std::span<const PlainView> views,
                                     const FilterSettings& settings) {
  std::vector<uint8_t> believed;
  for (size_t k = 0; k < views.size(); ++k) {
    size_t begin = k;
    while (begin > 0 && is_same_path(views[begin - 1], views[begin], settings)) --begin;
    bool is_confirmed = false;
    for (size_t v = begin; v <= k; ++v) {
      const auto path = views.subspan(begin, v - begin + 1);
      if (path.size() == 1 || views[v].margin == 0 || present_support(views[v]) < 0)
        is_confirmed = false;
      if (is_confirmable(path, settings)) is_confirmed = true;
    }
    const auto path = views.subspan(begin, k - begin + 1);
    believed.push_back(is_confirmed && is_present(path, settings) &&
                       (is_long(path, settings) || has_margin(views[k], settings.confirm_margin)));
  }
  return believed;
}

double filter_tolerance(size_t views) {
  constexpr double kGroup = 1.0 * kScoresPerLikelihood / kScoreUnit;
  return kGroup * static_cast<double>(views) + 0.006;
}

}  // namespace vpr
