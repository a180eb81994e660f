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

// Words of the views of one process; those of a single one stay where they are.
ViewPart view_part(const FabmapDatabase& database, size_t words, const Share& share) {
  ViewPart part{own_part(share, database.views.views()), {}, {}, {}};
  for (const size_t view : database.unreadable_views())
    if (part.range.contains(view)) part.unreadable.push_back(view - part.range.first);
  if (share.is_alone()) return part;
  for (size_t view = part.range.first; view < part.range.last; ++view)
    part.views.add(database.views.view(view));
  part.lists = make_word_index(part.views, words);
  return part;
}

// Fixed point is taken for all views or for none.
bool all_fit_fixed(bool own, const Share& share) {
  uint64_t unfit = own ? 0 : 1;
  add_up(share, "index", {&unfit, 1});
  return unfit == 0;
}

}  // namespace

FabmapMatcher::FabmapMatcher(const FabmapDatabase& db, const FabmapQuerySettings& s, uint64_t seed,
                             const Share& share)
    : model(make_fabmap_model(db.tree, {s.p_seen_if_there, s.p_seen_if_not}, s.word_model)),
      own(view_part(db, model.words(), share)),
      index(share.is_alone() ? make_fabmap_index(model, db.views, db.index)
                             : make_fabmap_index(model, own.views, own.lists)),
      samples(new_place_views(db, s, seed)),
      sample_lists(make_word_index(samples, model.words())),
      sample_index(make_fabmap_index(model, samples, sample_lists)),
      database(db),
      settings(s),
      is_alone(share.is_alone()) {
  if (!is_alone && !find_fabmap_variant(s.variant).is_by_view)
    throw Error(ErrorKind::usage,
                fmt::format("the variant {} is work for one process: leave mpirun out", s.variant));
  index.fits_fixed = all_fit_fixed(index.fits_fixed, share);
}

std::vector<double> FabmapMatcher::views(const WordSet& words, size_t known_views) const {
  const size_t known = std::clamp(known_views, own.range.first, own.range.last) - own.range.first;
  std::vector<double> logs =
      find_fabmap_variant(settings.variant)
          .log_likelihoods({model, is_alone ? database.views : own.views, index, words, known,
                            static_cast<int>(settings.lut_digits), own.unreadable});
  for (const size_t view : own.unreadable)
    if (view < logs.size()) logs[view] = -std::numeric_limits<double>::infinity();
  return logs;
}

double FabmapMatcher::new_place(const WordSet& words) const {
  if (settings.new_place == NewPlaceModel::mean_field) return new_place_mean_field(model, words);
  return log_mean_exp(
      fabmap2_log_likelihoods({model, samples, sample_index, words, samples.views()}));
}

}  // namespace vpr
