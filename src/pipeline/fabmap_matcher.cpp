#include "pipeline/fabmap_matcher.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"

namespace vpr {
namespace {

// The pretraining frames whose average likelihood is the new place's.
ViewWords new_place_views(const FabmapDatabase& database, const FabmapQuerySettings& settings,
                          uint64_t seed) {
  const size_t all = database.pretrain.views();
  if (settings.new_place_samples == 0 || settings.new_place_samples >= all)
    return database.pretrain;
  std::vector<size_t> order(all);
  for (size_t i = 0; i < all; ++i) order[i] = i;
  RandomEngine engine(seed);
  for (size_t i = 0; i < settings.new_place_samples; ++i)
    std::swap(order[i], order[i + uniform_below(engine, all - i)]);
  ViewWords sample;
  for (size_t i = 0; i < settings.new_place_samples; ++i)
    sample.add(database.pretrain.view(order[i]));
  return sample;
}

}  // namespace

FabmapMatcher::FabmapMatcher(const FabmapDatabase& db, const FabmapQuerySettings& s, uint64_t seed)
    : model(make_fabmap_model(db.tree, {s.p_seen_if_there, s.p_seen_if_not}, s.word_model)),
      index(make_fabmap_index(model, db.views, db.index)),
      samples(new_place_views(db, s, seed)),
      sample_lists(make_word_index(samples, model.words())),
      sample_index(make_fabmap_index(model, samples, sample_lists)),
      unreadable(db.unreadable_views()),
      database(db),
      settings(s) {}

std::vector<double> FabmapMatcher::views(const WordSet& words, size_t known_views) const {
  std::vector<double> logs =
      find_fabmap_variant(settings.variant)
          .log_likelihoods({model, database.views, index, words, known_views,
                            static_cast<int>(settings.lut_digits), unreadable});
  for (const size_t view : unreadable)
    if (view < logs.size()) logs[view] = -std::numeric_limits<double>::infinity();
  return logs;
}

double FabmapMatcher::new_place(const WordSet& words) const {
  if (settings.new_place == NewPlaceModel::mean_field) return new_place_mean_field(model, words);
  return log_mean_exp(
      fabmap2_log_likelihoods({model, samples, sample_index, words, samples.views()}));
}

}  // namespace vpr
